//! Forces of contacts whose modes are known.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DVector, Vector3};

use super::{
    Mode, Problem, Unsolved,
    centre::{By, centre},
    cone::{Cone, least_reserve},
    linear::{Elimination, Square, Vector, residual, vector},
    problem::three,
};

/// Forces under which contacts keep their modes, as far as these can be kept.
#[derive(Clone, Debug)]
pub struct Admissible {
    /// lambda, n, t, s of each contact. Where several forces give the same motion, the analytic centre of those
    /// that the laws allow; where the laws allow none, the ones that miss them least.
    pub force: DVector<f64>,
    /// W lambda + beta
    pub acceleration: DVector<f64>,
    /// By how much all normal forces could be less with enough friction left, beside the size of all forces:
    /// the least lambda_n - abs(lambda_tan) / mu over the contacts, each in units of its own mass. It is positive
    /// exactly if forces within all cones exist, and negative if none exist.
    pub margin: f64,
    /// The contact with the least reserve.
    pub least: Option<usize>,
    /// Whether no other forces give this motion.
    pub unique: bool,
    /// The least f over sliding contacts: the rate of a_n by lambda_n of one contact while all others keep their
    /// modes, over its W_nn. At zero the contact jams. 1 without sliding contacts.
    pub f: f64,
    /// The contact with that f.
    pub jams: Option<usize>,
}

/// Why contacts cannot keep their modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Impossible {
    /// The problem is not one.
    Problem(Unsolved),
    /// No forces, whatever friction allows, cancel this acceleration of a contact.
    NoForces {
        /// The contact.
        contact: usize,
        /// What is left, over its terms.
        left: f64,
    },
}

/// Pivots up to this times the first one count as zero, in units in which each contact has W_ii of trace one.
pub(super) const SINGULAR: f64 = 1e-9;

/// Accelerations that forces should cancel may be left in this ratio to their terms: that of a pivot which counted
/// as zero and should not.
const INCONSISTENT: f64 = 1e-6;

/// The forces of contacts in these modes.
///
/// # Errors
/// See [`Impossible`].
pub fn with_modes(problem: &Problem<'_>, modes: &[Mode]) -> Result<Admissible, Impossible> {
    with_modes_near(problem, modes, None)
}

/// As [`with_modes`], from forces that are nearly the answer, which only save work.
///
/// # Errors
/// See [`Impossible`].
pub fn with_modes_near(
    problem: &Problem<'_>,
    modes: &[Mode],
    guess: Option<&DVector<f64>>,
) -> Result<Admissible, Impossible> {
    prescribed(problem, modes, guess, Wanted::Centre)
}

/// Which of many forces for one motion are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Those in the middle.
    Centre,
    /// Those in the middle if these modes fit, else any.
    Decision,
    /// Any, where all of them move the contacts and the mechanism alike: where nothing slips.
    Motion,
}

/// As [`with_modes_near`], for the forces that are wanted.
pub(super) fn prescribed(
    problem: &Problem<'_>,
    modes: &[Mode],
    guess: Option<&DVector<f64>>,
    wanted: Wanted,
) -> Result<Admissible, Impossible> {
    let k = problem.contacts();
    if modes.len() != k || guess.is_some_and(|guess| guess.len() != 3 * k) {
        return Err(Impossible::Problem(Unsolved::Lengths));
    }
    problem.check().map_err(Impossible::Problem)?;
    found(problem, modes, guess, wanted)
}

