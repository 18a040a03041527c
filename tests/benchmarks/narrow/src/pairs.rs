//! The pairs: their generated modules, and the same pairs as models of MuJoCo.

use hodograph::Contacts;

use crate::Failure;

macro_rules! pairs {
    ($($name:ident $machine:ident $file:literal),+ $(,)?) => {
        #[allow(missing_docs)]
        mod machines {
            $(hodograph::mechanism!($file);)+
        }

        /// The names of the pairs.
        pub const PAIRS: &[&str] = &[$(stringify!($name)),+];

        /// The mechanism of a pair.
        pub fn machine(name: &str) -> Result<Box<dyn Contacts<f64>>, Failure> {
            match name {
                $(stringify!($name) => Ok(Box::new(machines::$name::$machine::<f64>::default())),)+
                other => Err(format!("there is no pair `{other}`").into()),
            }
        }
    };
}

pairs! {
    sphere_on_plane SphereOnPlane "models/sphere_on_plane.mech",
    capsule_on_plane CapsuleOnPlane "models/capsule_on_plane.mech",
    cylinder_on_plane CylinderOnPlane "models/cylinder_on_plane.mech",
    ellipsoid_on_plane EllipsoidOnPlane "models/ellipsoid_on_plane.mech",
    box_on_plane BoxOnPlane "models/box_on_plane.mech",
    sphere_on_sphere SphereOnSphere "models/sphere_on_sphere.mech",
    sphere_on_capsule SphereOnCapsule "models/sphere_on_capsule.mech",
    sphere_on_cylinder SphereOnCylinder "models/sphere_on_cylinder.mech",
    sphere_on_box SphereOnBox "models/sphere_on_box.mech",
    sphere_on_ellipsoid SphereOnEllipsoid "models/sphere_on_ellipsoid.mech",
    ellipsoid_on_ellipsoid EllipsoidOnEllipsoid "models/ellipsoid_on_ellipsoid.mech",
    capsule_on_capsule CapsuleOnCapsule "models/capsule_on_capsule.mech",
    capsule_on_box CapsuleOnBox "models/capsule_on_box.mech",
    box_on_box BoxOnBox "models/box_on_box.mech",
    polytope_on_polytope PolytopeOnPolytope "models/polytope_on_polytope.mech",
}

/// The vertices of the two polytopes.
pub const POLYTOPES: [&[[f64; 3]]; 2] = [
    &[[0.1, 0.1, 0.1], [-0.1, -0.1, 0.1], [-0.1, 0.1, -0.1], [0.1, -0.1, -0.1]],
    &[
        [-0.3, -0.3, -0.1],
        [-0.3, 0.3, -0.1],
        [0.3, -0.3, -0.1],
        [0.3, 0.3, -0.1],
        [0.0, -0.3, 0.2],
        [0.0, 0.3, 0.2],
    ],
];

/// The kinds of shapes of a pair.
pub fn kinds(pair: &str) -> Result<[&str; 2], Failure> {
    pair.split_once("_on_").map(|(own, other)| [own, other]).ok_or_else(|| "a pair has two shapes".into())
}

/// A pair as a model of MuJoCo, with a margin that makes contacts of bodies that are apart.
pub fn peer_model(pair: &str) -> Result<String, Failure> {
    let kinds = kinds(pair)?;
    let geom = |which: usize| -> Result<String, Failure> {
        let kind = kinds[which];
        let (word, size) = match (kind, which) {
            ("plane", _) => (kind, "0 0 1"),
            ("sphere", 0) => (kind, "0.1"),
            ("sphere", _) => (kind, "0.2"),
            ("capsule", 0) => (kind, "0.05 0.15"),
            ("capsule", _) => (kind, "0.1 0.2"),
            ("cylinder", 0) => (kind, "0.1 0.15"),
            ("cylinder", _) => (kind, "0.2 0.25"),
            ("ellipsoid", 0) => (kind, "0.1 0.15 0.25"),
            ("ellipsoid", _) => (kind, "0.2 0.3 0.4"),
            ("box", 0) => (kind, "0.1 0.15 0.2"),
            ("box", _) => (kind, "0.2 0.25 0.3"),
            ("polytope", _) => return Ok(format!("<geom type=\"mesh\" mesh=\"m{which}\" margin=\"1\"/>")),
            (other, _) => return Err(format!("`{other}` is no shape here").into()),
        };
        Ok(format!("<geom type=\"{word}\" size=\"{size}\" margin=\"1\"/>"))
    };
    let mesh = |which: usize| {
        let numbers: Vec<String> = POLYTOPES[which].iter().flatten().map(f64::to_string).collect();
        format!("<mesh name=\"m{which}\" vertex=\"{}\"/>", numbers.join(" "))
    };
    let meshes = if kinds[0] == "polytope" { mesh(0) + &mesh(1) } else { String::new() };
    let (own, other) = (geom(0)?, geom(1)?);
    Ok(format!(
        "<mujoco><asset>{meshes}</asset><worldbody>{other}<body><freejoint/>{own}</body></worldbody></mujoco>"
    ))
}
