//! The paper's own two solutions, for comparison: integration of (55) and recursive summation (56), alone or with (57)-(62).
//!
//! [`crate::solve()`] is exact and takes less; these show what it is compared with. Their results have the same type.

use nalgebra::{Vector2, Vector3};

use crate::{
    Impact, ImpactError, Law, ReducedMatrix, Scalar, Surface,
    scalar::constant,
    solve::{Contact, Ledger, Slide, State, check, collide, contact},
};

/// How the sliding arc is followed. After it the arcs are linear in I_n, and all methods end with (57)-(62).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method<T> {
    /// Integration of (55) by the classical Runge-Kutta method. Sliding gives way to sticking or renewal (lambda = -1 or 1) when s falls
    /// below `epsilon_s` times the slip at the start.
    Integrate {
        /// Steps to the impulse -v_n1 / m_nn.
        steps: u32,
        /// The paper's epsilon_s, as a part of the slip at the start.
        epsilon_s: T,
    },
    /// Recursive summation (56) with `k` steps to the impulse 1 N s. On the linear arcs a sum is exact, so that they are taken in one step
    /// and the result is that of [`Method::PartialSum`].
    Sum {
        /// The paper's refinement factor.
        k: u32,
    },
    /// Recursive summation of the sliding arc, then (57)-(62): the paper's i/rs (6.2).
    PartialSum {
        /// The paper's refinement factor.
        k: u32,
    },
}

/// Steps after which a method gives up.
const STEPS: u32 = 10_000_000;

/// Solves a collision by one of the paper's methods.
///
/// # Errors
/// As [`crate::solve()`]; a method that finds no end within ten million steps reports [`ImpactError::Wedged`].
pub fn solve_by<T: Scalar>(
    method: Method<T>,
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    check(matrix, approach, surface)?;
    // Impulses are in units of -v_n1 / m_nn inside.
    let unit = -matrix.nn / approach.x;
    let per = |n: u32| T::one() / constant(f64::from(n.max(1)));
    let (step, floor, smooth) = match method {
        Method::Integrate { steps, epsilon_s } => (per(steps), epsilon_s, true),
        Method::Sum { k } | Method::PartialSum { k } => (per(k) * unit, T::zero(), false),
    };
    collide(matrix, approach, surface, |c, slip, speed, ledger| {
        follow(c, slip, step, floor * speed, smooth, ledger)
    })
}

/// The bound on a step of impulse (N s) that keeps the summation (56) stable at a direction and a speed of slip (6.1): the condition is
/// |1 + lambda D| <= 1 for both eigenvalues of (34) linearised, here their common bound 2 s / |h'| as s tends to zero.
///
/// `None` where h' >= 0: there the hodograph itself is unstable.
pub fn stability_bound<T: Scalar>(matrix: &ReducedMatrix<T>, mu: T, phi: T, slip: T) -> Option<T> {
    let c = contact(matrix, mu);
    let (sin, cos) = phi.sin_cos();
    let (d, across) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
    // h' = -g - mu d' . T d'
    let bend = c.b.dot(&across) - c.slip_rate(&across).dot(&across);
    let slope = -(c.slip_rate(&d).dot(&d)) - bend;
    (slope < T::zero()).then(|| -(slip + slip) / (slope * matrix.nn))
}

/// A point of the sliding arc: slip, and what has accumulated.
type Point<T> = (Vector2<T>, State<T>);

