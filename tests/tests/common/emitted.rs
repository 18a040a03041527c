//! The emitted modules of all shipped models behind one interface; `tests/build.rs` writes the
//! implementations.

use hodograph::lanes::{F64x4, Lanes};
use hodograph::nalgebra::SMatrix;
use hodograph::{Contacts, StateError, Surface};
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::program::Inputs;
use hodograph_generator::program::Quantity;
use num_dual::Dual64;

/// An emitted module. Matrices are by rows.
pub trait Emitted {
    /// name of the module
    fn name(&self) -> &'static str;
    /// a routine by its name, if there is one; the error is its message
    fn call(&self, routine: &str, at: &Inputs) -> Option<Result<Vec<f64>, String>>;
    /// the routines with another one beside them, `.._into`, that writes the answer in place
    fn in_place(&self) -> &'static [&'static str];
    /// the routines that tests call for four states at once
    fn of_lanes(&self) -> &'static [&'static str];
    /// a routine for four states at once, if it is one of these; the error is its message
    fn in_lanes(&self, routine: &str, at: &[Inputs; 4]) -> Option<Result<Vec<F64x4>, String>>;
    /// the derivative of a routine along a direction (coordinates, speeds, inputs), by numbers that carry
    /// derivatives
    fn along(&self, routine: &str, at: &Inputs, along: &Inputs) -> Option<Vec<f64>>;
    /// a collision; the error is its message
    fn collide(&self, contact: usize, at: &Inputs, surface: &Surface<f64>) -> Result<Hit, String>;
    /// the mechanism by its traits
    fn by_slices(&self, at: &Inputs) -> Box<dyn Contacts>;
}

impl dyn Emitted + '_ {
    /// A quantity, if there is a routine for it.
    pub fn get(&self, mechanism: &Mechanism, quantity: Quantity, at: &Inputs) -> Option<Vec<f64>> {
        let routine = routine(mechanism, quantity)?;
        let name = self.name();
        Some(self.call(&routine, at)?.unwrap_or_else(|error| panic!("{name}::{routine}: {error}")))
    }
}

/// The name of the routine of a quantity. Bases and responses of contacts have none: collisions use them.
pub fn routine(mechanism: &Mechanism, quantity: Quantity) -> Option<String> {
    quantity.method(mechanism)
}

/// A solved collision.
#[derive(Clone, Debug)]
pub struct Hit {
    /// independent speeds after it
    pub speeds: Vec<f64>,
    /// impulse along n, t, s
    pub impulse: [f64; 3],
    /// velocity of approach along n, t, s
    pub approach: [f64; 3],
    /// velocity of separation along n, t, s
    pub separation: [f64; 3],
    /// reduced matrix along n, t, s: nn, nt, ns, tt, ts, ss
    pub reduced: [f64; 6],
    /// change of kinetic energy
    pub energy_change: f64,
    /// work of the contact impulse
    pub contact_work: f64,
    /// work of the normal impulse
    pub normal_work: f64,
}

/// Another state.
fn elsewhere(at: &Inputs) -> Inputs {
    let moved = |list: &[f64]| list.iter().map(|number| number * 0.75 + 0.01).collect();
    Inputs { coordinates: moved(&at.coordinates), speeds: moved(&at.speeds), ..at.clone() }
}

/// A list as an array.
fn array<const N: usize>(list: &[f64]) -> [f64; N] {
    list.try_into().expect("as many numbers as fields")
}

/// Numbers that change along a direction; those that it does not name do not.
fn duals<const N: usize>(list: &[f64], along: &[f64]) -> [Dual64; N] {
    let rates = along.iter().copied().chain(std::iter::repeat(0.0));
    let all: Vec<Dual64> = list.iter().zip(rates).map(|(&number, rate)| Dual64::new(number, rate)).collect();
    all.try_into().expect("as many numbers as fields")
}

fn by_rows<T: Copy, const R: usize, const C: usize>(matrix: SMatrix<T, R, C>) -> Vec<T> {
    (0..R).flat_map(|row| (0..C).map(move |column| (row, column))).map(|place| matrix[place]).collect()
}

/// Value and derivatives as one matrix, by rows.
macro_rules! beside {
    ($derivatives:expr) => {{
        let found = $derivatives;
        let rows = found.value.len();
        let row = |row: usize| {
            let derivatives = found
                .by_coordinates
                .row(row)
                .iter()
                .chain(found.by_speeds.row(row).iter())
                .copied()
                .collect::<Vec<_>>();
            let inputs = found.by_inputs.row(row).iter().copied().collect();
            [vec![found.value[row]], derivatives, inputs].concat()
        };
        (0..rows).flat_map(row).collect()
    }};
}

/// What a collision at a contact is made of, with its derivatives, as one matrix by rows. Reduced matrix,
/// response and gap do not change with speeds and inputs.
macro_rules! contact_beside {
    ($derivatives:expr) => {{
        let d = $derivatives;
        let still = d.velocity_by_speeds.ncols() + d.velocity_by_inputs.ncols();
        let mut all: Vec<f64> = Vec::new();
        for row in 0..3 {
            all.push(d.velocity[row]);
            all.extend(d.velocity_by_coordinates.row(row).iter());
            all.extend(d.velocity_by_speeds.row(row).iter());
            all.extend(d.velocity_by_inputs.row(row).iter());
        }
        let reduced: [f64; 6] = d.reduced.into();
        for (row, entry) in reduced.into_iter().enumerate() {
            all.push(entry);
            all.extend(d.reduced_by_coordinates.row(row).iter());
            all.extend(std::iter::repeat_n(0.0, still));
        }
        for (speed, axis) in (0..d.response.nrows()).flat_map(|speed| (0..3).map(move |axis| (speed, axis))) {
            all.push(d.response[(speed, axis)]);
            all.extend(d.response_by_coordinates.iter().map(|by| by[(speed, axis)]));
            all.extend(std::iter::repeat_n(0.0, still));
        }
        if let (Some(gap), Some(by)) = (d.gap, d.gap_by_coordinates) {
            all.push(gap);
            all.extend(by.iter());
            all.extend(std::iter::repeat_n(0.0, still));
        }
        all
    }};
}

macro_rules! hit {
    ($collision:expr) => {{
        let hit = $collision.map_err(|error| error.to_string())?;
        Ok(Hit {
            speeds: <[f64; _]>::from(hit.speeds).to_vec(),
            impulse: hit.impulse.into(),
            approach: hit.approach.into(),
            separation: hit.separation.into(),
            reduced: hit.reduced.into(),
            energy_change: hit.energy_change,
            contact_work: hit.impact.contact_work,
            normal_work: hit.impact.normal_work,
        })
    }};
}

include!(concat!(env!("OUT_DIR"), "/emitted.rs"));
