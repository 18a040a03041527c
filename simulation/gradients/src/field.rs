//! Rates of a motion in known modes, and the quantities from which they are computed, with derivatives along
//! `k` directions.
//!
//! A quantity with derivatives is stored as its values, and as rows of `k` derivatives each. The last
//! direction is the motion itself: its derivatives are time derivatives.
//!
//! Theory: docs/theory.md, section 19.1.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use hodograph::{ComponentKind, Mechanism, StateError, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_program::interpret::{Arguments, Directional, Failed, Rates};
use hodograph_program::program::{ContactQuantity, Quantity};

use crate::By;

/// A state with its derivatives along the directions.
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    pub time: f64,
    /// coordinates and independent speeds
    pub state: &'a [f64],
    /// their derivatives: one row each, `k` columns
    pub by: &'a [f64],
    /// derivatives of the time (k); empty if they are zero
    pub time_by: &'a [f64],
    pub inputs: &'a [f64],
    /// row of the table of sampled inputs
    pub row: usize,
}

/// Variables that change together, with their rates.
pub(crate) type Direction = Vec<(By, f64)>;

/// The equations of a mechanism and the directions along which they are differentiated.
pub(crate) struct Field<'m> {
    pub mechanism: &'m InterpretedMechanism,
    pub directions_of: Vec<Direction>,
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// number of coordinates and of independent speeds
    pub n: usize,
    pub p: usize,
    /// number of directions, of which the last is the motion itself
    pub k: usize,
    by_parameters: Vec<f64>,
    /// for each direction the relative change of its parameters, the sum of all
    pub relative: Vec<f64>,
    /// of inputs that do not change, or all of whose samples change
    by_inputs: Vec<f64>,
    sampling: Option<Sampling>,
    routines: RefCell<BTreeMap<RoutineKey, Rc<Directional>>>,
}

/// The times at which rows of a table of inputs begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    /// s
    pub start: f64,
    pub period: f64,
    pub rows: usize,
}

/// The key of a routine that evaluates equations.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum RoutineKey {
    /// rates, and the terms for the forces at these contacts
    ContactTerms(Vec<usize>),
    /// a gap
    Gap(usize),
}

impl RoutineKey {
    /// What the routine computes, in this order.
    pub fn quantities(&self) -> Vec<Quantity> {
        let of = |contact: usize, quantity| Quantity::Contact(contact as u32, quantity);
        match self {
            RoutineKey::Gap(contact) => vec![of(*contact, ContactQuantity::Gap)],
            RoutineKey::ContactTerms(contacts) => {
                let each = |&contact: &usize| OF_CONTACT.map(|quantity| of(contact, quantity));
                let whole = [Quantity::CoordinateRates, Quantity::Accelerations];
                whole.into_iter().chain(contacts.iter().flat_map(each)).collect()
            }
        }
    }
}

impl<'m> Field<'m> {
    pub fn new(
        mechanism: &'m InterpretedMechanism,
        directions_of: Vec<Direction>,
        surfaces: Vec<(usize, Surface<f64>)>,
        sampling: Option<Sampling>,
    ) -> Self {
        let k = directions_of.len() + 1;
        let model = mechanism.model();
        let run_time: Vec<usize> =
            (0..model.parameters.len()).filter(|&index| !model.parameters[index].fixed).collect();
        let mut by_parameters = vec![0.0; model.parameters.len() * k];
        let mut relative = vec![0.0; k];
        let mut by_inputs = vec![0.0; model.inputs.len() * k];
        for (direction, variables) in directions_of.iter().enumerate() {
            for &(by, rate) in variables {
                match by {
                    By::Parameter(index) => {
                        by_parameters[run_time[index] * k + direction] += rate;
                        let value = mechanism.all_parameters()[run_time[index]];
                        if value != 0.0 {
                            relative[direction] += (rate / value).abs();
                        }
                    }
                    By::Input(index) => by_inputs[index * k + direction] += rate,
                    _ => {}
                }
            }
        }
        Field {
            mechanism,
            directions_of,
            surfaces,
            n: mechanism.count(ComponentKind::Coordinate),
            p: mechanism.count(ComponentKind::Speed),
            k,
            by_parameters,
            relative,
            by_inputs,
            sampling,
            routines: RefCell::default(),
        }
    }

    /// The surface of a contact.
    pub fn surface(&self, contact: usize) -> Option<Surface<f64>> {
        self.surfaces.iter().find(|(other, _)| *other == contact).map(|(_, surface)| *surface)
    }

    /// The rate of mu of a contact along a direction.
    pub fn by_friction(&self, direction: usize, contact: usize) -> f64 {
        self.rate(direction, |by| by.is_friction_of(contact))
    }

    /// The rate of e of a contact along a direction.
    pub fn by_restitution(&self, direction: usize, contact: usize) -> f64 {
        self.rate(direction, |by| by.is_restitution_of(contact))
    }

    fn rate(&self, direction: usize, is: impl Fn(By) -> bool) -> f64 {
        let variables = self.directions_of.get(direction).into_iter().flatten();
        variables.filter(|(by, _)| is(*by)).map(|(_, rate)| rate).sum()
    }

    /// The row of the table of sampled inputs from a time on; 0 without a table.
    pub fn row(&self, time: f64) -> usize {
        let Some(Sampling { start, period, rows }) = self.sampling else { return 0 };
        // Samples begin at such times up to rounding.
        let since = ((time - start) / period * (1.0 + 1e-12) + 1e-9).max(0.0);
        (since as usize).min(rows.saturating_sub(1))
    }