/// The same of a problem that is known to be one.
pub(crate) fn found(
    problem: &Problem<'_>,
    modes: &[Mode],
    guess: Option<&DVector<f64>>,
    wanted: Wanted,
) -> Result<Admissible, Impossible> {
    let unknowns = Unknowns::new(problem, modes);
    let m = unknowns.list.len();
    let matrix = unknowns.matrix(problem);
    let right = vector(m, |a| -problem.pull(unknowns.row(a)) / unknowns.rate(a));
    let elimination = Elimination::new(matrix.clone(), m, SINGULAR);
    let mut x = elimination.solve(&right);
    // One refinement.
    let more = elimination.solve(&residual(&matrix, &x, &right));
    x.iter_mut().zip(more.iter()).for_each(|(x, more)| *x += more);
    let left = residual(&matrix, &x, &right);
    unknowns.consistent(problem, &matrix, &x, &left)?;
    let unique = elimination.rank == m;
    let slides = modes.iter().any(|mode| matches!(mode, Mode::Slide(_)));
    if wanted == Wanted::Motion && (unique || !slides) {
        let (force, acceleration) = unknowns.motion(problem, &x);
        let (f, jams) = unknowns.jam(problem, &elimination);
        return Ok(Admissible { force, acceleration, margin: 0.0, least: None, unique, f, jams });
    }
    let mut x = DVector::from_column_slice(&x);
    let cones = unknowns.cones(problem);
    let mut load = x.norm();
    let mut margin;
    if !unique {
        let basis = elimination.null_space();
        let least = &x - &basis * basis.tr_mul(&x);
        load = least.norm();
        if load > 0.0 {
            let start = guess.map(|guess| unknowns.of(guess));
            let by = if problem.shares_normal_forces() { By::Squares } else { By::Hessian };
            x = centre(&cones, &least, &basis, load, start.as_ref(), (wanted == Wanted::Decision, by)).0;
        } else {
            x = least;
        }
    }
    margin = least_reserve(&cones, &x) / if load > 0.0 { load } else { 1.0 };
    if cones.is_empty() {
        margin = 1.0;
    }
    let least = (0..cones.len()).min_by(|&a, &b| cones[a].reserve(&x).total_cmp(&cones[b].reserve(&x)));
    let (force, acceleration) = unknowns.motion(problem, x.as_slice());
    let (f, jams) = unknowns.jam(problem, &elimination);
    let least = least.map(|cone| unknowns.list[cones[cone].normal].contact);
    Ok(Admissible { force, acceleration, margin, least, unique, f, jams })
}

/// Whether all contacts that do not slip may go on sticking while those that slip go on slipping, and the forces
/// with which they do.
pub fn rest(problem: &Problem<'_>) -> Option<Admissible> {
    let modes: Vec<Mode> = problem.slip.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
    let found = prescribed(problem, &modes, None, Wanted::Decision).ok()?;
    (found.margin >= -FITS && found.f > 0.0 && held(problem, &modes, &found.acceleration)).then_some(found)
}

/// A margin fits from minus this on.
pub(super) const FITS: f64 = 1e-13;

/// Whether the contacts without friction, which nothing holds, do not begin to slip.
fn held(problem: &Problem<'_>, modes: &[Mode], acceleration: &DVector<f64>) -> bool {
    let size = acceleration_scale(problem);
    modes.iter().enumerate().all(|(i, mode)| {
        let a = three(acceleration, i);
        !matches!(mode, Mode::Stick) || a.y.hypot(a.z) <= 1e-9 * size[i] + problem.noise(3 * i + 1)
    })
}

/// The size of the terms of the acceleration of each contact without forces.
fn acceleration_scale(problem: &Problem<'_>) -> Vec<f64> {
    let scaled: f64 =
        (0..problem.contacts()).map(|i| three(problem.beta, i).norm() * problem.scale(i)).fold(0.0, f64::max);
    (0..problem.contacts()).map(|i| scaled / problem.scale(i)).collect()
}

/// One unknown: a normal force with its friction, or a component of friction.
struct Unknown {
    contact: usize,
    axis: usize,
    /// The force that it stands for.
    along: Vector3<f64>,
    scale: f64,
}

struct Unknowns {
    list: Vec<Unknown>,
}

impl Unknowns {
    fn new(problem: &Problem<'_>, modes: &[Mode]) -> Self {
        let mut list = Vec::with_capacity(3 * modes.len());
        for (contact, mode) in modes.iter().enumerate() {
            let (mu, scale) = (problem.mu[contact], problem.scale(contact));
            let mut add =
                |axis: usize, along: Vector3<f64>| list.push(Unknown { contact, axis, along, scale });
            match mode {
                Mode::Separate => {}
                Mode::Slide(d) => add(0, Vector3::new(1.0, -mu * d.x, -mu * d.y)),
                Mode::Stick => {
                    add(0, Vector3::x());
                    if mu > 0.0 {
                        add(1, Vector3::y());
                        add(2, Vector3::z());
                    }
                }
            }
        }
        Self { list }
    }

    fn row(&self, a: usize) -> usize {
        3 * self.list[a].contact + self.list[a].axis
    }

    /// The unit of the equation: a = v / s.
    fn rate(&self, a: usize) -> f64 {
        1.0 / self.list[a].scale
    }

