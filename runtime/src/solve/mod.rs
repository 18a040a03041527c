//! The exact solver: sliding arc, then terminal arc, in units where m_nn = 1 and v_n1 = -1.

mod event;
mod event_location;
mod gauss16;
mod gauss4;
mod grazing;
mod invariant_directions;
mod lanes;
mod perturbation;
mod restitution;
mod sliding;
mod sliding_arc;
mod stop_series;
mod terminal;

use nalgebra::{Vector2, Vector3};

pub(crate) use self::{
    event::Event,
    restitution::{LinearArc, Restitution, State},
    sliding::{Slide, slide, straight},
    terminal::{Contact, Terminal},
};
use crate::{
    Impact, ImpactError, Path, ReducedMatrix, Sensitivity, Surface,
    phases::{Units, phases},
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
    collide(matrix, approach, surface, Restitution::new(surface.law, surface.e), slide)
}

/// Solves a collision whose input is checked, with a new restitution and any way of following the sliding arc.
#[inline(always)]
pub(crate) fn collide<T: Real>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
    mut restitution: Restitution<T>,
    slide: impl FnOnce(&Contact<T>, Vector2<T>, T, &mut Restitution<T>) -> Slide<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let speed = -approach.x;
    let contact = contact(matrix, surface.mu);
    let tangential = Vector2::new(approach.y, approach.z) / speed;
    let slip = length(&tangential);
    let slips = slips(slip);
    let mut sensitivity = Sensitivity::of_start(&contact, &tangential, slip);
    let mut state = State::approach();
    let mut ended = None;
    let (mut stops, mut endless) = (false, false);
    if slips {
        match slide(&contact, tangential, slip, &mut restitution) {
            Slide::Ended(end, velocity) => ended = Some((end, velocity, Path::Sliding)),
            Slide::Stopped(stopped) => {
                restitution.grazing.moved(stopped.velocity);
                (state, stops) = (stopped, true);
            }
            Slide::Endless(stopped) => (state, endless) = (stopped, true),
        }
    }
    if ended.is_none() && !endless {
        ended = after_slip(&contact, &mut state, slips, &mut restitution, &mut sensitivity);
    }
    let Some((end, velocity, path)) = ended else {
        return Err(ImpactError::Wedged { normal_velocity: state.velocity * speed, law: surface.law });
    };
    let slides = path == Path::Sliding && !stops;
    sensitivity.ended(&contact, &mut restitution, &end, slides.then_some(&velocity));
    let slip_end = stops.then_some(state);
    let scale = speed / matrix.nn;
    let impulse = Vector3::new(end.normal, end.tangential.x, end.tangential.y) * scale;
    let separation = Vector3::new(end.velocity, velocity.x, velocity.y) * speed;
    let normal_work = end.work * scale * speed;
    // One look at all of them suffices where nothing is wrong.
    if !(impulse.x + impulse.y + impulse.z + separation.x + separation.y + separation.z + normal_work)
        .is_finite()
    {
        for value in [impulse.x, impulse.y, impulse.z, separation.x, separation.y, separation.z, normal_work]
        {
            if !value.is_finite() {
                return Err(ImpactError::NotFinite { value });
            }
        }
    }
    Ok(Impact {
        impulse,
        velocity: separation,
        contact_work: impulse.dot(&(separation + approach)) * constant(0.5),
        normal_work,
        path,
        compressions: restitution.compressions,
        phases: phases(&Units { approach, scale, speed, contact }, &restitution, slip_end, path),
        sensitivity,
    })
}

/// Whether there is slip at all, where v_n1 = -1.
#[inline]
pub(crate) fn slips<T: Real>(slip: T) -> bool {
    let eps = T::default_epsilon();
    slip > eps * eps * eps * eps
}

/// The arc after slip has stopped; nothing if the law never ends it.
#[inline]
fn after_slip<T: Real>(
    contact: &Contact<T>,
    state: &mut State<T>,
    slips: bool,
    restitution: &mut Restitution<T>,
    sensitivity: &mut Sensitivity,
) -> Option<(State<T>, Vector2<T>, Path)> {
    let eps = T::default_epsilon();
    let Terminal { sticks, push, gain, rate, mu_c } = Terminal::of(contact);
    // Where slip and normal velocity stop together, rounding must not tell them apart: most of all where little moves the contact afterwards,
    // or where compression has just ended.
    let scale = T::one() + state.normal * (T::one() + contact.mu * length(&contact.b));
    let again = restitution.compressions > 0 && state.velocity < T::zero();
    let few = constant::<T>(if again || rate <= constant(0.01) { 256.0 } else { 8.0 });
    if slips && state.velocity.abs() <= few * eps * scale {
        state.velocity = T::zero();
        if restitution.compressions == 0 && restitution.compressed(state) {
            return Some((*state, Vector2::zeros(), Path::Sliding));
        }
    }
    sensitivity.stopped(contact.mu, mu_c);
    let path = match (slips, sticks) {
        (true, true) => Path::SlidingThenSticking,
        (true, false) => Path::SlidingThenRenewal,
        (false, true) => Path::Sticking,
        (false, false) => Path::Renewal,
    };
    match restitution.follow_linear(state, rate, &push, None) {
        LinearArc::Ended { impulse, velocity, work } => {
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
    // The inverse of a tiny m_nn may be infinite where no quotient is.
    let nn = matrix.nn;
    Contact {
        mu,
        b: Vector2::new(matrix.nt / nn, matrix.ns / nn),
        tt: matrix.tt / nn,
        ts: matrix.ts / nn,
        ss: matrix.ss / nn,
    }
}

/// Names what is wrong with the input.
#[inline]
pub(crate) fn check<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<(), ImpactError<T>> {
    if plainly_right(m, v, surface) { Ok(()) } else { check_closely(m, v, surface) }
}

/// Whether the input is right, and far enough from every edge to see it without care.
#[inline]
fn plainly_right<T: Real>(m: &ReducedMatrix<T>, v: &Vector3<T>, surface: &Surface<T>) -> bool {
    let zero = T::zero();
    let (a, b, c) = (m.nn * m.tt, m.nn * m.ss, m.tt * m.ss);
    // Below this a product may have lost what it is compared with.
    let least = T::default_epsilon() * T::default_epsilon() * T::default_epsilon() * T::default_epsilon();
    let minor = c - m.ts * m.ts;
    let det = m.nn * minor - m.nt * (m.nt * m.ss - m.ns * m.ts) + m.ns * (m.nt * m.ts - m.tt * m.ns);
    m.nn > zero
        && a > least
        && b > least
        && c > least
        && a >= m.nt * m.nt
        && b >= m.ns * m.ns
        && minor >= zero
        && det >= zero
        && v.x < zero
        && surface.mu >= zero
        && surface.e >= zero
        && surface.e <= T::one()
        && (det + v.x + v.y + v.z + surface.mu).is_finite()
}

/// Names what is wrong, if anything is.
#[cold]
#[inline(never)]
fn check_closely<T: Real>(
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
    // Correlations, so that units and mixed magnitudes do not matter. Roots first: products may overflow or vanish.
    let (n, t, s) = (m.nn.sqrt(), m.tt.sqrt(), m.ss.sqrt());
    let part = |x: T, p: T, q: T| {
        let scale = p * q;
        if scale > T::zero() {
            Some(x / scale)
        } else if x == T::zero() {
            Some(T::zero())
        } else {
            None
        }
    };
    let (nt, ns, ts) = (part(m.nt, n, t), part(m.ns, n, s), part(m.ts, t, s));
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
