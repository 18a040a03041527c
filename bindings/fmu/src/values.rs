//! The values of variables that are computed from a state.

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_simulation::{ContactForces, ContactPhase, Simulation};

use crate::layout::VariableKind;
use crate::running::Running;
use crate::settings::Now;
use crate::words::Told;

/// The variables that are computed from a state. They are evaluated when they are read; intermediate results
/// are stored.
pub struct Values<'r> {
    running: &'r Running,
    now: &'r Now,
    rates: Option<Result<Vec<f64>, String>>,
    forces: Option<Result<ContactForces, String>>,
    indicators: Option<Result<Vec<f64>, String>>,
    dependent: Option<Result<Vec<f64>, String>>,
}

impl<'r> Values<'r> {
    /// The values in a state.
    pub fn new(running: &'r Running, now: &'r Now) -> Self {
        Self { running, now, rates: None, forces: None, indicators: None, dependent: None }
    }

    fn state(&self) -> State<'r> {
        self.now.state()
    }

    fn simulation(&self) -> &'r Simulation<'r> {
        self.running.simulation()
    }

    /// The value of a number.
    ///
    /// # Errors
    ///
    /// A sentence: the variable is not computed from the state, or cannot be evaluated there.
    pub fn number(&mut self, what: VariableKind) -> Result<f64, String> {
        let mechanism: &dyn Mechanism = self.running.mechanism();
        let state = self.state();
        let missing = || "the variable is not a number that is computed from the state".to_owned();
        let (n, now) = (state.coordinates.len(), self.now);
        let value = match what {
            VariableKind::Time => now.time,
            VariableKind::Input(index) => *now.inputs.get(index).ok_or_else(missing)?,
            VariableKind::Coordinate(index) => *now.coordinates.get(index).ok_or_else(missing)?,
            VariableKind::Speed(index) => *now.speeds.get(index).ok_or_else(missing)?,
            VariableKind::CoordinateRate(index) => *self.rates()?.get(index).ok_or_else(missing)?,
            VariableKind::SpeedRate(index) => *self.rates()?.get(n + index).ok_or_else(missing)?,
            VariableKind::DependentSpeed(index) => {
                *self.dependent_speeds()?.get(index).ok_or_else(missing)?
            }
            VariableKind::Position(point, axis) => {
                *mechanism.position(point, &state).map_err(text)?.as_slice().get(axis).ok_or_else(missing)?
            }
            VariableKind::Gap(contact) => {
                self.running.mechanism().gap(contact, &state).map_err(text)?.ok_or_else(missing)?
            }
            VariableKind::Force(contact, axis) => {
                let found = self.forces()?.iter().find(|(index, _)| *index == contact);
                found.map_or(0.0, |(_, force)| force.as_slice().get(axis).copied().unwrap_or(0.0))
            }
            VariableKind::KineticEnergy => mechanism.kinetic_energy(&state).map_err(text)?,
            VariableKind::PotentialEnergy => {
                mechanism.potential_energy(&state).map_err(text)?.ok_or_else(missing)?
            }
            VariableKind::Indicator(place) => *self.indicators()?.get(place).ok_or_else(missing)?,
            _ => return Err(missing()),
        };
        if value.is_finite() { Ok(value) } else { Err(format!("the answer is {value} in this state")) }
    }

    /// The mode of a contact: 0 open, 1 stick, 2 slide.
    pub fn phase(&self, contact: usize) -> i64 {
        match self.simulation().phase(contact) {
            Some(ContactPhase::Stick) => 1,
            Some(ContactPhase::Slide) => 2,
            _ => 0,
        }
    }

    /// Rates of coordinates, then speeds.
    ///
    /// # Errors
    ///
    /// A sentence: they cannot be computed.
    pub fn rates(&mut self) -> Result<&[f64], String> {
        let (state, simulation) = (self.state(), self.simulation());
        let found = self.rates.get_or_insert_with(|| {
            let mut rates = vec![0.0; state.coordinates.len() + state.speeds.len()];
            simulation.rates(&state, &mut rates).map_err(text)?;
            Ok(rates)
        });
        found.as_deref().map_err(Clone::clone)
    }

    /// The event indicators.
    ///
    /// # Errors
    ///
    /// A sentence: they cannot be computed.
    pub fn indicators(&mut self) -> Result<&[f64], String> {
        let (state, simulation) = (self.state(), self.simulation());
        let found = self.indicators.get_or_insert_with(|| simulation.indicator_values(&state).map_err(text));
        found.as_deref().map_err(Clone::clone)
    }

    fn forces(&mut self) -> Result<&ContactForces, String> {
        let (state, simulation) = (self.state(), self.simulation());
        let found = self.forces.get_or_insert_with(|| simulation.contact_forces_in(&state).map_err(text));
        found.as_ref().map_err(Clone::clone)
    }

    fn dependent_speeds(&mut self) -> Result<&[f64], String> {
        let (state, mechanism) = (self.state(), self.running.mechanism());
        let found = self.dependent.get_or_insert_with(|| {
            let mut speeds = vec![0.0; mechanism.count(ComponentKind::DependentSpeed)];
            mechanism.dependent_speeds(&state, &mut speeds).map_err(text)?;
            Ok(speeds)
        });
        found.as_deref().map_err(Clone::clone)
    }
}

fn text(error: impl Told) -> String {
    error.told()
}
