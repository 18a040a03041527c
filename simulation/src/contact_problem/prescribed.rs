//! Forces of contacts whose modes are known.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use nalgebra::{DVector, Vector3};
use smallvec::SmallVec;

use super::{
    Mode, Problem, Unsolved,
    centre::{By, centre},
    cone::{Cone, least_reserve},
    jam_distance::{block, distance},
    linear::{Elimination, FEW, SINGULAR, Square, Vector, residual, vector},
    problem::three,
};

/// Forces under which contacts keep their modes, as far as possible.
#[derive(Clone, Debug)]
pub struct Admissible {
    /// lambda, n, t, s of each contact. If several forces give the same motion, the analytic centre of those
    /// that the laws allow; if the laws allow none, those with the least violation.
    pub force: DVector<f64>,
    /// W lambda + beta
    pub acceleration: DVector<f64>,
    /// By how much all normal forces could decrease before friction is exhausted, relative to the size of all
    /// forces: the least lambda_n - abs(lambda_tan) / mu over the contacts, each in units of its own mass. It
    /// is positive exactly if there are forces inside all cones, and negative if there are none.
    pub margin: f64,
    /// The contact with the least reserve.
    pub least: Option<usize>,
    /// Whether the forces are the only ones with this motion.
    pub unique: bool,
    /// The distance of the sliding contacts from a jam: the determinant of the matrix of their normal accelerations by
    /// normal forces while all others keep their modes, divided by the same without friction. It vanishes where forces
    /// grow without bound, and there only. Of one contact it is the derivative of a_n with respect to lambda_n, divided
    /// by W_nn. 1 without sliding contacts; the least one of contacts that do not depend on one another.
    pub f: f64,
}

/// Why contacts cannot keep their modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Impossible {
    /// The problem is invalid.
    Problem(Unsolved),
    /// No forces, even without the bounds of friction, cancel this acceleration of a contact.
    NoForces {
        /// The contact.
        contact: usize,
        /// The remaining acceleration, relative to its terms.
        left: f64,
    },
}

/// Accelerations that forces should cancel may remain up to this part of their terms; this allows for a pivot
/// that counted as zero and should not have.
const INCONSISTENT: f64 = 1e-6;

/// The forces of contacts in these modes.
///
/// # Errors
/// See [`Impossible`].
pub fn with_modes(problem: &Problem<'_>, modes: &[Mode]) -> Result<Admissible, Impossible> {
    with_modes_near(problem, modes, None)
}

/// Like [`with_modes`], but starting from approximate forces, which only saves work.
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

/// The choice among many forces for one motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// The analytic centre.
    Centre,
    /// The analytic centre if these modes are admissible, else any.
    Decision,
    /// Any forces if all give the same motion, that is, if no contact slips.
    Motion,
    /// The same for accelerations in many directions of slip: of the distance from a jam only the sign is told where forces
    /// are unique, as 1 or -1.
    Acceleration,
    /// Any forces of these modes.
    Any,
}

/// Like [`with_modes_near`], with a choice of forces.
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

/// The same for a problem that has been checked.
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
    let unique = elimination.rank == m;
    if !x.iter().all(|x| x.is_finite()) {
        return Err(Impossible::NoForces { contact: 0, left: f64::INFINITY });
    }
    // Equations that are as many as the rank are solved to rounding.
    if !unique {
        unknowns.consistent(problem, &matrix, &x, &residual(&matrix, &x, &right))?;
    }
    let slides = modes.iter().any(|mode| matches!(mode, Mode::Slide(_)));
    let any = match wanted {
        Wanted::Any => true,
        Wanted::Motion | Wanted::Acceleration => unique || !slides,
        Wanted::Centre | Wanted::Decision => false,
    };
    if any {
        let (force, acceleration) = unknowns.motion(problem, &x);
        let f = match wanted {
            Wanted::Acceleration if unique => elimination.sign(),
            _ => unknowns.distance_from_jam(problem, &matrix, &elimination),
        };
        return Ok(Admissible { force, acceleration, margin: 0.0, least: None, unique, f });
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
    let f = unknowns.distance_from_jam(problem, &matrix, &elimination);
    let least = least.map(|cone| unknowns.list[cones[cone].normal].contact);
    Ok(Admissible { force, acceleration, margin, least, unique, f })
}

