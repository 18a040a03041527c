//! The options of a simulation.

use std::fmt;
use std::sync::Arc;

use hodograph::Surface;

use crate::{ContactLaw, Drive};

/// A function of time, coordinates and speeds whose zeros are events.
pub type EventFunction = Arc<dyn Fn(f64, &[f64], &[f64]) -> f64 + Send + Sync>;

/// The treatment of several contacts that are struck at the same time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImpactsAtOnce {
    /// All approaching contacts are struck at once, with friction: by Poisson's hypothesis in two phases if
    /// all of them have that law, else by Moreau's law. Contacts that their impulses press together are
    /// struck next, until none approaches. A single contact is solved exactly, by its own law.
    #[default]
    Approaching,
    /// Contacts are struck successively, the fastest approach first, until none approaches.
    Sequential,
    /// All closed contacts at once, by the same laws. Moreau's law is v+_n >= -e v-_n.
    Simultaneous,
    /// All closed contacts at once, after Liu, Zhao and Brogliato, with the ratios of [`Options::stiffness`];
    /// without friction only.
    Lzb,
    /// Of the contacts that approach a random number, drawn by this seed, is struck at once as by
    /// [`ImpactsAtOnce::Approaching`]; then it is drawn among those that approach after it, until none does. So one
    /// motion is drawn of those that all orders and all ties give ([`crate::OutcomeSet`]).
    Sampled(u64),
    /// The simulation ends with an error.
    Stop,
}

impl ImpactsAtOnce {
    /// The names of all of them, as [`ImpactsAtOnce::named`] reads them.
    pub const NAMES: [&str; 6] = ["approaching", "sequential", "simultaneous", "lzb", "sampled", "stop"];

    /// The treatment of this name; `seed` is that of `sampled`.
    pub fn named(name: &str, seed: u64) -> Option<Self> {
        Some(match name {
            "approaching" => Self::Approaching,
            "sequential" => Self::Sequential,
            "simultaneous" => Self::Simultaneous,
            "lzb" => Self::Lzb,
            "sampled" => Self::Sampled(seed),
            "stop" => Self::Stop,
            _ => return None,
        })
    }
}

/// The least relative tolerance: below it the roundings of a step exceed what is asked for, and no step is short enough.
const LEAST_TOLERANCE: f64 = 1e-16;
/// The greatest one: above it no digit of a step is known.
const GREATEST_TOLERANCE: f64 = 0.1;

/// Options of a simulation. Start from `Options::default()`.
#[derive(Clone)]
pub struct Options {
    /// relative tolerance of the integration
    pub relative_tolerance: f64,
    /// absolute tolerance of the integration, in the units of coordinates and speeds; bounces lower than
    /// this, in metres, end in lasting contact
    pub absolute_tolerance: f64,
    /// greatest step of the integration, s
    pub max_step: f64,
    /// times at which inputs or their rates jump, increasing, s: steps of the integration end at the next of
    /// them
    pub breaks: Vec<f64>,
    /// the surfaces of individual contacts, by index
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// the surface of all other contacts; `None`: those that the model states
    /// ([`Contacts::surface`](hodograph::Contacts::surface))
    pub surface: Option<Surface<f64>>,
    /// the laws of individual contacts beyond mu, e and law of their surfaces, by index
    pub laws: Vec<(usize, ContactLaw)>,
    /// the law of all other contacts; `None`: those that the model states
    /// ([`Contacts::stated_law`](hodograph::Contacts::stated_law))
    pub law: Option<ContactLaw>,
    /// the source of inputs
    pub drive: Drive,
    /// the treatment of several contacts that are struck at the same time
    pub together: ImpactsAtOnce,
    /// for [`ImpactsAtOnce::Lzb`]: the stiffnesses of contacts, by index; only their ratios matter, and the
    /// default is 1
    pub stiffness: Vec<(usize, f64)>,
    /// whether the outcomes of all orders of up to four contacts struck at the same time are compared
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

impl Options {
    /// Checks a relative tolerance.
    ///
    /// # Errors
    ///
    /// A sentence: the condition that is violated.
    pub fn check_tolerance(tolerance: f64) -> Result<(), String> {
        if tolerance.is_nan() || tolerance <= 0.0 {
            return Err(format!("the tolerance is {tolerance}: it must be positive"));
        }
        if tolerance < LEAST_TOLERANCE {
            return Err(format!(
                "the tolerance is {tolerance:e}: doubles have 16 digits, and the least tolerance is {LEAST_TOLERANCE:e}"
            ));
        }
        if tolerance > GREATEST_TOLERANCE {
            return Err(format!(
                "the tolerance is {tolerance:?}: it is relative, and the greatest is {GREATEST_TOLERANCE}"
            ));
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_a_treatment() {
        for name in ImpactsAtOnce::NAMES {
            let treatment = ImpactsAtOnce::named(name, 3);
            assert_eq!(treatment.map(|of| format!("{of:?}").to_lowercase().starts_with(name)), Some(true));
        }
        assert_eq!(ImpactsAtOnce::named("Stop", 0), None);
    }
}
