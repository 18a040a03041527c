//! The same pairs by parry3d.

use parry3d_f64::math::{Pose as Placed, Rotation, Vector};
use parry3d_f64::query::contact;
use parry3d_f64::shape::{Ball, Capsule, ConvexPolyhedron, Cuboid, Cylinder, HalfSpace, Shape};

use crate::pairs::{POLYTOPES, kinds};
use crate::{Failure, Pose};

/// A shape, and where it is on its body.
pub type Placing = (Box<dyn Shape>, Placed);

/// Whether parry has these shapes: it has no ellipsoid.
pub fn knows(pair: &str) -> bool {
    !pair.contains("ellipsoid")
}

/// The two shapes of a pair; what is along z here is along y there.
pub fn shapes(pair: &str) -> Result<[Placing; 2], Failure> {
    let kinds = kinds(pair)?;
    let turned = Placed::from_parts(Vector::ZERO, Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2));
    let of = |which: usize| -> Result<Placing, Failure> {
        let still = Placed::identity();
        Ok(match (kinds[which], which) {
            ("plane", _) => (Box::new(HalfSpace::new(Vector::Z)), still),
            ("sphere", 0) => (Box::new(Ball::new(0.1)), still),
            ("sphere", _) => (Box::new(Ball::new(0.2)), still),
            ("capsule", 0) => (Box::new(Capsule::new_z(0.15, 0.05)), still),
            ("capsule", _) => (Box::new(Capsule::new_z(0.2, 0.1)), still),
            ("cylinder", 0) => (Box::new(Cylinder::new(0.15, 0.1)), turned),
            ("cylinder", _) => (Box::new(Cylinder::new(0.25, 0.2)), turned),
            ("box", 0) => (Box::new(Cuboid::new(Vector::new(0.1, 0.15, 0.2))), still),
            ("box", _) => (Box::new(Cuboid::new(Vector::new(0.2, 0.25, 0.3))), still),
            ("polytope", which) => {
                let points: Vec<Vector> = POLYTOPES[which].iter().map(|p| Vector::from_array(*p)).collect();
                let hull = ConvexPolyhedron::from_convex_hull(&points).ok_or("no hull")?;
                (Box::new(hull), still)
            }
            (other, _) => return Err(format!("parry has no `{other}`").into()),
        })
    };
    Ok([of(0)?, of(1)?])
}

/// The distance at a pose, with the nearest points and the normal.
#[inline(never)]
pub fn narrow_counted(shapes: &[Placing; 2], pose: &Pose) -> f64 {
    let [x, y, z, e0, e1, e2, e3] = *pose;
    let place = Placed::from_parts(Vector::new(x, y, z), Rotation::from_xyzw(e1, e2, e3, e0));
    let [(own, at), (other, there)] = shapes;
    // the plane stands first: the other order gives another distance
    let found = contact(there, other.as_ref(), &(place * *at), own.as_ref(), 1.0);
    found.ok().flatten().map_or(f64::NAN, |contact| contact.dist)
}
