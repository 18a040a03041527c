//! Checks the input of an impact: refuses what is wrong, with the reason, and removes from a reduced matrix
//! what rounding added to it.
//!
//! Theory: docs/theory.md, section 1.3.

use nalgebra::Vector3;

use crate::{
    ImpactError, ReducedMatrix, Surface,
    scalar::{Arithmetic, Mask, Real, constant, dot, fma, larger},
};

/// The uncertainty of an entry of a reduced matrix, in rounding units times the largest diagonal entry.
///
/// An entry is a sum of products of partial velocities and their images under M^-1. Its rounding error is
/// relative to the sizes of these terms, which are those of the largest diagonal entry, however small the
/// entry itself is: a few units for each of some dozen terms.
const NOISE: f64 = 256.0;

/// An error that says what is wrong with the input, if anything is.
#[inline]
pub(crate) fn check<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<(), ImpactError<T>> {
    checked(m, v, surface).map(|_| ())
}

/// An error that says what is wrong with the input of a collision, if anything is. Where rounding alone makes
/// the matrix indefinite, the matrix to use instead.
#[inline(always)]
pub(crate) fn checked<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Option<ReducedMatrix<T>>, ImpactError<T>> {
    if T::INLINED { checked_here(m, v, surface) } else { checked_apart(m, v, surface) }
}

#[inline(never)]
fn checked_apart<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Option<ReducedMatrix<T>>, ImpactError<T>> {
    checked_here(m, v, surface)
}

#[inline(always)]
fn checked_here<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Option<ReducedMatrix<T>>, ImpactError<T>> {
    if plainly_right(m, v, surface.mu, surface.e) {
        return Ok(None);
    }
    let matrix = check_closely(m, v, surface)?;
    if v.x >= T::zero() {
        return Err(ImpactError::NotApproaching { normal_velocity: v.x });
    }
    Ok(Some(matrix))
}

/// Whether contact, surface and velocity are valid by a margin so large that rounding does not matter; `false` decides
/// nothing.
#[inline(always)]
pub(super) fn plainly_right<T: Arithmetic>(m: &ReducedMatrix<T>, v: &Vector3<T>, mu: T, e: T) -> T::Mask {
    let zero = T::zero();
    let (a, b, c) = (m.nn * m.tt, m.nn * m.ss, m.tt * m.ss);
    // Products below this may be denormal and comparisons with them meaningless.
    let least = T::default_epsilon() * T::default_epsilon() * T::default_epsilon() * T::default_epsilon();
    let minor = c - m.ts * m.ts;
    let (t, s) = (dot(m.nt, m.ss, -m.ns, m.ts), dot(m.nt, m.ts, -m.tt, m.ns));
    let det = fma(m.nn, minor, dot(-m.nt, t, m.ns, s));
    zero.below(m.nn)
        .and(|| least.below(a))
        .and(|| least.below(b))
        .and(|| least.below(c))
        .and(|| (m.nt * m.nt).at_most(a))
        .and(|| (m.ns * m.ns).at_most(b))
        .and(|| zero.at_most(minor))
        .and(|| zero.at_most(det))
        .and(|| zero.at_most(mu))
        .and(|| zero.at_most(e))
        .and(|| e.at_most(T::one()))
        .and(|| (det + mu).has_end())
        .and(|| v.x.below(zero))
        .and(|| (v.x + v.y + v.z).has_end())
}

/// An error that says what is wrong with contact, surface and numbers, if anything is; else the matrix
/// without the effect of rounding.
#[cold]
#[inline(never)]
pub(super) fn check_closely<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<ReducedMatrix<T>, ImpactError<T>> {
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
    without_noise(m)
}

/// The matrix without the effect of rounding, or an error.
#[inline]
fn without_noise<T: Real>(m: &ReducedMatrix<T>) -> Result<ReducedMatrix<T>, ImpactError<T>> {
    match bounded(m) {
        Err(error @ ImpactError::NotPositiveSemidefinite { .. }) => bounded(&raised(m)).or(Err(error)),
        answer => answer,
    }
}