/// Whether all contacts without slip can stick while those that slip continue to slip, and the forces of this
/// motion.
pub fn rest(problem: &Problem<'_>) -> Option<Admissible> {
    let modes: Vec<Mode> = problem.slip.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
    let found = prescribed(problem, &modes, None, Wanted::Decision).ok()?;
    (found.margin >= -FITS && parts(problem, &modes) && held(problem, &modes, &found.acceleration))
        .then_some(found)
}

/// An acceleration along a plane without friction below this share of the greatest free one is a rounding error.
pub(crate) const UNHELD: f64 = 1e-9;

/// A margin is satisfied if it is at least minus this.
pub(super) const FITS: f64 = 1e-13;

/// Whether contacts do not begin to slip: those without friction, which nothing prevents from it, and those whose slip
/// only forces beyond all bounds could prevent exactly, because they can hardly move relative to each other.
fn held(problem: &Problem<'_>, modes: &[Mode], acceleration: &DVector<f64>) -> bool {
    let size = acceleration_scale(problem);
    // The same as ends the mode later: else it would end and begin again.
    let unheld = UNHELD * problem.beta.amax();
    modes.iter().enumerate().all(|(i, mode)| {
        let a = three(acceleration, i);
        let least = if problem.mu[i] > 0.0 { INCONSISTENT * size[i] } else { unheld };
        !matches!(mode, Mode::Stick) || hypot(a.y, a.z) <= least + problem.noise(3 * i + 1)
    })
}

/// The size of the terms of the acceleration of each contact without forces.
fn acceleration_scale(problem: &Problem<'_>) -> Vec<f64> {
    let scaled: f64 =
        (0..problem.contacts()).map(|i| three(problem.beta, i).norm() * problem.scale(i)).fold(0.0, f64::max);
    (0..problem.contacts()).map(|i| scaled / problem.scale(i)).collect()
}

/// An unknown: a normal force with its friction, or a component of friction.
struct Unknown {
    contact: usize,
    axis: usize,
    /// The force of a unit of the unknown.
    along: Vector3<f64>,
    scale: f64,
}

impl Unknown {
    /// Whether it is a normal force with friction against slip.
    fn slides(&self) -> bool {
        self.axis == 0 && (self.along.y != 0.0 || self.along.z != 0.0)
    }
}

struct Unknowns {
    list: SmallVec<[Unknown; FEW]>,
}

impl Unknowns {
    fn new(problem: &Problem<'_>, modes: &[Mode]) -> Self {
        let mut list = SmallVec::with_capacity(3 * modes.len());
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
        let (m, n) = (self.list.len(), problem.w.nrows());
        let w = problem.w.as_slice();
        let column_of = |from: &Unknown, axis: usize| &w[n * (3 * from.contact + axis)..][..n];
        let mut matrix = Square::zeros(m * m);
        for (from, column) in self.list.iter().zip(matrix.chunks_exact_mut(m.max(1))) {
            let own = column_of(from, from.axis);
            for (value, to) in column.iter_mut().zip(&self.list) {
                *value = own[3 * to.contact + to.axis];
            }
            for (axis, share) in [(1, from.along.y), (2, from.along.z)] {
                if from.axis == 0 && share != 0.0 {
                    let across = column_of(from, axis);
                    for (value, to) in column.iter_mut().zip(&self.list) {
                        *value += share * across[3 * to.contact + to.axis];
                    }
                }
            }
            for (value, to) in column.iter_mut().zip(&self.list) {
                *value *= to.scale * from.scale;
            }
        }
        matrix
    }

