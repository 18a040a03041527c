//! The sliding arc of a diagonal contact: balanced, with t and s as the principal axes of T.
//!
//! Theory: docs/theory.md, section 11.4.

use nalgebra::{Vector2, Vector3};

use super::{Diagonal, Shape, balanced::decay};
use crate::{
    ReducedMatrix, Surface,
    scalar::Real,
    solve::{Contact, Restitution, Slide, slide_rarely},
};

#[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
impl Shape for Diagonal {
    #[inline(always)]
    fn impose<T: Real>(m: &mut ReducedMatrix<T>, _: &mut Vector3<T>, _: &mut Surface<T>) {
        (m.nt, m.ns, m.ts) = (T::zero(), T::zero(), T::zero());
    }

    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        if !c.is_ordinary() {
            return slide_rarely(c, from, speed, restitution);
        }
        let (one, zero) = (T::one(), T::zero());
        let along = c.tt >= c.ss;
        let (axis, values) = if along { ([one, zero], [c.tt, c.ss]) } else { ([zero, one], [c.ss, c.tt]) };
        decay(c, from, speed, Vector2::from(axis), values, restitution)
    }
}
