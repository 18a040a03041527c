//! The exact solver: sliding arc, then terminal arc, in units where m_nn = 1 and v_n1 = -1.

mod arc;
mod bend;
mod chart;
mod ledger;
mod regular;
mod root;
mod series;
mod sliding;
mod terminal;

use nalgebra::{Vector2, Vector3};

pub(crate) use self::{
    ledger::{Ledger, Line, State},
    sliding::{Slide, slide, straight},
    terminal::Contact,
};
use crate::{
    Impact, ImpactError, Path, ReducedMatrix, Surface,
    scalar::{Real, constant, length},
};

/// Solves one collision: reduced matrix and velocity of approach (n, t, s) in, impulse and velocity of separation out.
///
/// t and s are any orthonormal pair in the contact plane. No slip at the start, straight hodographs, singular matrices and
/// repeated compression are all ordinary input.
///
/// # Errors
/// Every reason is a variant of [`ImpactError`]; a result is never NaN.
#[inline]
pub fn solve<T: crate::Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    solve_real(matrix, approach, surface)
}

/// The same for everything that the solver can calculate with.
#[inline]
pub(crate) fn solve_real<T: Real>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    check(matrix, approach, surface)?;
    collide(matrix, approach, surface, slide)
}

/// Solves a collision with any way of following the sliding arc.
#[inline(always)]
pub(crate) fn collide<T: Real>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
    slide: impl FnOnce(&Contact<T>, Vector2<T>, T, &mut Ledger<T>) -> Slide<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let unit = T::one() / matrix.nn;
    let speed = -approach.x;
    let contact = contact(matrix, surface.mu);
    let tangential = Vector2::new(approach.y, approach.z) / speed;
    let slip = length(&tangential);
    let mut ledger = Ledger::new(surface.law, surface.e);
    let eps = T::default_epsilon();
    let slips = slip > eps * eps * eps * eps;
    let mut state = State::approach();
    let mut ended = None;
    let mut endless = false;
    if slips {
        match slide(&contact, tangential, slip, &mut ledger) {
            Slide::Ended(end, velocity) => ended = Some((end, velocity, Path::Sliding)),
            Slide::Stopped(stopped) => state = stopped,
            Slide::Endless(stopped) => (state, endless) = (stopped, true),
        }
    }
    if ended.is_none() && !endless {
        ended = after_slip(&contact, &mut state, slips, &mut ledger);
    }
    let Some((end, velocity, path)) = ended else {
        return Err(ImpactError::Wedged { normal_velocity: state.velocity * speed, law: surface.law });
    };
    let scale = speed * unit;
    let impulse = Vector3::new(end.normal, end.tangential.x, end.tangential.y) * scale;
    let separation = Vector3::new(end.velocity, velocity.x, velocity.y) * speed;
    let normal_work = end.work * scale * speed;
    for value in [impulse.x, impulse.y, impulse.z, separation.x, separation.y, separation.z, normal_work] {
        if !value.is_finite() {
            return Err(ImpactError::NotFinite { value });
        }
    }
    Ok(Impact {
        impulse,
        velocity: separation,
        contact_work: impulse.dot(&(separation + approach)) * constant(0.5),
        normal_work,
        path,
        compressions: ledger.compressions,
    })
}

