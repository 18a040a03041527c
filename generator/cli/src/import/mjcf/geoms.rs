//! Geoms: the collision solids of a body, and its mass if none is stated.

use nalgebra::Vector3;

use super::Reader;
use super::elements::Element;
use crate::import::collision::{Collision, Solid};
use crate::import::masses;
use crate::import::poses::{self, Pose};

/// A mass, its moments of inertia about its own axes for a mass of 1, and its pose.
pub type Part = (f64, Vector3<f64>, Pose);

/// A geom.
pub struct Geom {
    /// the collision solid; `None` for a geom without collisions, or one that models do not have
    pub collision: Option<Collision>,
    /// the mass that it contributes to its body; a mistake here matters only if the body states no inertia
    pub mass: Result<Option<Part>, String>,
}

impl Reader<'_> {
    /// Reads a geom of a body.
    pub(super) fn geom(&mut self, element: &Element, of: &str) -> Result<Geom, String> {
        let mut pose = self.angles.pose(element)?;
        let kind = element.text("type").unwrap_or("sphere");
        let ends = element.numbers::<6>("fromto")?;
        let size = element.list("size")?.unwrap_or_default();
        let (mass, density) = (element.numbers::<1>("mass")?, element.amount("density", 1000.0)?);
        if mass.is_some_and(|[mass]| mass < 0.0) {
            return Err(element.wrong("`mass` is negative"));
        }
        if !element.is_or_lacks("shellinertia", "false") {
            return Err(element.wrong("the inertia of a shell is not imported: state an <inertial>"));
        }
        let strikes = ["contype", "conaffinity"].map(|name| element.is_or_lacks(name, "0"));
        let given = ["contype", "conaffinity"].map(|name| element.text(name).is_some());
        let for_the_eye = strikes == [true, true] && given == [true, true];
        let mut length = 0.0;
        if let Some([a, b, c, d, e, f]) = ends {
            if !matches!(kind, "capsule" | "cylinder" | "box" | "ellipsoid") {
                return Err(element.wrong("`fromto` is for capsules, cylinders, boxes and ellipsoids"));
            }
            if element.text("pos").is_some() {
                return Err(element.wrong("it has both `pos` and `fromto`: keep one"));
            }
            let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
            length = (from - to).norm();
            let turn = poses::along_z(from - to).ok_or_else(|| element.wrong("both ends are one point"))?;
            pose = Pose { turn, at: (from + to) * 0.5 };
        }
        let given = |count: usize| -> Result<&[f64], String> {
            let sizes = size.get(..count).filter(|sizes| sizes.iter().all(|size| *size > 0.0));
            sizes.ok_or_else(|| element.wrong(&format!("a {kind} has {count} positive numbers in `size`")))
        };
        // `size` states radii and half lengths
        let along = |count: usize| -> Result<[f64; 2], String> {
            match ends {
                Some(_) => Ok([given(1)?[0], length]),
                None => given(count).map(|size| [size[0], 2.0 * size[1]]),
            }
        };
        let three = |factor: f64| -> Result<[f64; 3], String> {
            match ends {
                // square or round across the line between the ends
                Some(_) => given(1).map(|size| [factor * size[0], factor * size[0], 0.5 * factor * length]),
                None => given(3).map(|size| [0, 1, 2].map(|i| factor * size[i])),
            }
        };
        let solid = match kind {
            "plane" => Solid::Plane,
            "sphere" => Solid::Sphere(given(1)?[0]),
            "capsule" => Solid::Capsule(along(2)?),
            "cylinder" => Solid::Cylinder(along(2)?),
            "ellipsoid" => Solid::Ellipsoid(three(1.0)?),
            "box" => Solid::Box(three(2.0)?),
            "mesh" | "hfield" | "sdf" => {
                let names = ["mesh", "hfield"].map(|name| element.text(name).map(str::to_owned));
                let name = names.into_iter().flatten().next().unwrap_or_default();
                self.ignored
                    .count(format!("the geometry of <geom type=\"{kind}\"> `{name}` of body `{of}`"), || {
                        element.at.clone()
                    });
                let massless = density == 0.0 || mass == Some([0.0]);
                let told = element
                    .wrong(&format!("its mass is that of a {kind}: state the <inertial> of body `{of}`"));
                return Ok(Geom { collision: None, mass: if massless { Ok(None) } else { Err(told) } });
            }
            _ => {
                return Err(
                    element.wrong("`type` is plane, sphere, capsule, cylinder, ellipsoid, box or mesh")
                );
            }
        };
        let mass = masses::of_solid(solid)
            .map(|(volume, moments)| (mass.map_or(density * volume, |[mass]| mass), moments, pose));
        let collision = Collision { solid, offset: pose.at, rpy: pose.rpy() };
        if for_the_eye {
            self.ignored.count("<geom> that strikes nothing".to_owned(), || element.at.clone());
        }
        Ok(Geom { collision: (!for_the_eye).then_some(collision), mass: Ok(mass) })
    }
}
