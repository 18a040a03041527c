//! The transposes of the derivatives that [`crate::field`], [`crate::mode_rates`] and [`crate::junction`] carry along
//! directions: what a weighted sum of results changes by with the state, the parameters, the inputs, mu and e.
//!
//! Theory: docs/theory.md, section 19.5.

use std::collections::BTreeMap;

use hodograph::{ComponentKind, Mechanism, StateError};
use hodograph_program::interpret::{Arguments, Cotangents, Transposed};
use hodograph_simulation::{Guard, SmoothPart};
use nalgebra::{DVector, Vector3};

use crate::field::{ContactTerms, Field, RoutineKey, failed};
use crate::held::Held;
use crate::junction::{ENTRIES, Junction, Struck};
use crate::modes::{Balance, Mode, Slip};
use crate::{By, Reason};

/// A state without derivatives.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub time: f64,
    /// coordinates and independent speeds
    pub state: &'a [f64],
    pub inputs: &'a [f64],
    /// row of the table of sampled inputs
    pub row: usize,
}

/// The equations of a mechanism with their transposes, and the sums of the derivatives by all but the state.
pub(crate) struct TransposedField<'f> {
    /// the field that is transposed
    pub field: &'f Field<'f>,
    routines: BTreeMap<RoutineKey, OfRoutine>,
    /// for each row of the table of sampled inputs the derivatives by its values
    by_inputs: Vec<Vec<f64>>,
    by_friction: Vec<f64>,
    by_restitution: Vec<f64>,
}

/// Derivatives by all that is no part of the state.
pub(crate) struct Totals {
    /// those that are not fixed
    parameters: Vec<f64>,
    /// for each row of the table of sampled inputs
    inputs: Vec<Vec<f64>>,
    /// by mu and e of each contact
    friction: Vec<f64>,
    restitution: Vec<f64>,
}

impl Totals {
    /// The derivative by a variable; 0 for those of the start state.
    pub fn by(&self, variable: By) -> f64 {
        let of_contacts = |by: &[f64], contact: Option<usize>| match contact {
            Some(contact) => by.get(contact).copied().unwrap_or(0.0),
            None => by.iter().sum(),
        };
        match variable {
            By::Coordinate(_) | By::Speed(_) => 0.0,
            By::Parameter(index) => self.parameters.get(index).copied().unwrap_or(0.0),
            By::Input(index) => self.inputs.iter().filter_map(|row| row.get(index)).sum(),
            By::Sample { input, row } => {
                self.inputs.get(row).and_then(|row| row.get(input)).copied().unwrap_or(0.0)
            }
            By::Friction(contact) => of_contacts(&self.friction, contact),
            By::Restitution(contact) => of_contacts(&self.restitution, contact),
        }
    }
}

/// A routine, and the sum of the derivatives by its constants.
struct OfRoutine {
    routine: Transposed,
    by_constants: Vec<f64>,
}

/// Values of a routine, and the numbers from which they were computed.
struct Evaluated {
    key: RoutineKey,
    row: usize,
    values: Vec<f64>,
    tape: Vec<f64>,
}

/// Rates in known modes, and what they were computed from.
pub(crate) struct ModeTape {
    /// rates of coordinates and speeds
    pub rates: Vec<f64>,
    terms: ContactTerms,
    balance: Balance,
    evaluated: Evaluated,
}

/// Derivatives by a state and its time.
pub(crate) struct ByState {
    pub time: f64,
    /// n + p
    pub state: Vec<f64>,
}

impl ByState {
    fn none(field: &Field<'_>) -> Self {
        ByState { time: 0.0, state: vec![0.0; field.n + field.p] }
    }
}

impl<'f> TransposedField<'f> {
    pub fn new(field: &'f Field<'f>) -> Self {
        let zeros = |kind| vec![0.0; field.mechanism.count(kind)];
        TransposedField {
            field,
            routines: BTreeMap::new(),
            by_inputs: vec![zeros(ComponentKind::Input); field.rows()],
            by_friction: zeros(ComponentKind::Contact),
            by_restitution: zeros(ComponentKind::Contact),
        }
    }