    fn matrix(&self, problem: &Problem<'_>) -> Square {
        let m = self.list.len();
        let entry = |a: usize, b: usize| {
            let (row, from) = (self.row(a), &self.list[b]);
            let factor = self.list[a].scale * from.scale;
            let w = |axis: usize| problem.w[(row, 3 * from.contact + axis)];
            if from.axis > 0 {
                return factor * w(from.axis);
            }
            let mut sum = w(0);
            if from.along.y != 0.0 {
                sum += from.along.y * w(1);
            }
            if from.along.z != 0.0 {
                sum += from.along.z * w(2);
            }
            factor * sum
        };
        let mut matrix = Square::zeros(m * m);
        for (b, column) in matrix.chunks_exact_mut(m.max(1)).enumerate() {
            column.iter_mut().enumerate().for_each(|(a, value)| *value = entry(a, b));
        }
        matrix
    }

    /// The unknowns of given forces.
    fn of(&self, force: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.list.len(), |a, _| force[self.row(a)] / self.list[a].scale)
    }

    /// The forces, and the accelerations that they cause.
    fn motion(&self, problem: &Problem<'_>, x: &[f64]) -> (DVector<f64>, DVector<f64>) {
        let mut force = DVector::zeros(3 * problem.contacts());
        for (unknown, x) in self.list.iter().zip(x.iter()) {
            let part = unknown.along * (unknown.scale * x);
            for axis in 0..3 {
                force[3 * unknown.contact + axis] += part[axis];
            }
        }
        let mut acceleration = problem.beta.clone();
        for (column, force) in problem.w.as_slice().chunks_exact(force.len().max(1)).zip(force.iter()) {
            acceleration.iter_mut().zip(column).for_each(|(a, w)| *a += w * force);
        }
        (force, acceleration)
    }

    fn cones(&self, problem: &Problem<'_>) -> Vec<Cone> {
        let mut cones = Vec::with_capacity(self.list.len());
        for (place, unknown) in self.list.iter().enumerate() {
            if unknown.axis == 0 {
                let sticks = self.list.get(place + 1).is_some_and(|next| next.axis == 1);
                let tangential = sticks.then(|| (place + 1, place + 2, 1.0 / problem.mu[unknown.contact]));
                cones.push(Cone { normal: place, tangential });
            }
        }
        cones
    }

    /// Whether the equations beyond the rank hold.
    fn consistent(
        &self,
        problem: &Problem<'_>,
        matrix: &Square,
        x: &Vector,
        left: &Vector,
    ) -> Result<(), Impossible> {
        let m = left.len();
        let size = x.iter().fold(0.0_f64, |size, x| size.max(x.abs()))
            + (0..left.len()).map(|a| problem.beta[self.row(a)].abs() / self.rate(a)).fold(0.0, f64::max);
        let mut worst: Option<(f64, usize)> = None;
        for a in 0..left.len() {
            let terms: f64 =
                size.max(matrix.iter().skip(a).step_by(m).zip(x.iter()).map(|(w, x)| (w * x).abs()).sum());
            let noise = problem.noise(self.row(a)) / self.rate(a);
            let lack = (left[a].abs() - noise) / terms;
            if lack > INCONSISTENT && worst.is_none_or(|(most, _)| lack > most) {
                worst = Some((lack, a));
            }
        }
        let finite = x.iter().all(|x| x.is_finite());
        match worst {
            None if finite => Ok(()),
            None => Err(Impossible::NoForces { contact: 0, left: f64::INFINITY }),
            Some((left, a)) => Err(Impossible::NoForces { contact: self.list[a].contact, left }),
        }
    }

    /// See [`Admissible::f`].
    fn jam(&self, problem: &Problem<'_>, elimination: &Elimination) -> (f64, Option<usize>) {
        let (m, mut least) = (self.list.len(), (1.0, None));
        for (a, unknown) in self.list.iter().enumerate() {
            let slides = unknown.axis == 0 && (unknown.along.y != 0.0 || unknown.along.z != 0.0);
            if !slides {
                continue;
            }
            let row = 3 * unknown.contact;
            let own = problem.w[(row, row)];
            let f = if elimination.rank == m {
                let mut unit = Vector::zeros(m);
                unit[a] = 1.0;
                unknown.scale.powi(-2) / elimination.solve(&unit)[a] / own
            } else {
                let [t, s] = [1, 2].map(|axis| problem.w[(row, row + axis)]);
                1.0 + (unknown.along.y * t + unknown.along.z * s) / own
            };
            if least.1.is_none() || f < least.0 {
                least = (f, Some(unknown.contact));
            }
        }
        least
    }
}