    /// The unknowns of given forces.
    fn of(&self, force: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.list.len(), |a, _| force[self.row(a)] / self.list[a].scale)
    }

    /// The forces and the accelerations that they cause.
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
            acceleration.as_mut_slice().iter_mut().zip(column).for_each(|(a, w)| *a += w * force);
        }
        (force, acceleration)
    }

    fn cones(&self, problem: &Problem<'_>) -> SmallVec<[Cone; FEW]> {
        let mut cones = SmallVec::new();
        for (place, unknown) in self.list.iter().enumerate() {
            if unknown.axis == 0 {
                let sticks = self.list.get(place + 1).is_some_and(|next| next.axis == 1);
                let tangential = sticks.then(|| (place + 1, place + 2, 1.0 / problem.mu[unknown.contact]));
                cones.push(Cone { normal: place, tangential });
            }
        }
        cones
    }

    /// Whether the equations beyond the rank are satisfied.
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
        match worst {
            None => Ok(()),
            Some((left, a)) => Err(Impossible::NoForces { contact: self.list[a].contact, left }),
        }
    }

    /// The matrix without friction where contacts slide: symmetric, and positive definite but for unknowns that depend on
    /// others.
    fn smooth(&self, problem: &Problem<'_>, matrix: &Square) -> Square {
        let mut smooth = matrix.clone();
        let columns = smooth.chunks_exact_mut(self.list.len().max(1));
        for (column, from) in columns.zip(&self.list).filter(|(_, from)| from.slides()) {
            let own = 3 * from.contact;
            for (value, to) in column.iter_mut().zip(&self.list) {
                *value = problem.w[(3 * to.contact + to.axis, own)] * (to.scale * from.scale);
            }
        }
        smooth
    }

    /// The unknowns that move something: in a mechanism that moves in a plane friction across it does not.
    fn effective(&self, smooth: &Square) -> SmallVec<[usize; FEW]> {
        let m = self.list.len();
        let own = |a: usize| smooth[a * m + a];
        let most = (0..m).map(own).fold(0.0, f64::max);
        (0..m).filter(|&a| own(a) > SINGULAR * most).collect()
    }

    /// See [`Admissible::f`].
    fn distance_from_jam(&self, problem: &Problem<'_>, matrix: &Square, elimination: &Elimination) -> f64 {
        let m = self.list.len();
        if !self.list.iter().any(Unknown::slides) {
            return 1.0;
        }
        let smooth = self.smooth(problem, matrix);
        let found = if elimination.rank == m {
            distance(matrix, elimination, smooth, m)
        } else {
            let part = self.effective(&smooth);
            let own = block(matrix, m, &part);
            let elimination = Elimination::new(own.clone(), part.len(), 0.0);
            let whole = elimination.rank == part.len();
            whole.then(|| distance(&own, &elimination, block(&smooth, m, &part), part.len())).flatten()
        };
        if let Some(distance) = found {
            return distance;
        }
        let own = |a: usize| {
            let (row, along) = (self.row(a), self.list[a].along);
            let [t, s] = [1, 2].map(|axis| problem.w[(row, row + axis)]);
            1.0 + (along.y * t + along.z * s) / problem.w[(row, row)]
        };
        (0..m).filter(|&a| self.list[a].slides()).map(own).fold(f64::INFINITY, f64::min)
    }
}

/// For each sliding contact its normal force by its own normal acceleration while all others keep their modes, (M^-1)_ii, times
/// its W_nn. Where forces are not unique, that of the contact by itself.
fn own_growths(problem: &Problem<'_>, modes: &[Mode]) -> SmallVec<[(usize, f64); FEW]> {
    let unknowns = Unknowns::new(problem, modes);
    let m = unknowns.list.len();
    let matrix = unknowns.matrix(problem);
    let elimination = Elimination::new(matrix.clone(), m, SINGULAR);
    let (part, elimination) = if elimination.rank == m {
        ((0..m).collect(), elimination)
    } else {
        let part = unknowns.effective(&unknowns.smooth(problem, &matrix));
        let elimination = Elimination::new(block(&matrix, m, &part), part.len(), SINGULAR);
        (part, elimination)
    };
    let part: SmallVec<[usize; FEW]> = if elimination.rank == part.len() { part } else { SmallVec::new() };
    let growth = |(a, unknown): (usize, &Unknown)| {
        let row = unknowns.row(a);
        let own = problem.w[(row, row)] * unknown.scale.powi(2);
        let growth = match part.iter().position(|&b| b == a) {
            Some(place) => {
                let mut unit = Vector::zeros(part.len());
                unit[place] = 1.0;
                elimination.solve(&unit)[place]
            }
            None => 1.0 / matrix[a * m + a],
        };
        (unknown.contact, own * growth)
    };
    unknowns.list.iter().enumerate().filter(|(_, unknown)| unknown.slides()).map(growth).collect()
}

/// Whether more force at any sliding contact drives it apart while all others keep their modes.
pub(super) fn parts(problem: &Problem<'_>, modes: &[Mode]) -> bool {
    own_growths(problem, modes).iter().all(|(_, growth)| *growth > 0.0)
}

/// The sliding contact whose own force grows most towards a jam.
pub(crate) fn nearest_to_jam(problem: &Problem<'_>, modes: &[Mode]) -> Option<usize> {
    let growths = own_growths(problem, modes);
    growths
        .iter()
        .max_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))
        .map(|(contact, _)| *contact)
}
