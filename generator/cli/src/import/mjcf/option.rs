//! `<option>`: gravity, and the flags that switch forces off.

use nalgebra::Vector3;

use super::elements::Element;

/// The forces that a file has, according to `<option>`.
pub struct Forces {
    /// the acceleration of gravity, m/s^2
    pub gravity: Vector3<f64>,
    off: Vec<&'static str>,
}

/// The flags that a model heeds. The others switch off what no model has (contacts, limits), or are means of a
/// simulation.
const FLAGS: [&str; 8] =
    ["gravity", "damper", "spring", "passive", "actuation", "frictionloss", "equality", "constraint"];

impl Forces {
    /// All of them, with the gravity that the format has by default.
    pub fn all() -> Self {
        Forces { gravity: Vector3::new(0.0, 0.0, -9.81), off: Vec::new() }
    }

    /// Whether one of these flags is switched off.
    fn off(&self, flags: &[&str]) -> bool {
        flags.iter().any(|flag| self.off.contains(flag))
    }

    /// The acceleration of gravity, m/s^2.
    pub fn gravity(&self) -> Vector3<f64> {
        if self.off(&["gravity"]) { Vector3::zeros() } else { self.gravity }
    }

    /// Damping, stiffness or friction of a joint, or nothing if the file switches it off.
    pub fn of_joint(&self, kind: &str, amount: f64) -> f64 {
        let off = match kind {
            "damping" => self.off(&["damper", "passive"]),
            "stiffness" => self.off(&["spring", "passive"]),
            _ => self.off(&["frictionloss", "constraint"]),
        };
        if off { 0.0 } else { amount }
    }

    /// Whether actuators exert forces.
    pub fn actuators(&self) -> bool {
        !self.off(&["actuation"])
    }

    /// Whether the constraints of `<equality>` hold.
    pub fn equality(&self) -> bool {
        !self.off(&["equality", "constraint"])
    }

    /// Reads the flags of a `<flag>`.
    ///
    /// # Errors
    ///
    /// A flag is neither `enable` nor `disable`.
    pub fn read_flags(&mut self, element: &Element) -> Result<(), String> {
        for flag in FLAGS {
            match element.text(flag) {
                None => {}
                Some("enable") => self.off.retain(|other| *other != flag),
                Some("disable") => self.off.push(flag),
                Some(_) => return Err(element.wrong(&format!("`{flag}` is `enable` or `disable`"))),
            }
        }
        Ok(())
    }
}
