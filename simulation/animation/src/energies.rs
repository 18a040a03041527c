//! The energies of a motion over time.

use hodograph::{Contacts, State};
use hodograph_model::model::mechanism::{Load, LoadKind, Mechanism};

/// Energies at the recorded moments, J.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    kinetic: Vec<f64>,
    /// the potential energy; `None` if that of the mechanism is not defined
    potential: Vec<Option<f64>>,
}

impl Energies {
    /// Records the energies of a state.
    pub fn add(&mut self, mechanism: &dyn Contacts<f64>, state: &State<'_>) {
        self.kinetic.push(mechanism.kinetic_energy(state).unwrap_or(f64::NAN));
        self.potential.push(mechanism.potential_energy(state).unwrap_or(Some(f64::NAN)));
    }

    /// The curves by name, and a note if one is missing: a potential energy that is not defined is not zero,
    /// so that there is no sum of energies.
    pub fn curves(self, model: &Mechanism) -> (Vec<(&'static str, Vec<f64>)>, Option<String>) {
        let potential: Option<Vec<f64>> = self.potential.into_iter().collect();
        let kinetic = self.kinetic;
        let Some(potential) = potential else {
            return (vec![("kinetic", kinetic)], missing(model));
        };
        let sum = kinetic.iter().zip(&potential).map(|(kinetic, potential)| kinetic + potential).collect();
        (vec![("kinetic", kinetic), ("potential", potential), ("sum", sum)], None)
    }
}

/// The note on a model without potential energy; `None` if no load could have one.
pub fn missing(model: &Mechanism) -> Option<String> {
    let fed = |load: &&Load| !matches!(load.kind, LoadKind::Force { .. } | LoadKind::Torque { .. });
    let mut loads = model.loads.iter().filter(fed).peekable();
    loads.peek()?;
    let why = match loads.find(|load| !load.potential).map(|load| &load.kind) {
        Some(LoadKind::Gravity(_)) => {
            "its gravity depends on coordinates or inputs, or a mass centre moves otherwise than its place"
        }
        Some(_) => {
            "a spring depends on coordinates or inputs, or its length or angle changes otherwise than what it moves"
        }
        None => "the position of a body with weight follows from velocities alone",
    };
    Some(format!(
        "the potential energy of {} is not defined ({why}): neither it nor the sum of the energies is shown",
        model.name
    ))
}