    /// The derivatives by all that is no part of the state.
    pub fn totals(&self) -> Totals {
        let parameters = &self.field.mechanism.model().parameters;
        let mut all = vec![0.0; parameters.len()];
        for of in self.routines.values() {
            let own = of.routine.by_parameters(&of.by_constants);
            all.iter_mut().zip(own).for_each(|(sum, by)| *sum += by);
        }
        let run_time = all.iter().zip(parameters).filter(|(_, parameter)| !parameter.fixed);
        Totals {
            parameters: run_time.map(|(by, _)| *by).collect(),
            inputs: self.by_inputs.clone(),
            friction: self.by_friction.clone(),
            restitution: self.by_restitution.clone(),
        }
    }

    /// The row of the table of sampled inputs from a time on.
    pub fn row(&self, time: f64) -> usize {
        self.field.row(time)
    }

    fn evaluate(&mut self, key: RoutineKey, place: &Place<'_>) -> Result<Evaluated, StateError> {
        let mechanism = self.field.mechanism;
        let make = || {
            let parameters = mechanism.all_parameters().len();
            let quantities = key.quantities();
            let routine =
                Transposed::new(mechanism.program(), mechanism.constants(), parameters, &quantities);
            let by_constants = vec![0.0; routine.constants()];
            OfRoutine { routine, by_constants }
        };
        let routine = self.routines.entry(key.clone()).or_insert_with(make);
        let (coordinates, speeds) = place.state.split_at(self.field.n);
        let arguments = Arguments {
            time: place.time,
            coordinates,
            speeds,
            inputs: place.inputs,
            accelerations: &[],
            tangent: &[],
        };
        let mut tape = Vec::new();
        let values = routine.routine.evaluate(&arguments, &mut tape).map_err(failed)?;
        Ok(Evaluated { key, row: place.row, values, tape })
    }

    /// Adds the derivatives of a weighted sum of the values of a routine.
    fn transpose(&mut self, evaluated: &Evaluated, weights: &[f64], by: &mut ByState) {
        let Some(of) = self.routines.get_mut(&evaluated.key) else { return };
        let (coordinates, speeds) = by.state.split_at_mut(self.field.n);
        let inputs = self.by_inputs.get_mut(evaluated.row).map_or(&mut [][..], |row| &mut row[..]);
        let mut cotangents = Cotangents { time: 0.0, coordinates, speeds, inputs };
        of.routine.transpose(&evaluated.tape, weights, &mut cotangents, &mut of.by_constants);
        by.time += cotangents.time;
    }

    /// The rates in these modes.
    pub fn mode_rates(&mut self, modes: &[Mode], place: &Place<'_>) -> Result<ModeTape, Reason> {
        let (field, n) = (self.field, self.field.n);
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let count = contacts.len();
        let evaluated = self.evaluate(RoutineKey::ContactTerms(contacts), place).map_err(Reason::State)?;
        let terms = ContactTerms::values(field, evaluated.values.clone(), count).map_err(Reason::State)?;
        let balance = field.balance(modes, &terms, &place.state[n..])?;
        let mut rates: Vec<f64> = (0..n + field.p).map(|index| terms.value(index)).collect();
        rates[n..].iter_mut().zip(&balance.pushed).for_each(|(rate, pushed)| *rate += pushed);
        Ok(ModeTape { rates, terms, balance, evaluated })
    }

    /// The derivatives of a sum of the rates and the forces of the closed contacts, with these weights (n + p; n, t, s of
    /// each contact).
    pub fn of_mode_rates(
        &mut self,
        modes: &[Mode],
        tape: &ModeTape,
        of_rates: &[f64],
        of_forces: &[[f64; 3]],
    ) -> Result<ByState, Reason> {
        let mut weights = vec![0.0; tape.evaluated.values.len()];
        weights[..of_rates.len()].copy_from_slice(of_rates);
        self.of_balance(modes, tape, &of_rates[self.field.n..], of_forces, &mut weights)?;
        let mut by = ByState::none(self.field);
        self.transpose(&tape.evaluated, &weights, &mut by);
        Ok(by)
    }

