//! Checks every outcome against the laws of impact before it is returned; an outcome that violates one
//! becomes an error.
//!
//! The residuals of the laws are formed from the outcome, in the units of the solver, and compared with the
//! speeds, impulses and works of the impact. An outcome has an error of a small multiple of the rounding unit
//! times the condition of the contact. A residual above the square root of the rounding unit means that
//! rounding has taken half of the digits: numbers of this precision do not determine the outcome.
//!
//! Theory: docs/theory.md, sections 9.4 and 18.2.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{Restitution, State},
    target::Watched,
};
use crate::{
    ImpactError, Violation,
    scalar::{Real, constant, dot, fma, larger, length, smaller},
};

/// The largest residual that is accepted, over its scale: the square root of the rounding unit.
#[inline(always)]
fn share<T: Real>() -> T {
    constant(if T::default_epsilon() > constant(1e-10) { 3.5e-4 } else { 1.5e-8 })
}

/// The residual of the balance of momentum that roundings of its terms explain, in rounding units of these
/// terms.
const ROUNDINGS: f64 = 16.0;

/// The largest share of the speeds that may be explained so.
const LEFT: f64 = 1e-3;

/// The residuals of an outcome, each with its scale.
struct Residuals<T> {
    momentum: [(T, T); 2],
    work: T,
    energy: T,
}

impl<T: Real> Restitution<T> {
    /// Checks an outcome against v_2 = v_1 + M I (20)-(22), Coulomb's cone, I_n >= 0, v_n2 >= 0, work of
    /// friction <= 0, and the law of restitution. `from` is the tangential velocity of approach, `slip`
    /// its length.
    #[inline(always)]
    pub(super) fn verify(
        &self,
        c: &Contact<T>,
        from: &Vector2<T>,
        slip: T,
        end: &State<T>,
        velocity: &Vector2<T>,
    ) -> Result<(), ImpactError<T>> {
        if T::INLINED {
            self.verify_here(c, from, slip, end, velocity)
        } else {
            self.verify_apart(c, from, slip, end, velocity)
        }
    }

    #[inline(never)]
    fn verify_apart(
        &self,
        c: &Contact<T>,
        from: &Vector2<T>,
        slip: T,
        end: &State<T>,
        velocity: &Vector2<T>,
    ) -> Result<(), ImpactError<T>> {
        self.verify_here(c, from, slip, end, velocity)
    }

    #[inline(always)]
    fn verify_here(
        &self,
        c: &Contact<T>,
        from: &Vector2<T>,
        slip: T,
        end: &State<T>,
        velocity: &Vector2<T>,
    ) -> Result<(), ImpactError<T>> {
        let Residuals { momentum: [(n, speed), (t, slips)], work, energy } =
            self.residuals(c, from, slip, end, velocity);
        let share = share::<T>();
        let most = c.mu * end.normal;
        let i = &end.tangential;
        // Comparisons with NaN are false, so that NaN fails.
        let sound = n <= share * speed
            && t <= share * slips
            && end.normal >= T::zero()
            && end.velocity >= -share * speed
            && dot(i.x, i.x, i.y, i.y) <= most * most * (T::one() + share)
            && work <= share * energy
            && self.is_ended(end, share)
            && self.work_is_known(c, end);
        if sound { Ok(()) } else { self.violation(c, from, slip, end, velocity) }
    }

    /// The residuals of the balance of momentum along n and across it, and the work of friction, each with
    /// its scale.
    #[inline(always)]
    fn residuals(
        &self,
        c: &Contact<T>,
        from: &Vector2<T>,
        slip: T,
        end: &State<T>,
        velocity: &Vector2<T>,
    ) -> Residuals<T> {
        let (i, start) = (&end.tangential, self.start().velocity);
        let n = dot(c.b.x, i.x, c.b.y, i.y) + (start + end.normal) - end.velocity;
        let t = fma(c.b.x, end.normal, from.x) + dot(c.tt, i.x, c.ts, i.y) - velocity.x;
        let s = fma(c.b.y, end.normal, from.y) + dot(c.ts, i.x, c.ss, i.y) - velocity.y;
        let slips = T::one() + slip + velocity.x.abs() + velocity.y.abs();
        // Couplings of n with the contact plane give v_n intermediate values of the size of slip.
        let coupled = smaller(c.b.x.abs() + c.b.y.abs(), T::one());
        let speed = fma(coupled, slips, T::one() + end.velocity.abs());
        let half = constant::<T>(0.5);
        let rubbed = dot(i.x, from.x + velocity.x, i.y, from.y + velocity.y);
        Residuals {
            momentum: [(n.abs(), speed), (larger(t.abs(), s.abs()), slips)],
            work: fma(fma(end.normal, start + end.velocity, rubbed), half, -end.work),
            energy: dot(end.normal, speed, i.x.abs() + i.y.abs(), slips),
        }
    }