/// Follows the sliding arc in steps of I_n.
fn follow<T: Scalar>(
    c: &Contact<T>,
    slip: Vector2<T>,
    step: T,
    floor: T,
    smooth: bool,
    ledger: &mut Ledger<T>,
) -> Slide<T> {
    let mut at: Point<T> = (slip, State::approach());
    let advance =
        |at: &Point<T>, length: T| if smooth { runge_kutta(c, at, length) } else { euler(c, at, length) };
    for _ in 0..STEPS {
        let mut length = step;
        let mut next = advance(&at, length);
        let turned = next.0.dot(&at.0) <= T::zero();
        let stops = turned || next.0.norm() <= floor;
        if turned {
            // Stop where the slip passes closest to zero.
            let change = at.0 - next.0;
            length = step * at.0.dot(&change) / change.norm_squared();
            next = euler(c, &at, length);
        }
        // Compression may end on the step, and then the law.
        let mut from = T::zero();
        let mut begin = at.1;
        if begin.velocity < T::zero() && next.1.velocity >= T::zero() {
            from = zero_of(&advance, &at, length, |s| s.velocity);
            begin = advance(&at, from).1;
            if ledger.compressed(begin.normal, begin.work) {
                return end(advance(&at, from));
            }
        }
        let target = ledger.target;
        let reached = ledger.watched(&next.1) >= target && ledger.watched(&begin) < target;
        if next.1.velocity >= T::zero()
            && (reached && (ledger.law() == Law::Newton || begin.velocity >= T::zero() || from > T::zero()))
        {
            let law = *ledger;
            let at_end = zero_of(&advance, &at, length, |s| law.watched(s) - target);
            return end(advance(&at, at_end));
        }
        if stops {
            return Slide::Stopped(next.1);
        }
        at = next;
    }
    Slide::Endless(at.1)
}

fn end<T: Scalar>((slip, state): Point<T>) -> Slide<T> {
    Slide::Ended(state, slip)
}

/// The length of step at which a quantity, negative at zero and not at `length`, vanishes: by bisection and false position in turn.
fn zero_of<T: Scalar>(
    advance: &impl Fn(&Point<T>, T) -> Point<T>,
    at: &Point<T>,
    length: T,
    quantity: impl Fn(&State<T>) -> T,
) -> T {
    let (mut lo, mut hi) = (T::zero(), length);
    let (mut below, mut above) = (quantity(&at.1), quantity(&advance(at, length).1));
    for round in 0..100 {
        let falsi = lo - below * (hi - lo) / (above - below);
        let middle =
            if round % 3 == 2 || !(falsi > lo && falsi < hi) { (lo + hi) * constant(0.5) } else { falsi };
        let value = quantity(&advance(at, middle).1);
        if value < T::zero() {
            (lo, below) = (middle, value);
        } else {
            (hi, above) = (middle, value);
        }
        if hi - lo <= T::default_epsilon() * length {
            break;
        }
    }
    hi
}

/// d/dI_n of slip, I_t, I_s, v_n and the normal work: (34), (35b).
fn rates<T: Scalar>(c: &Contact<T>, (slip, state): &Point<T>) -> Point<T> {
    let d = slip / slip.norm();
    let rates =
        State { normal: T::one(), tangential: -d * c.mu, velocity: c.normal_rate(&d), work: state.velocity };
    (c.slip_rate(&d), rates)
}

fn along<T: Scalar>((slip, state): &Point<T>, (dslip, ds): &Point<T>, length: T) -> Point<T> {
    let state = State {
        normal: state.normal + ds.normal * length,
        tangential: state.tangential + ds.tangential * length,
        velocity: state.velocity + ds.velocity * length,
        work: state.work + ds.work * length,
    };
    (slip + dslip * length, state)
}

fn euler<T: Scalar>(c: &Contact<T>, at: &Point<T>, length: T) -> Point<T> {
    along(at, &rates(c, at), length)
}

fn runge_kutta<T: Scalar>(c: &Contact<T>, at: &Point<T>, length: T) -> Point<T> {
    let half = length * constant(0.5);
    let k1 = rates(c, at);
    let k2 = rates(c, &along(at, &k1, half));
    let k3 = rates(c, &along(at, &k2, half));
    let k4 = rates(c, &along(at, &k3, length));
    let sixth = length / constant(6.0);
    let third = sixth + sixth;
    along(&along(&along(&along(at, &k1, sixth), &k2, third), &k3, third), &k4, sixth)
}