    /// Adds to the weights of the terms what the forces contribute.
    fn of_balance(
        &mut self,
        modes: &[Mode],
        tape: &ModeTape,
        of_accelerations: &[f64],
        of_forces: &[[f64; 3]],
        weights: &mut [f64],
    ) -> Result<(), Reason> {
        let (terms, balance, p) = (&tape.terms, &tape.balance, self.field.p);
        let Balance { unknowns, columns, lambda, pushed, .. } = balance;
        if unknowns.is_empty() {
            return Ok(());
        }
        // The forces: weights of lambda from the accelerations and from the forces themselves.
        let force = |place: usize, axis: usize| of_forces.get(place).map_or(0.0, |of| of[axis]);
        let mut of_lambda = DVector::zeros(unknowns.len());
        for (j, unknown) in unknowns.iter().enumerate() {
            let pushes: f64 = columns[j].iter().zip(of_accelerations).map(|(column, of)| column * of).sum();
            let friction = unknown.slip.iter().flat_map(Slip::friction).enumerate();
            let held: f64 = friction.map(|(axis, f)| f * force(unknown.place, 1 + axis)).sum();
            of_lambda[j] = pushes + force(unknown.place, unknown.axis) - held;
        }
        // With A lambda = b: the weights of b are those of lambda times the inverse of the transpose of A.
        let of_right = solve_transposed(balance, &of_lambda).ok_or(Reason::State(StateError::NotFinite))?;
        let mut moved = vec![0.0; p];
        for (i, unknown) in unknowns.iter().enumerate() {
            weights[terms.free(unknown.place, unknown.axis)] -= of_right[i];
            for speed in 0..p {
                let row = balance.row(terms, i, speed);
                weights[row] -= of_right[i] * pushed[speed];
                moved[speed] += of_right[i] * terms.value(row);
            }
        }
        for (j, unknown) in unknowns.iter().enumerate() {
            let of_column: Vec<f64> =
                of_accelerations.iter().zip(&moved).map(|(of, moved)| lambda[j] * (of - moved)).collect();
            let response = |axis: usize, speed: usize| terms.response(unknown.place, axis, speed);
            for (speed, of) in of_column.iter().enumerate() {
                weights[response(unknown.axis, speed)] += of;
            }
            let Some(slip) = unknown.slip else { continue };
            let of_friction = [0, 1].map(|axis| {
                let (f, mut sum) = (slip.friction()[axis], -lambda[j] * force(unknown.place, 1 + axis));
                for (speed, of) in of_column.iter().enumerate() {
                    weights[response(1 + axis, speed)] -= f * of;
                    sum -= of * terms.value(response(1 + axis, speed));
                }
                sum
            });
            let along = slip.along[0] * of_friction[0] + slip.along[1] * of_friction[1];
            self.by_friction[modes[unknown.place].contact] += along;
            if let Some(speed) = slip.speed {
                // The direction of slip changes with the perpendicular component of the change of slip.
                for axis in 0..2 {
                    let across = of_friction[axis] - along * slip.along[axis];
                    weights[terms.velocity(unknown.place, 1 + axis)] += slip.mu * across / speed;
                }
            }
        }
        Ok(())
    }