/// The arc after slip has stopped; nothing if the law never ends it.
#[inline]
fn after_slip<T: Real>(
    contact: &Contact<T>,
    state: &mut State<T>,
    slips: bool,
    ledger: &mut Ledger<T>,
) -> Option<(State<T>, Vector2<T>, Path)> {
    let eps = T::default_epsilon();
    // Where slip and normal velocity stop together, rounding must not tell them apart.
    let scale = T::one() + state.normal * (T::one() + contact.mu * length(&contact.b));
    if slips && state.velocity.abs() <= constant::<T>(256.0) * eps * scale {
        state.velocity = T::zero();
        if ledger.compressions == 0 && ledger.compressed(state.normal, state.work) {
            return Some((*state, Vector2::zeros(), Path::Sliding));
        }
    }
    let hold = contact.hold();
    let sticks = length(&hold) <= contact.mu;
    let (path, push, gain, rate) = if sticks {
        let rate = T::one() - contact.b.dot(&hold);
        // Below rounding the contact can no longer move along the normal.
        let rate = if rate <= constant::<T>(64.0) * eps { T::zero() } else { rate };
        let path = if slips { Path::SlidingThenSticking } else { Path::Sticking };
        (path, hold, Vector2::zeros(), rate)
    } else {
        let d = contact.renewal();
        let g = contact.slip_rate(&d).dot(&d);
        let path = if slips { Path::SlidingThenRenewal } else { Path::Renewal };
        (path, d * contact.mu, d * g, contact.normal_rate(&d))
    };
    match ledger.follow_line(state, rate, None) {
        Line::Ended { impulse, velocity, work } => {
            let end = State {
                normal: state.normal + impulse,
                tangential: state.tangential - push * impulse,
                velocity,
                work,
            };
            // A phase that lasts no impulse is no phase.
            let path = if slips && impulse <= T::zero() { Path::Sliding } else { path };
            Some((end, gain * impulse, path))
        }
        _ => None,
    }
}

/// The tangential part of a contact in units where m_nn = 1.
#[inline]
pub(crate) fn contact<T: Real>(matrix: &ReducedMatrix<T>, mu: T) -> Contact<T> {
    let unit = T::one() / matrix.nn;
    Contact {
        mu,
        b: Vector2::new(matrix.nt, matrix.ns) * unit,
        tt: matrix.tt * unit,
        ts: matrix.ts * unit,
        ss: matrix.ss * unit,
    }
}

/// Names what is wrong with the input.
#[inline]
pub(crate) fn check<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<(), ImpactError<T>> {
    for value in [m.nn, m.nt, m.ns, m.tt, m.ts, m.ss, v.x, v.y, v.z, surface.mu, surface.e] {
        if !value.is_finite() {
            return Err(ImpactError::NotFinite { value });
        }
    }
    if surface.mu < T::zero() {
        return Err(ImpactError::NegativeFriction { mu: surface.mu });
    }
    if surface.e < T::zero() || surface.e > T::one() {
        return Err(ImpactError::RestitutionOutOfRange { e: surface.e });
    }
    let slack = -T::default_epsilon().sqrt() * constant(0.0625);
    for minor in [m.nn, m.tt, m.ss] {
        if minor < T::zero() {
            return Err(ImpactError::NotPositiveSemidefinite { minor });
        }
    }
    // Correlations, so that units and mixed magnitudes do not matter.
    let part = |x: T, p: T, q: T| {
        let scale = (p * q).sqrt();
        if scale > T::zero() {
            Some(x / scale)
        } else if x == T::zero() {
            Some(T::zero())
        } else {
            None
        }
    };
    let (nt, ns, ts) = (part(m.nt, m.nn, m.tt), part(m.ns, m.nn, m.ss), part(m.ts, m.tt, m.ss));
    if m.nn == T::zero() && nt.is_some() && ns.is_some() {
        return Err(ImpactError::NoNormalMobility { nn: m.nn });
    }
    let (Some(nt), Some(ns), Some(ts)) = (nt, ns, ts) else {
        return Err(ImpactError::NotPositiveSemidefinite { minor: -T::one() });
    };
    let one = T::one();
    let det = one - nt * nt - ns * ns - ts * ts + (nt + nt) * ns * ts;
    for minor in [one - nt * nt, one - ns * ns, one - ts * ts, det] {
        if minor < slack {
            return Err(ImpactError::NotPositiveSemidefinite { minor });
        }
    }
    if v.x >= T::zero() {
        return Err(ImpactError::NotApproaching { normal_velocity: v.x });
    }
    Ok(())
}

/// Both real roots of a x^2 + b x + c, without cancellation; roots that do not exist come out as zero.
#[inline]
pub(crate) fn quadratic<T: Real>(a: T, b: T, c: T) -> [T; 2] {
    let disc = b * b - constant::<T>(4.0) * a * c;
    if disc < T::zero() {
        return [T::zero(); 2];
    }
    let root = disc.sqrt();
    let q = if b < T::zero() { root - b } else { -root - b } * constant(0.5);
    let first = if q != T::zero() { c / q } else { T::zero() };
    let second = if a != T::zero() { q / a } else { T::zero() };
    [first, second]
}
