//! The options of a simulation.

use std::fmt;
use std::sync::Arc;

use hodograph::Surface;

use crate::{ContactLaw, Drive};

/// A function of time, coordinates and speeds whose zeros are events.
pub type EventFunction = Arc<dyn Fn(f64, &[f64], &[f64]) -> f64 + Send + Sync>;

/// What happens where several contacts are struck at the same time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImpactsAtOnce {
    /// All that approach strike at once, by Poisson's hypothesis in two phases where it is the law of all of them,
    /// else by Moreau's law, with friction; what their impulses press together strikes next, until nothing
    /// approaches. A contact that strikes alone does so exactly, by its own law.
    #[default]
    Approaching,
    /// One after the other, the fastest approach first, until nothing approaches.
    Sequential,
    /// All that touch at once, by the same laws. Moreau's: v+_n = -e v-_n or more.
    Simultaneous,
    /// All that touch at once, after Liu, Zhao and Brogliato, by the ratios of [`Options::stiffness`]: without friction
    /// only.
    Lzb,
    /// The simulation ends with an error.
    Stop,
}

/// Options of a simulation. Start from `Options::default()`.
#[derive(Clone)]
pub struct Options {
    /// relative tolerance of the integration
    pub relative_tolerance: f64,
    /// absolute tolerance of the integration, in the units of coordinates and speeds; bounces lower than
    /// this end in contact
    pub absolute_tolerance: f64,
    /// greatest step of the integration, s
    pub max_step: f64,
    /// times at which inputs or their rates jump, rising, s: no step of the integration goes beyond the next
    /// of them, so that none is stepped over
    pub breaks: Vec<f64>,
    /// the surfaces of the contacts that have one of their own, by number
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// the surfaces of all other contacts; without it they have those that the model states
    /// ([`Contacts::surface`](hodograph::Contacts::surface))
    pub surface: Option<Surface<f64>>,
    /// what contacts that have a law of their own do beyond mu, e and law of their surfaces, by number
    pub laws: Vec<(usize, ContactLaw)>,
    /// what all other contacts do beyond that; without it they have the laws that the model states
    /// ([`Contacts::stated_law`](hodograph::Contacts::stated_law))
    pub law: Option<ContactLaw>,
    /// where inputs come from
    pub drive: Drive,
    /// what happens where several contacts are struck together
    pub together: ImpactsAtOnce,
    /// of [`ImpactsAtOnce::Lzb`]: the stiffnesses of contacts, by number; only their ratios matter, and contacts
    /// that are not named have 1
    pub stiffness: Vec<(usize, f64)>,
    /// whether the outcomes of all orders of up to four contacts struck together are compared
    /// ([`crate::CollisionRecord::spread`])
    pub compare_orders: bool,
    /// functions whose zeros are events
    pub events: Vec<EventFunction>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-12,
            absolute_tolerance: 1e-12,
            max_step: f64::INFINITY,
            breaks: Vec::new(),
            surfaces: Vec::new(),
            surface: None,
            laws: Vec::new(),
            law: None,
            drive: Drive::Held,
            together: ImpactsAtOnce::default(),
            stiffness: Vec::new(),
            compare_orders: false,
            events: Vec::new(),
        }
    }
}

impl fmt::Debug for Options {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("Options")
            .field("relative_tolerance", &self.relative_tolerance)
            .field("absolute_tolerance", &self.absolute_tolerance)
            .field("max_step", &self.max_step)
            .field("breaks", &self.breaks.len())
            .field("surfaces", &self.surfaces)
            .field("surface", &self.surface)
            .field("laws", &self.laws)
            .field("law", &self.law)
            .field("drive", &self.drive)
            .field("together", &self.together)
            .field("stiffness", &self.stiffness)
            .field("events", &self.events.len())
            .finish_non_exhaustive()
    }
}