    /// The derivatives of the function that ended a part, times a factor.
    fn of_guard(&mut self, part: &SmoothPart, modes: &[Mode], factor: f64) -> Result<ByState, Reason> {
        let place = Place {
            time: part.end,
            state: &part.last,
            inputs: &part.inputs,
            row: self.field.row(part.start),
        };
        let index = |contact: usize| {
            modes.iter().position(|mode| mode.contact == contact).ok_or(Reason::ModesChanged)
        };
        let zero = vec![0.0; part.last.len()];
        let mut of_forces = vec![[0.0; 3]; modes.len()];
        match part.ended_by.as_ref().ok_or(Reason::ModesChanged)? {
            Guard::Gap(contact) => {
                let evaluated = self.evaluate(RoutineKey::Gap(*contact), &place).map_err(Reason::State)?;
                let mut by = ByState::none(self.field);
                self.transpose(&evaluated, &[factor], &mut by);
                Ok(by)
            }
            Guard::NormalForce(contact) => {
                let tape = self.mode_rates(modes, &place)?;
                of_forces[index(*contact)?][0] = factor;
                self.of_mode_rates(modes, &tape, &zero, &of_forces)
            }
            Guard::Friction(contact) => {
                let tape = self.mode_rates(modes, &place)?;
                let at = index(*contact)?;
                let [normal, first, second] = tape.forces(at);
                let mu = self.field.surface(*contact).ok_or(Reason::ModesChanged)?.mu;
                self.by_friction[*contact] += 2.0 * factor * mu * normal * normal;
                of_forces[at] = [mu * mu * normal, -first, -second].map(|of| 2.0 * factor * of);
                self.of_mode_rates(modes, &tape, &zero, &of_forces)
            }
            Guard::Slip(stopped) => {
                let [contact] = stopped[..] else { return Err(Reason::AtOnce) };
                let (tape, at) = (self.mode_rates(modes, &place)?, index(contact)?);
                let directions = Field::directions(modes, &tape.terms, &part.last[self.field.n..]);
                let along = directions[at].ok_or(Reason::ModesChanged)?;
                let mut weights = vec![0.0; tape.evaluated.values.len()];
                for (axis, along) in along.iter().enumerate() {
                    weights[tape.terms.velocity(at, 1 + axis)] = factor * along;
                }
                let mut by = ByState::none(self.field);
                self.transpose(&tape.evaluated, &weights, &mut by);
                Ok(by)
            }
            Guard::Jam => Err(Reason::Jam),
            _ => Err(Reason::ModesChanged),
        }
    }

    /// Takes the weights of the state after the events at the end of a part (n + p) to those of the state before. `of_time`
    /// is the weight of the time of the events.
    pub fn of_junction(
        &mut self,
        part: &SmoothPart,
        junction: &Junction,
        weights: &mut [f64],
        of_time: f64,
    ) -> Result<(), Reason> {
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let mut of_time = of_time - dot(weights, &junction.rates_after);
        for struck in junction.collisions.iter().rev() {
            let by = self.of_collision(part, struck, &weights[self.field.n..])?;
            weights.iter_mut().zip(&by.state).for_each(|(weight, by)| *weight += by);
            of_time += by.time;
        }
        if let Some(held) = &junction.held {
            of_time += self.of_held(part, held, weights)?;
        }
        of_time += dot(weights, &junction.rates_before);
        let by = self.of_guard(part, &junction.modes, -of_time / junction.guard_rate)?;
        weights.iter_mut().zip(&by.state).for_each(|(weight, by)| *weight += by);
        Ok(())
    }

