//! Mass and central inertia of a body as expressions.

use crate::kinematics::Kinematics;
use crate::kinematics::axes::{AxesId, ENTRIES, Symmetric};
use crate::kinematics::linear_forms;
use hodograph_model::model::mechanism::Body;

/// The central inertia of a body and its axes; `None` for a particle.
pub fn central_inertia(k: &mut Kinematics<'_>, body: &Body) -> Option<(Symmetric, AxesId)> {
    let inertia = body.inertia.as_ref()?;
    let axes = k.frame_axes[inertia.frame.0]?;
    let mut components: Symmetric = std::array::from_fn(|i| k.scalar(&inertia.components[i]));
    if let Some(about) = inertia.about
        && about != body.centre
    {
        // parallel axes: I_G = I_H - m (r.r 1 - r r')
        let mass = k.scalar(&body.mass);
        let r = k.position(body.centre, about);
        let r = k.express(&r, axes);
        let square = linear_forms::dot(&r, &r);
        for (at, (i, j)) in ENTRIES.into_iter().enumerate() {
            let product = r[i].mul(&r[j]);
            let part = if i == j { square.sub(&product) } else { product.neg() };
            components[at] = components[at].sub(&mass.mul(&part));
        }
    }
    Some((components.map(|c| k.z.name(c)), axes))
}
