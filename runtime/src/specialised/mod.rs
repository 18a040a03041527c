//! Collisions whose solver is part of the routine that calls it, under a law that is known while compiling.
//!
//! The solver works on any number type. Here it works on numbers that are those of the caller in all but
//! their type, which says two things ([`crate::scalar::Real`]): under which law all collisions of this type
//! end, and that the functions of the solver become part of their caller. A collision over them is one
//! routine, and has the bits of one over plain numbers.

mod known_law;
mod number;

use nalgebra::Vector3;

pub use self::known_law::{AnyLaw, KnownLaw, OneLaw};
use self::number::Inlined;
use crate::{
    ContactSurface, Impact, ImpactError, Phases, ReducedMatrix, Scalar, Snapshot, Surface,
    structure::{Structure, structured},
};

/// Solves one collision as a part of the caller: the outcome and the errors of
/// [`crate::structure::solve_structured`] under the law that `L` knows, or under that of the surface.
///
/// # Errors
/// Those of [`crate::solve`].
#[inline(always)]
pub fn solve_inlined<S: Structure, L: KnownLaw, T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let quadratures = surface.quadratures();
    let Surface { mu, e, law } = *surface.surface();
    let n = Inlined::<T, L>::of;
    let ReducedMatrix { nn, nt, ns, tt, ts, ss } = *matrix;
    let matrix = ReducedMatrix::new(n(nn), n(nt), n(ns), n(tt), n(ts), n(ss));
    let approach = Vector3::new(n(approach.x), n(approach.y), n(approach.z));
    let surface = Surface { mu: n(mu), e: n(e), law: L::LAW.unwrap_or(law) };
    match structured::<S, Inlined<T, L>>(matrix, approach, surface, quadratures) {
        Ok(impact) => Ok(plain(&impact)),
        Err(error) => Err(plain_error(error)),
    }
}

#[inline(always)]
fn plain_vector<T: Scalar, L: KnownLaw>(v: &Vector3<Inlined<T, L>>) -> Vector3<T> {
    Vector3::new(v.x.value, v.y.value, v.z.value)
}

#[inline(always)]
fn plain_snapshot<T: Scalar, L: KnownLaw>(snapshot: &Snapshot<Inlined<T, L>>) -> Snapshot<T> {
    Snapshot {
        impulse: plain_vector(&snapshot.impulse),
        velocity: plain_vector(&snapshot.velocity),
        contact_work: snapshot.contact_work.value,
        normal_work: snapshot.normal_work.value,
        motion: snapshot.motion,
    }
}

#[inline(always)]
fn plain<T: Scalar, L: KnownLaw>(impact: &Impact<Inlined<T, L>>) -> Impact<T> {
    let Phases { compression_end, last_compression_end, slip_end } = &impact.phases;
    Impact {
        impulse: plain_vector(&impact.impulse),
        approach: plain_vector(&impact.approach),
        velocity: plain_vector(&impact.velocity),
        contact_work: impact.contact_work.value,
        normal_work: impact.normal_work.value,
        path: impact.path,
        compressions: impact.compressions,
        phases: Phases {
            compression_end: compression_end.as_ref().map(plain_snapshot),
            last_compression_end: last_compression_end.as_ref().map(plain_snapshot),
            slip_end: slip_end.as_ref().map(plain_snapshot),
        },
        sensitivity: impact.sensitivity,
    }
}

#[cold]
#[inline(never)]
fn plain_error<T: Scalar, L: KnownLaw>(error: ImpactError<Inlined<T, L>>) -> ImpactError<T> {
    use ImpactError as E;
    match error {
        E::NotFinite { value } => E::NotFinite { value: value.value },
        E::NegativeFriction { mu } => E::NegativeFriction { mu: mu.value },
        E::RestitutionOutOfRange { e } => E::RestitutionOutOfRange { e: e.value },
        E::NotApproaching { normal_velocity } => E::NotApproaching { normal_velocity: normal_velocity.value },
        E::NotPositiveSemidefinite { minor } => E::NotPositiveSemidefinite { minor: minor.value },
        E::NoNormalMobility { nn } => E::NoNormalMobility { nn: nn.value },
        E::NoImpact { rate } => E::NoImpact { rate: rate.value },
        E::Inaccurate { violated, residual } => E::Inaccurate { violated, residual: residual.value },
        E::Wedged { normal_velocity, law } => E::Wedged { normal_velocity: normal_velocity.value, law },
        E::BudgetExceeded { quadratures, normal_velocity } => {
            E::BudgetExceeded { quadratures, normal_velocity: normal_velocity.value }
        }
    }
}
