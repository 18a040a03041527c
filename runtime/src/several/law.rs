//! Signorini's and Coulomb's laws of one contact as an equation, after Alart and Curnier, with its derivative.
//!
//! With z = x - rho v the laws say x_n = max(0, z_n) and x_tan = the point next to z_tan on the disc of radius
//! mu max(0, z_n). Theory: docs/theory.md, section 17.10.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::{Scalar, scalar::length};

/// What friction does at a contact.
#[derive(Clone, Copy)]
pub(super) struct Friction<T: nalgebra::Scalar> {
    pub mu: T,
    /// The direction of slip, of length one; `None` without slip.
    pub slip: Option<Vector2<T>>,
}

/// F(x, v) = 0 says that both laws hold.
#[inline]
pub(super) fn residual<T: Scalar>(law: &Friction<T>, rho: T, x: &Vector3<T>, v: &Vector3<T>) -> Vector3<T> {
    let pressed = x.x - rho * v.x;
    if pressed <= T::zero() {
        return *x;
    }
    if let Some(d) = law.slip {
        let push = law.mu * x.x;
        return Vector3::new(rho * v.x, x.y + push * d.x, x.z + push * d.y);
    }
    let (y, radius) = (Vector2::new(x.y - rho * v.y, x.z - rho * v.z), law.mu * pressed);
    let size = length(&y);
    if size <= radius {
        return v * rho;
    }
    let rim = y * (radius / size);
    Vector3::new(rho * v.x, x.y - rim.x, x.z - rim.y)
}

/// The derivatives of F by x and by v.
#[inline]
pub(super) fn derivative<T: Scalar>(
    law: &Friction<T>,
    rho: T,
    x: &Vector3<T>,
    v: &Vector3<T>,
) -> (Matrix3<T>, Matrix3<T>) {
    let pressed = x.x - rho * v.x;
    if pressed <= T::zero() {
        return (Matrix3::identity(), Matrix3::zeros());
    }
    let (mut by_x, mut by_v) = (Matrix3::zeros(), Matrix3::zeros());
    by_v[(0, 0)] = rho;
    if let Some(d) = law.slip {
        by_x[(1, 1)] = T::one();
        by_x[(2, 2)] = T::one();
        by_x[(1, 0)] = law.mu * d.x;
        by_x[(2, 0)] = law.mu * d.y;
        return (by_x, by_v);
    }
    let (y, radius) = (Vector2::new(x.y - rho * v.y, x.z - rho * v.z), law.mu * pressed);
    let size = length(&y);
    if size <= radius {
        return (by_x, Matrix3::identity() * rho);
    }
    let d = y / size;
    let turn = (Matrix2::identity() - d * d.transpose()) * (radius / size);
    by_x.fixed_view_mut::<2, 2>(1, 1).copy_from(&(Matrix2::identity() - turn));
    by_x.fixed_view_mut::<2, 1>(1, 0).copy_from(&(d * -law.mu));
    by_v.fixed_view_mut::<2, 2>(1, 1).copy_from(&(turn * rho));
    by_v.fixed_view_mut::<2, 1>(1, 0).copy_from(&(d * (law.mu * rho)));
    (by_x, by_v)
}

/// The force next to one that the laws allow in the mode that `x` and `v` show.
#[inline]
pub(super) fn allowed<T: Scalar>(law: &Friction<T>, rho: T, x: &Vector3<T>, v: &Vector3<T>) -> Vector3<T> {
    if x.x - rho * v.x <= T::zero() || x.x <= T::zero() {
        return Vector3::zeros();
    }
    let radius = law.mu * x.x;
    if let Some(d) = law.slip {
        return Vector3::new(x.x, -radius * d.x, -radius * d.y);
    }
    let size = (x.y * x.y + x.z * x.z).sqrt();
    if size <= radius {
        return *x;
    }
    Vector3::new(x.x, x.y * (radius / size), x.z * (radius / size))
}
