//! The elements and attributes of SDF that are read; the others are told.

use crate::import::xml::Known;

/// Names of elements or attributes.
type Names = &'static [&'static str];

/// What is read of files of SDF 1.`version`.
pub(super) fn known(version: u32) -> Vec<Known> {
    // until 1.6 an axis may be along the axes of the model, and a pose is relative to its `frame`
    let old = version < 7;
    let axis: Names = if old { &["xyz", "dynamics", "use_parent_model_frame"] } else { &["xyz", "dynamics"] };
    let pose: Names = match old {
        true => &["relative_to", "rotation_format", "degrees", "frame"],
        false => &["relative_to", "rotation_format", "degrees"],
    };
    let leaves = [
        "static",
        "parent",
        "child",
        "mass",
        "density",
        "ixx",
        "iyy",
        "izz",
        "ixy",
        "ixz",
        "iyz",
        "size",
        "radius",
        "length",
        "radii",
        "normal",
        "damping",
        "friction",
        "spring_stiffness",
        "spring_reference",
    ];
    let parts = [
        // the canonical link tells what the axes of the model move with, which nothing of a model depends on
        Known::new(
            "model",
            &["name", "placement_frame", "canonical_link"],
            &["pose", "static"],
            &["link", "joint", "frame"],
        ),
        Known::new("link", &["name"], &["pose", "inertial"], &["collision"]),
        Known::new("joint", &["name", "type"], &["pose", "parent", "child", "axis"], &[]),
        Known::new("frame", &["name", "attached_to"], &["pose"], &[]),
        Known::new("pose", pose, &[], &[]),
        // the densities count if the inertia is computed from the collisions
        Known::new("inertial", &["auto"], &["pose", "mass", "inertia", "density"], &[]),
        Known::new("inertia", &[], &["ixx", "iyy", "izz", "ixy", "ixz", "iyz"], &[]),
        Known::new("collision", &["name"], &["pose", "geometry", "density"], &[]),
        // a shape that is not imported has a note of its own
        Known::new(
            "geometry",
            &[],
            &[],
            &[
                "box",
                "sphere",
                "cylinder",
                "capsule",
                "ellipsoid",
                "plane",
                "cone",
                "mesh",
                "heightmap",
                "polyline",
                "image",
                "empty",
            ],
        ),
        Known::new("box", &[], &["size"], &[]),
        Known::new("sphere", &[], &["radius"], &[]),
        Known::new("cylinder", &[], &["radius", "length"], &[]),
        Known::new("capsule", &[], &["radius", "length"], &[]),
        Known::new("ellipsoid", &[], &["radii"], &[]),
        // a plane of a collision has no end, whatever its size
        Known::new("plane", &[], &["normal", "size"], &[]),
        Known::new("axis", &[], axis, &[]),
        Known::new("xyz", &["expressed_in"], &[], &[]),
        Known::new("dynamics", &[], &["damping", "friction", "spring_stiffness", "spring_reference"], &[]),
    ];
    parts.into_iter().chain(leaves.map(|name| Known::new(name, &[], &[], &[]))).collect()
}