    /// An error that names the law which the outcome violates, if it does. The same checks again, safe from
    /// overflow and with the roundings of the terms.
    #[cold]
    #[inline(never)]
    fn violation(
        &self,
        c: &Contact<T>,
        from: &Vector2<T>,
        slip: T,
        end: &State<T>,
        velocity: &Vector2<T>,
    ) -> Result<(), ImpactError<T>> {
        let i = &end.tangential;
        for value in [end.normal, i.x, i.y, end.velocity, velocity.x, velocity.y, end.work] {
            if !value.is_finite() {
                return Err(ImpactError::NotFinite { value });
            }
        }
        let share = share::<T>();
        let Residuals { momentum: [(n, speed), (t, slips)], work, energy } =
            self.residuals(c, from, slip, end, velocity);
        let broken = |violated: Violation, residual: T| Err(ImpactError::Inaccurate { violated, residual });
        let within = |residual: T, scale: T| residual <= share * scale;
        // The roundings of the terms of the balance, which may be far larger than the speeds.
        let rounding = constant::<T>(ROUNDINGS) * T::default_epsilon();
        let along = end.normal + c.b.x.abs() * i.x.abs() + c.b.y.abs() * i.y.abs();
        let (b, rubbed) = (larger(c.b.x.abs(), c.b.y.abs()), larger(i.x.abs(), i.y.abs()));
        let across = b * end.normal + (larger(c.tt, c.ss) + c.ts.abs()) * rubbed;
        // Where these roundings exceed a share of the speeds, any outcome would be accepted: they are
        // bounded.
        let known = |terms: T, scale: T| smaller(rounding * terms, scale * constant(LEFT));
        if !within(n - known(along, speed), speed) {
            return broken(Violation::Momentum, n / speed);
        }
        if !within(t - known(across, slips), slips) {
            return broken(Violation::Momentum, t / slips);
        }
        if end.normal < T::zero() {
            return broken(Violation::Separation, -end.normal);
        }
        if !within(-end.velocity, speed) {
            return broken(Violation::Separation, -end.velocity);
        }
        let size = larger(i.x.abs(), i.y.abs());
        // Denormal impulses have too few digits to compare.
        if size > constant(if T::default_epsilon() > constant(1e-10) { 1e-30 } else { 1e-290 }) {
            let most = c.mu * end.normal;
            let excess = length(&(i / size)) - most / size;
            if !within(excess, T::one()) {
                return broken(Violation::Friction, excess);
            }
        }
        if !within(work, energy) {
            return broken(Violation::Energy, work / energy);
        }
        let (missed, scale) = self.missed(end);
        if !within(missed, scale) {
            return broken(Violation::Restitution, missed / scale);
        }
        if self.work_is_known(c, end) {
            Ok(())
        } else {
            broken(Violation::Restitution, self.rounded_work(c, end) / scale)
        }
    }

    /// Whether Stronge's law determines the end of the collision: it requires work, the integral of v_n, and the
    /// rounding errors of v_n must have done less than all of it.
    #[inline(always)]
    fn work_is_known(&self, c: &Contact<T>, end: &State<T>) -> bool {
        !self.watches(Watched::Work) || self.rounded_work(c, end) <= -self.least_work
    }

    /// The work that rounding errors of v_n may have done: v_n is known to some roundings of the terms (9.2).
    #[inline(always)]
    fn rounded_work(&self, c: &Contact<T>, end: &State<T>) -> T {
        let i = &end.tangential;
        let terms = end.normal + (c.b.x * i.x).abs() + (c.b.y * i.y).abs();
        constant::<T>(ROUNDINGS) * T::default_epsilon() * terms * end.normal
    }
}

