//! What an impact can be asked: the input that is refused, each with its reason, and what rounding does to a reduced matrix.
//!
//! Theory: docs/theory.md, section 1.3.

use nalgebra::Vector3;

use crate::{
    ImpactError, ReducedMatrix, Surface,
    scalar::{Real, constant, dot, fma, larger},
};

/// How many rounding units, times the largest diagonal entry, an entry of a reduced matrix is known to.
///
/// An entry is a sum of products of partial velocities and their images under M^-1. Its rounding error is relative to the sizes of these
/// terms, which are those of the largest diagonal entry, however small the entry itself is: a few units for each of some dozen terms.
const NOISE: f64 = 256.0;

/// Names what is wrong with the input.
#[inline]
pub(crate) fn check<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<(), ImpactError<T>> {
    checked(m, v, surface).map(|_| ())
}

/// Names what is wrong with the input of a collision. Where rounding alone makes a matrix indefinite, gives the one to take instead.
#[inline]
pub(crate) fn checked<T: Real>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Option<ReducedMatrix<T>>, ImpactError<T>> {
    if plainly_right(m, surface) && v.x < T::zero() && (v.x + v.y + v.z).is_finite() {
        return Ok(None);
    }
    let matrix = check_closely(m, v, surface)?;
    if v.x >= T::zero() {
        return Err(ImpactError::NotApproaching { normal_velocity: v.x });
    }
    Ok(Some(matrix))
}

/// Whether contact and surface are right, and far enough from every edge to see it without care.
#[inline]
fn plainly_right<T: Real>(m: &ReducedMatrix<T>, surface: &Surface<T>) -> bool {
    let zero = T::zero();
    let (a, b, c) = (m.nn * m.tt, m.nn * m.ss, m.tt * m.ss);
    // Below this a product may have lost what it is compared with.
    let least = T::default_epsilon() * T::default_epsilon() * T::default_epsilon() * T::default_epsilon();
    let minor = c - m.ts * m.ts;
    let (t, s) = (dot(m.nt, m.ss, -m.ns, m.ts), dot(m.nt, m.ts, -m.tt, m.ns));
    let det = fma(m.nn, minor, dot(-m.nt, t, m.ns, s));
    m.nn > zero
        && a > least
        && b > least
        && c > least
        && a >= m.nt * m.nt
        && b >= m.ns * m.ns
        && minor >= zero
        && det >= zero
        && surface.mu >= zero
        && surface.e >= zero
        && surface.e <= T::one()
        && (det + surface.mu).is_finite()
}

/// Names what is wrong with contact, surface and numbers, if anything is; else the matrix without what rounding did to it.
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

/// The matrix, if it is positive semidefinite but for rounding: an entry m_ij may exceed sqrt(m_ii m_jj) by what it is known to, and is then
/// taken for that bound, which is zero beside a diagonal entry of zero.
fn without_noise<T: Real>(m: &ReducedMatrix<T>) -> Result<ReducedMatrix<T>, ImpactError<T>> {
    let (zero, one) = (T::zero(), T::one());
    let noise = constant::<T>(NOISE) * T::default_epsilon() * larger(larger(m.nn, m.tt), m.ss);
    let diagonal = |minor: T| match minor {
        _ if minor >= zero => Ok(minor),
        _ if minor >= -noise => Ok(zero),
        _ => Err(ImpactError::NotPositiveSemidefinite { minor }),
    };
    let (nn, tt, ss) = (diagonal(m.nn)?, diagonal(m.tt)?, diagonal(m.ss)?);
    // Roots first: products may overflow or vanish. Minors are those of correlations, so that mixed magnitudes do not matter.
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
        // No correlation beside zero: as wrong as can be.
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
    // Each correlation is uncertain by the noise over its bound; the determinant by at most four times that for each.
    let uncertain = |p: T, q: T| if p * q > zero { noise / (p * q) } else { zero };
    let sum = uncertain(n, t) + uncertain(n, s) + uncertain(t, s);
    if det < -slack - constant::<T>(4.0) * sum {
        return Err(ImpactError::NotPositiveSemidefinite { minor: det });
    }
    // A direction known by its noise alone has no couplings.
    if matrix.tt <= matrix.ss && larger(nt.abs(), ts.abs()) <= noise {
        (matrix.nt, matrix.ts) = (zero, zero);
    } else if matrix.ss <= matrix.tt && larger(ns.abs(), ts.abs()) <= noise {
        (matrix.ns, matrix.ts) = (zero, zero);
    }
    Ok(matrix)
}