    /// Takes the weights of the state of which contacts have taken what was left of their velocities to those of the state
    /// before; returns the weight of its time.
    fn of_held(&mut self, part: &SmoothPart, held: &Held, weights: &mut [f64]) -> Result<f64, Reason> {
        let n = self.field.n;
        let place = Place {
            time: part.end,
            state: &held.state,
            inputs: &part.inputs,
            row: self.field.row(part.start),
        };
        let contacts: Vec<usize> = held.modes.iter().map(|mode| mode.contact).collect();
        let tape = self.mode_rates(&held.modes, &place)?;
        let pushes =
            |column: &Vec<f64>| -> f64 { column.iter().zip(&weights[n..]).map(|(c, w)| c * w).sum() };
        let columns = &tape.balance.columns;
        let of_impulses = DVector::from_iterator(columns.len(), columns.iter().map(pushes));
        let of_velocity = solve_transposed(&tape.balance, &of_impulses).ok_or(Reason::ForcesNotUnique)?;
        let mut of_terms = vec![0.0; tape.evaluated.values.len()];
        for (unknown, of) in tape.balance.unknowns.iter().zip(&of_velocity) {
            of_terms[tape.terms.velocity(unknown.place, unknown.axis)] = -of;
        }
        let mut by = ByState::none(self.field);
        self.transpose(&tape.evaluated, &of_terms, &mut by);
        weights.iter_mut().zip(&by.state).for_each(|(weight, by)| *weight += by);
        let mut of_gaps = ByState::none(self.field);
        for (row, contact) in contacts.into_iter().take(held.openings.ncols()).enumerate() {
            let of: f64 = held.openings.column(row).iter().zip(&weights[..n]).map(|(o, w)| o * w).sum();
            let evaluated = self.evaluate(RoutineKey::Gap(contact), &place).map_err(Reason::State)?;
            self.transpose(&evaluated, &[-of], &mut of_gaps);
        }
        weights.iter_mut().zip(&of_gaps.state).for_each(|(weight, by)| *weight += by);
        Ok(by.time + of_gaps.time)
    }

    /// The derivatives of a weighted sum of the changes of the speeds in a collision.
    fn of_collision(
        &mut self,
        part: &SmoothPart,
        struck: &Struck,
        of_speeds: &[f64],
    ) -> Result<ByState, Reason> {
        let p = self.field.p;
        let place = Place {
            time: part.end,
            state: &struck.state,
            inputs: &part.inputs,
            row: self.field.row(part.start),
        };
        let key = RoutineKey::ContactTerms(vec![struck.contact]);
        let evaluated = self.evaluate(key, &place).map_err(Reason::State)?;
        let terms = ContactTerms::values(self.field, evaluated.values.clone(), 1).map_err(Reason::State)?;
        let mut weights = vec![0.0; evaluated.values.len()];
        let mut of_impulse = Vector3::zeros();
        for axis in 0..3 {
            for (speed, of) in of_speeds.iter().enumerate() {
                let response = terms.response(0, axis, speed);
                of_impulse[axis] += of * terms.value(response);
                weights[response] += of * struck.impulse[axis];
            }
        }
        let of_arguments = struck.impulse_by.transpose() * of_impulse;
        for axis in 0..3 {
            weights[terms.velocity(0, axis)] += of_arguments[axis];
        }
        for (entry, (row, column)) in ENTRIES.into_iter().enumerate() {
            for speed in 0..p {
                let (v, r) = (terms.partial(0, row, speed), terms.response(0, column, speed));
                weights[v] += of_arguments[3 + entry] * terms.value(r);
                weights[r] += of_arguments[3 + entry] * terms.value(v);
            }
        }
        self.by_friction[struck.contact] += of_arguments[9];
        self.by_restitution[struck.contact] += of_arguments[10];
        let mut by = ByState::none(self.field);
        self.transpose(&evaluated, &weights, &mut by);
        Ok(by)
    }
}

impl ModeTape {
    /// The forces of a closed contact along n, t, s, N.
    fn forces(&self, place: usize) -> [f64; 3] {
        let mut forces = [0.0; 3];
        let own = self.balance.unknowns.iter().zip(&self.balance.lambda).filter(|(of, _)| of.place == place);
        for (unknown, lambda) in own {
            forces[unknown.axis] = *lambda;
            for (axis, friction) in unknown.slip.iter().flat_map(Slip::friction).enumerate() {
                forces[1 + axis] = -friction * lambda;
            }
        }
        forces
    }
}

/// The solution x of A^T x = b, for the matrix of a balance.
fn solve_transposed(balance: &Balance, right: &DVector<f64>) -> Option<DVector<f64>> {
    balance.matrix.transpose().full_piv_lu().solve(right)
}