/// The matrix with small diagonal entries raised, within their uncertainty, where a coupling demands it by
/// more than its own uncertainty: beside a large entry, a small one decides by its rounding error alone how
/// large the coupling may be.
#[cold]
#[inline(never)]
fn raised<T: Real>(m: &ReducedMatrix<T>) -> ReducedMatrix<T> {
    let noise = uncertainty(m);
    let ReducedMatrix { mut nn, mut tt, mut ss, .. } = *m;
    let raise = |x: T, p: &mut T, q: &mut T| {
        let (great, small) = if *p >= *q { (*p, q) } else { (*q, p) };
        let root = larger(*small, T::zero()).sqrt();
        let needed = x.abs() / great.sqrt();
        if x.abs() - great.sqrt() * root > noise && (needed - root) * (needed + root) <= noise {
            *small = needed * needed;
        }
    };
    raise(m.nt, &mut nn, &mut tt);
    raise(m.ns, &mut nn, &mut ss);
    raise(m.ts, &mut tt, &mut ss);
    ReducedMatrix { nn, tt, ss, ..*m }
}

/// The uncertainty of an entry.
#[inline]
fn uncertainty<T: Real>(m: &ReducedMatrix<T>) -> T {
    constant::<T>(NOISE) * T::default_epsilon() * larger(larger(m.nn, m.tt), m.ss)
}

/// The matrix, if it is positive semidefinite up to rounding. An entry m_ij may exceed sqrt(m_ii m_jj) by its
/// uncertainty and is then set to that bound, which is zero where m_ii or m_jj is zero.
fn bounded<T: Real>(m: &ReducedMatrix<T>) -> Result<ReducedMatrix<T>, ImpactError<T>> {
    let (zero, one) = (T::zero(), T::one());
    let noise = uncertainty(m);
    let diagonal = |minor: T| match minor {
        _ if minor >= zero => Ok(minor),
        _ if minor >= -noise => Ok(zero),
        _ => Err(ImpactError::NotPositiveSemidefinite { minor }),
    };
    let (nn, tt, ss) = (diagonal(m.nn)?, diagonal(m.tt)?, diagonal(m.ss)?);
    // Roots before products, which may overflow or underflow. The minors are those of the correlations, which
    // have no units.
    let (n, t, s) = (nn.sqrt(), tt.sqrt(), ss.sqrt());
    let slack = T::default_epsilon().sqrt() * constant(0.0625);
    let bounded = |x: T, p: T, q: T| {
        let most = p * q;
        if x.abs() <= most {
            return Ok(x);
        }
        if x.abs() - most <= noise {
            return Ok(if x < zero { -most } else { most });
        }
        // A coupling beside a diagonal entry of zero: the worst minor that a correlation can give.
        let minor = if most > zero { one - (x / most) * (x / most) } else { -one };
        if minor < -slack { Err(ImpactError::NotPositiveSemidefinite { minor }) } else { Ok(x) }
    };
    let (nt, ns, ts) = (bounded(m.nt, n, t)?, bounded(m.ns, n, s)?, bounded(m.ts, t, s)?);
    if nn <= zero {
        return Err(ImpactError::NoNormalMobility { nn: m.nn });
    }
    let mut matrix = ReducedMatrix { nn, nt, ns, tt, ts, ss };
    let part = |x: T, most: T| if most > zero { x / most } else { zero };
    let (cnt, cns, cts) = (part(nt, n * t), part(ns, n * s), part(ts, t * s));
    let det = one - cnt * cnt - cns * cns - cts * cts + (cnt + cnt) * cns * cts;
    if det >= -slack {
        return Ok(matrix);
    }
    // Each correlation is uncertain by noise / sqrt(m_ii m_jj); the determinant by at most four times their
    // sum.
    let uncertain = |p: T, q: T| if p * q > zero { noise / (p * q) } else { zero };
    let sum = uncertain(n, t) + uncertain(n, s) + uncertain(t, s);
    if det < -slack - constant::<T>(4.0) * sum {
        return Err(ImpactError::NotPositiveSemidefinite { minor: det });
    }
    // The couplings of the less mobile tangential direction are noise where they lie within it.
    if matrix.tt <= matrix.ss && larger(nt.abs(), ts.abs()) <= noise {
        (matrix.nt, matrix.ts) = (zero, zero);
    } else if matrix.ss <= matrix.tt && larger(ns.abs(), ts.abs()) <= noise {
        (matrix.ns, matrix.ts) = (zero, zero);
    }
    Ok(matrix)
}
