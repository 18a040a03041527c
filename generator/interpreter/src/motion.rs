//! What a motion is simulated with where nothing else is said: one set of defaults for the command line tool
//! and for Python. (The tolerance is that of `hodograph_simulation::Options`.)

use std::fmt;

use hodograph::{Cause, ComponentKind, Contacts, ImpactError, Law, State, Surface};
use hodograph_program::program::Program;
use hodograph_program::program::graph::Input;
use hodograph_program::program::operation::Operation;

/// Time from sample to sample, s.
pub const STEP: f64 = 0.01;
/// Greatest step of the integration where something depends on time by itself, s: it must not be stepped
/// over.
pub const STEP_OF_TIME: f64 = 0.05;

/// The greatest step of the integration of a motion by this program, s.
pub(crate) fn greatest_step(program: &Program, driven: bool) -> f64 {
    let is_time = |operation: &Operation| matches!(operation, Operation::Input(Input::Time));
    if driven || program.operations.iter().any(is_time) { STEP_OF_TIME } else { f64::INFINITY }
}

/// What is given of the surface of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GivenSurface {
    /// Coulomb's coefficient of friction
    pub mu: Option<f64>,
    /// coefficient of restitution
    pub e: Option<f64>,
    /// hypothesis of restitution
    pub law: Option<Law>,
}

impl From<Surface<f64>> for GivenSurface {
    fn from(surface: Surface<f64>) -> Self {
        GivenSurface { mu: Some(surface.mu), e: Some(surface.e), law: Some(surface.law) }
    }
}

impl GivenSurface {
    /// What is not given here is taken from another.
    pub fn or(self, other: Self) -> Self {
        GivenSurface { mu: self.mu.or(other.mu), e: self.e.or(other.e), law: self.law.or(other.law) }
    }

    /// The surface, if all of it is given.
    pub fn whole(self) -> Option<Surface<f64>> {
        Some(Surface { mu: self.mu?, e: self.e?, law: self.law? })
    }

    /// What is not given.
    pub fn missing(self) -> Vec<&'static str> {
        let parts = [("mu", self.mu.is_none()), ("e", self.e.is_none()), ("law", self.law.is_none())];
        parts.into_iter().filter_map(|(name, missing)| missing.then_some(name)).collect()
    }

    /// What the solver would refuse, also where not all is given.
    ///
    /// # Errors
    ///
    /// The error of the solver.
    pub fn check(self) -> Result<Self, ImpactError<f64>> {
        if let Some(value) = [self.mu, self.e].into_iter().flatten().find(|value| !value.is_finite()) {
            return Err(ImpactError::NotFinite { value });
        }
        match self {
            GivenSurface { mu: Some(mu), .. } if mu < 0.0 => Err(ImpactError::NegativeFriction { mu }),
            GivenSurface { e: Some(e), .. } if !(0.0..=1.0).contains(&e) => {
                Err(ImpactError::RestitutionOutOfRange { e })
            }
            _ => Ok(self),
        }
    }
}

/// The surfaces of the contacts of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// of each contact that has a gap, by number
    pub of_contacts: Vec<(usize, Surface<f64>)>,
    /// the contacts without a gap, which are never seen to close
    pub without_gap: Vec<usize>,
}

/// A contact that can close, and of whose surface something is not given.
#[derive(Clone, Debug, PartialEq)]
pub struct NoSurface {
    /// its name
    pub contact: String,
    /// `mu`, `e`, `law`
    pub missing: Vec<&'static str>,
}

impl fmt::Display for NoSurface {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.missing.len() {
            3 => write!(out, "contact {} has no surface", self.contact),
            2 => {
                write!(
                    out,
                    "contact {} has no surface: {} are missing",
                    self.contact,
                    self.missing.join(" and ")
                )
            }
            _ => {
                write!(out, "contact {} has no surface: {} is missing", self.contact, self.missing.join(", "))
            }
        }
    }
}

impl NoSurface {
    /// Its cause.
    pub const fn cause(&self) -> Cause {
        Cause::NoSurface
    }
}

impl std::error::Error for NoSurface {}

/// The surface of every contact that has a gap in a state: its own, for what that leaves open the one of all
/// contacts, then that of the model. There are no other values: which friction is meant cannot be guessed.
///
/// # Errors
///
/// [`NoSurface`] names the first contact that is left without one.
pub fn surfaces(
    mechanism: &dyn Contacts<f64>,
    state: &State<'_>,
    all: GivenSurface,
    own: &[(usize, GivenSurface)],
) -> Result<Surfaces, NoSurface> {
    let mut found = Surfaces::default();
    for contact in 0..mechanism.count(ComponentKind::Contact) {
        // A gap that cannot be evaluated is there: the simulation says why it cannot.
        if let Ok(None) = mechanism.gap(contact, state) {
            found.without_gap.push(contact);
            continue;
        }
        let own = own.iter().rev().find(|(index, _)| *index == contact).map(|(_, surface)| *surface);
        let stated = mechanism.surface(contact).map(GivenSurface::from).unwrap_or_default();
        let given = own.unwrap_or_default().or(all).or(stated);
        let Some(surface) = given.whole() else {
            let name =
                mechanism.component(ComponentKind::Contact, contact).map_or("", |component| component.name);
            return Err(NoSurface { contact: name.to_owned(), missing: given.missing() });
        };
        found.of_contacts.push((contact, surface));
    }
    Ok(found)
}