    /// Number of rows of the table of sampled inputs; 1 without a table.
    pub fn rows(&self) -> usize {
        self.sampling.map_or(1, |sampling| sampling.rows)
    }

    /// Derivatives of the inputs in a row of the table of samples.
    fn by_inputs(&self, row: usize) -> Cow<'_, [f64]> {
        let mut by = Cow::Borrowed(&self.by_inputs[..]);
        for (direction, variables) in self.directions_of.iter().enumerate() {
            for &(variable, rate) in variables {
                if let By::Sample { input, row: own } = variable
                    && own == row
                {
                    by.to_mut()[input * self.k + direction] += rate;
                }
            }
        }
        by
    }

    fn routine(&self, key: RoutineKey) -> Rc<Directional> {
        let make = || {
            let quantities = key.quantities();
            let parameters = (self.mechanism.all_parameters(), &self.by_parameters[..]);
            let (program, constants) = (self.mechanism.program(), self.mechanism.constants());
            Rc::new(Directional::new(program, constants, parameters, self.k, &quantities))
        };
        let mut routines = self.routines.borrow_mut();
        if let Some(known) = routines.get(&key) {
            return Rc::clone(known);
        }
        let made = make();
        routines.insert(key, Rc::clone(&made));
        made
    }

    fn compute(&self, key: RoutineKey, at: &At<'_>) -> Result<(Vec<f64>, Vec<f64>), StateError> {
        let (q, u) = at.state.split_at(self.n);
        let (by_q, by_u) = at.by.split_at(self.n * self.k);
        let arguments = Arguments {
            time: at.time,
            coordinates: q,
            speeds: u,
            inputs: at.inputs,
            accelerations: &[],
            tangent: &[],
        };
        let inputs = self.by_inputs(at.row);
        let rates = Rates { time: at.time_by, coordinates: by_q, speeds: by_u, inputs: &inputs };
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        let done = self.routine(key).evaluate(&arguments, &rates, &mut values, &mut derivatives);
        done.map_err(failed)?;
        Ok((values, derivatives))
    }

    /// A gap, and its derivatives.
    pub fn gap(&self, contact: usize, at: &At<'_>) -> Result<(f64, Vec<f64>), StateError> {
        let (values, by) = self.compute(RoutineKey::Gap(contact), at)?;
        let gap = values.first().ok_or(StateError::Undefined { what: "gap of this contact" })?;
        Ok((*gap, by))
    }

    /// The rates without contact forces, and the terms for the forces at these contacts.
    pub fn contact_terms(&self, contacts: &[usize], at: &At<'_>) -> Result<ContactTerms, StateError> {
        let (values, by) = self.compute(RoutineKey::ContactTerms(contacts.to_vec()), at)?;
        ContactTerms { n: self.n, p: self.p, k: self.k, values, by }.of_contacts(contacts.len())
    }
}

/// Why equations have no value.
pub(crate) fn failed(failed: Failed) -> StateError {
    match failed {
        Failed::Singular(_) => StateError::Singular { what: "the state" },
        Failed::NotFinite => StateError::NotFinite,
    }
}

/// The quantities of a contact from which its forces are computed, in this order.
const OF_CONTACT: [ContactQuantity; 4] = [
    ContactQuantity::PartialVelocities,
    ContactQuantity::Response,
    ContactQuantity::Velocity,
    ContactQuantity::FreeAcceleration,
];

/// Rates without contact forces, and for each contact V, M^-1 V^T, velocity and free acceleration.
pub(crate) struct ContactTerms {
    n: usize,
    p: usize,
    k: usize,
    values: Vec<f64>,
    by: Vec<f64>,
}

impl ContactTerms {
    /// Terms without derivatives.
    pub fn values(field: &Field<'_>, values: Vec<f64>, contacts: usize) -> Result<Self, StateError> {
        ContactTerms { n: field.n, p: field.p, k: 0, values, by: Vec::new() }.of_contacts(contacts)
    }

    /// Checks that all contacts have their terms.
    fn of_contacts(self, contacts: usize) -> Result<Self, StateError> {
        if self.values.len() == self.of(contacts) {
            Ok(self)
        } else {
            Err(StateError::Undefined { what: "closed contact" })
        }
    }

    /// The value with this index.
    pub fn value(&self, index: usize) -> f64 {
        self.values[index]
    }

    /// Its derivatives.
    pub fn by(&self, index: usize) -> &[f64] {
        &self.by[index * self.k..][..self.k]
    }

    fn of(&self, place: usize) -> usize {
        self.n + self.p + place * (6 * self.p + 6)
    }

    /// Index of a partial velocity of a contact.
    pub fn partial(&self, place: usize, axis: usize, speed: usize) -> usize {
        self.of(place) + axis * self.p + speed
    }

    /// Index of the response of a speed to a force along an axis.
    pub fn response(&self, place: usize, axis: usize, speed: usize) -> usize {
        self.of(place) + 3 * self.p + 3 * speed + axis
    }

    /// Index of a component of the velocity of a contact.
    pub fn velocity(&self, place: usize, axis: usize) -> usize {
        self.of(place) + 6 * self.p + axis
    }

    /// Index of a component of its free acceleration.
    pub fn free(&self, place: usize, axis: usize) -> usize {
        self.of(place) + 6 * self.p + 3 + axis
    }

    /// The sum of the magnitudes of the terms in the velocity of a contact along an axis.
    pub fn velocity_size(&self, place: usize, axis: usize, speeds: &[f64]) -> f64 {
        let term = |(speed, u): (usize, &f64)| (self.values[self.partial(place, axis, speed)] * u).abs();
        speeds.iter().enumerate().map(term).sum()
    }
}