#[cfg(test)]
mod tests {
    use super::super::straight::{Slide, straight};
    use super::*;
    use crate::{Law, ReducedMatrix};

    /// Slip that keeps its direction to the end of the collision, changed in every way that violates one law
    /// and no other.
    #[test]
    fn every_violation_has_its_name() {
        let (mu, from) = (0.3, Vector2::new(0.0, 2.0));
        let c = Contact::new(&ReducedMatrix::new(2.0, 0.0, 0.2, 3.0, 0.0, 1.0), mu);
        for &law in Law::ALL {
            let mut restitution = Restitution::new(law, 0.5);
            let slide = straight(&c, from / 2.0, 2.0, restitution.start(), &mut restitution);
            let Slide::Ended(end, velocity) = slide else { panic!("slip stops") };
            let by = |law: &Restitution<f64>, end: State<f64>, velocity: Vector2<f64>| {
                law.verify(&c, &from, 2.0, &end, &velocity)
            };
            let verify = |end: State<f64>, velocity: Vector2<f64>| by(&restitution, end, velocity);
            // An outcome of other impulses that keeps the balance of momentum and the work of friction.
            let other = |normal: f64, along: f64| {
                let state_velocity = -1.0 + normal + c.b.y * along;
                let velocity = Vector2::new(velocity.x, from.y + c.b.y * normal + c.ss * along);
                let total = 0.5 * (normal * (state_velocity - 1.0) + along * (from.y + velocity.y));
                let friction = 0.5 * along * (from.y + velocity.y);
                let tangential = Vector2::new(0.0, along);
                (State { normal, tangential, velocity: state_velocity, work: total - friction }, velocity)
            };
            let name = |(end, velocity): (State<f64>, Vector2<f64>)| match verify(end, velocity) {
                Ok(()) => None,
                Err(ImpactError::Inaccurate { violated, residual }) => {
                    assert!(residual > share::<f64>(), "{law:?} {violated:?} {residual}");
                    Some(violated)
                }
                Err(error) => panic!("{error:?}"),
            };
            let (normal, along) = (end.normal, end.tangential.y);
            assert_eq!(name((end, velocity)), None);
            for (size, seen) in [(1e-10, false), (1e-5, true)] {
                let seen = |violation| seen.then_some(violation);
                for sign in [-1.0, 1.0] {
                    let x = sign * size;
                    let moved = State { velocity: end.velocity + x, ..end };
                    assert_eq!(name((moved, velocity)), seen(Violation::Momentum));
                    for across in [Vector2::new(x, 0.0), Vector2::new(0.0, x)] {
                        assert_eq!(name((end, velocity + across)), seen(Violation::Momentum));
                    }
                }
                assert_eq!(name(other(normal, along * (1.0 + size))), seen(Violation::Friction));
                let gains =
                    State { work: end.work - mu * normal * (from.y + velocity.y) * 0.5 - size, ..end };
                // Stronge's law sees the normal work that this takes.
                let unseen = (law == Law::Stronge).then_some(Violation::Restitution);
                assert_eq!(name((gains, velocity)), seen(Violation::Energy).or(unseen));
                let (early, late) = (normal * (1.0 - size), normal * (1.0 + size));
                assert_eq!(name(other(early, along * (1.0 - size))), seen(Violation::Restitution), "{law:?}");
                assert_eq!(name(other(late, along)), seen(Violation::Restitution), "{law:?}");
            }
            // Also where the law's target is met.
            for (normal, along) in [(0.9, -0.27), (-0.1, 0.0)] {
                let (end, velocity) = other(normal, along);
                assert_eq!(name((end, velocity)), Some(Violation::Separation));
                let mut met = restitution;
                met.target = restitution.watched(&end);
                let answer = by(&met, end, velocity);
                assert!(matches!(
                    answer,
                    Err(ImpactError::Inaccurate { violated: Violation::Separation, .. })
                ));
            }
            let lost = State { work: f64::NAN, ..end };
            assert!(matches!(verify(lost, velocity), Err(ImpactError::NotFinite { .. })));
        }
    }
}
