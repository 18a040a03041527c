//! The arc of a planar contact: slip keeps its direction (h = 0), and all velocities are linear in I_n.
//!
//! Theory: docs/theory.md, section 11.1.

use nalgebra::{Vector2, Vector3};

use super::{Planar, Shape};
use crate::{
    ReducedMatrix, Surface,
    scalar::Real,
    solve::{Contact, Restitution, Slide, straight},
};

#[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
impl Shape for Planar {
    #[inline(always)]
    fn impose<T: Real>(m: &mut ReducedMatrix<T>, v: &mut Vector3<T>, _: &mut Surface<T>) {
        (m.ns, m.ts, v.z) = (T::zero(), T::zero(), T::zero());
        // Nothing moves out of the plane: slip cannot turn.
        m.ss = T::zero();
    }

    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        straight(c, from / speed, speed, restitution.start(), restitution)
    }
}
