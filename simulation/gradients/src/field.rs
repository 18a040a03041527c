//! Rates of a motion in known modes, and all that they follow from, with derivatives along `k` directions.
//!
//! Numbers with derivatives stand as values, and as rows of `k` derivatives each. The last direction is kept for the motion
//! itself: along it time goes on.
//!
//! Theory: docs/theory.md, section 19.1.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use hodograph::{ComponentKind, Mechanism, StateError, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_program::interpret::{Arguments, Directional, Failed, Rates};
use hodograph_program::program::{ContactQuantity, Quantity};

use crate::By;

/// A state and how it changes along the directions.
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    pub time: f64,
    /// coordinates and independent speeds
    pub state: &'a [f64],
    /// their derivatives: as many rows, `k` columns
    pub by: &'a [f64],
    /// the derivatives of the time (k); none where it does not change
    pub time_by: &'a [f64],
    pub inputs: &'a [f64],
}

/// The equations of a mechanism, with what they are differentiated by.
pub(crate) struct Field<'m> {
    pub mechanism: &'m InterpretedMechanism,
    pub by: &'m [By],
    pub surfaces: &'m [(usize, Surface<f64>)],
    /// number of coordinates and of independent speeds
    pub n: usize,
    pub p: usize,
    /// number of directions: those of `by`, and the motion itself
    pub k: usize,
    by_parameters: Vec<f64>,
    by_inputs: Vec<f64>,
    routines: RefCell<BTreeMap<Asked, Rc<Directional>>>,
}

/// What is asked of the equations.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Asked {
    /// rates, and what forces at these contacts follow from
    Together(Vec<usize>),
    /// a gap
    Gap(usize),
}

impl<'m> Field<'m> {
    pub fn new(
        mechanism: &'m InterpretedMechanism,
        by: &'m [By],
        surfaces: &'m [(usize, Surface<f64>)],
    ) -> Self {
        let k = by.len() + 1;
        let model = mechanism.model();
        let run_time: Vec<usize> =
            (0..model.parameters.len()).filter(|&index| !model.parameters[index].fixed).collect();
        let mut by_parameters = vec![0.0; model.parameters.len() * k];
        let mut by_inputs = vec![0.0; model.inputs.len() * k];
        for (direction, by) in by.iter().enumerate() {
            match *by {
                By::Parameter(index) => by_parameters[run_time[index] * k + direction] = 1.0,
                By::Input(index) => by_inputs[index * k + direction] = 1.0,
                _ => {}
            }
        }
        Field {
            mechanism,
            by,
            surfaces,
            n: mechanism.count(ComponentKind::Coordinate),
            p: mechanism.count(ComponentKind::Speed),
            k,
            by_parameters,
            by_inputs,
            routines: RefCell::default(),
        }
    }

    /// The surface of a contact.
    pub fn surface(&self, contact: usize) -> Option<Surface<f64>> {
        self.surfaces.iter().find(|(other, _)| *other == contact).map(|(_, surface)| *surface)
    }

    fn routine(&self, asked: Asked) -> Rc<Directional> {
        let make = || {
            let of = |contact: usize, quantity| Quantity::Contact(contact as u32, quantity);
            let quantities: Vec<Quantity> = match &asked {
                Asked::Gap(contact) => vec![of(*contact, ContactQuantity::Gap)],
                Asked::Together(contacts) => {
                    let each = |&contact: &usize| OF_EACH.map(|quantity| of(contact, quantity));
                    let whole = [Quantity::CoordinateRates, Quantity::Accelerations];
                    whole.into_iter().chain(contacts.iter().flat_map(each)).collect()
                }
            };
            let parameters = (self.mechanism.all_parameters(), &self.by_parameters[..]);
            let (program, constants) = (self.mechanism.program(), self.mechanism.constants());
            Rc::new(Directional::new(program, constants, parameters, self.k, &quantities))
        };
        let mut routines = self.routines.borrow_mut();
        if let Some(known) = routines.get(&asked) {
            return Rc::clone(known);
        }
        let made = make();
        routines.insert(asked, Rc::clone(&made));
        made
    }

    fn compute(&self, asked: Asked, at: &At<'_>) -> Result<(Vec<f64>, Vec<f64>), StateError> {
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
        let rates = Rates { time: at.time_by, coordinates: by_q, speeds: by_u, inputs: &self.by_inputs };
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        let done = self.routine(asked).evaluate(&arguments, &rates, &mut values, &mut derivatives);
        done.map_err(|failed| match failed {
            Failed::Singular(_) => StateError::Singular { what: "the state" },
            Failed::NotFinite => StateError::NotFinite,
        })?;
        Ok((values, derivatives))
    }

    /// A gap, and its derivatives.
    pub fn gap(&self, contact: usize, at: &At<'_>) -> Result<(f64, Vec<f64>), StateError> {
        let (values, by) = self.compute(Asked::Gap(contact), at)?;
        let gap = values.first().ok_or(StateError::Undefined { what: "gap of this contact" })?;
        Ok((*gap, by))
    }

    /// The rates without contact forces, and what forces at these contacts follow from.
    pub fn together(&self, contacts: &[usize], at: &At<'_>) -> Result<Together, StateError> {
        let (n, p) = (self.n, self.p);
        let (values, by) = self.compute(Asked::Together(contacts.to_vec()), at)?;
        if values.len() != n + p + contacts.len() * (6 * p + 6) {
            return Err(StateError::Undefined { what: "closed contact" });
        }
        Ok(Together { n, p, k: self.k, values, by })
    }
}

/// What forces of a contact follow from, in this order.
const OF_EACH: [ContactQuantity; 4] = [
    ContactQuantity::PartialVelocities,
    ContactQuantity::Response,
    ContactQuantity::Velocity,
    ContactQuantity::FreeAcceleration,
];

/// Rates without contact forces, and of each contact V, M^-1 V^T, velocity and free acceleration.
pub(crate) struct Together {
    n: usize,
    p: usize,
    k: usize,
    values: Vec<f64>,
    by: Vec<f64>,
}

impl Together {
    /// A number.
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

    /// Where a partial velocity of a contact stands.
    pub fn partial(&self, place: usize, axis: usize, speed: usize) -> usize {
        self.of(place) + axis * self.p + speed
    }

    /// Where the response of a speed to a force along an axis stands.
    pub fn response(&self, place: usize, axis: usize, speed: usize) -> usize {
        self.of(place) + 3 * self.p + 3 * speed + axis
    }

    /// Where a component of the velocity of a contact stands.
    pub fn velocity(&self, place: usize, axis: usize) -> usize {
        self.of(place) + 6 * self.p + axis
    }

    /// Where a component of its free acceleration stands.
    pub fn free(&self, place: usize, axis: usize) -> usize {
        self.of(place) + 6 * self.p + 3 + axis
    }

    /// The sizes of the terms that make up the velocity of a contact along an axis.
    pub fn velocity_size(&self, place: usize, axis: usize, speeds: &[f64]) -> f64 {
        let term = |(speed, u): (usize, &f64)| (self.values[self.partial(place, axis, speed)] * u).abs();
        speeds.iter().enumerate().map(term).sum()
    }
}
