//! The arc of a contact without friction: the impulse is along n, and v_n and the tangential velocity are
//! linear in it.
//!
//! Theory: docs/theory.md, section 11.1.

use nalgebra::{Vector2, Vector3};

use super::{Frictionless, Shape};
use crate::{
    ReducedMatrix, Surface,
    scalar::{Real, constant, length},
    solve::{Contact, LinearArc, Restitution, Slide, State, straight},
};

#[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
impl Shape for Frictionless {
    #[inline(always)]
    fn impose<T: Real>(_: &mut ReducedMatrix<T>, _: &mut Vector3<T>, surface: &mut Surface<T>) {
        surface.mu = T::zero();
    }

    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        let d = from / speed;
        let across = c.b.y * d.x - c.b.x * d.y;
        // Slip can vanish only where it is parallel to b.
        if across.abs() <= constant::<T>(0.25) * T::default_epsilon() * length(&c.b) {
            return straight(c, d, speed, restitution.start(), restitution);
        }
        let start = restitution.start();
        match restitution.follow_linear(&start, T::one(), &Vector2::zeros(), None) {
            LinearArc::Ended { impulse, velocity, work } => Slide::Ended(
                State { normal: impulse, tangential: Vector2::zeros(), velocity, work },
                from + c.b * impulse,
            ),
            _ => Slide::Endless(start),
        }
    }
}
