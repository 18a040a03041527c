//! Actuators of joints, which become inputs.

use roxmltree::Node;

use super::Reader;
use super::elements::Element;
use crate::import::description::Actuator;

impl Reader<'_> {
    /// Reads an `<actuator>`.
    pub(super) fn actuators(&mut self, section: Node) {
        for node in section.children().filter(Node::is_element) {
            self.attempt(node, |reader, element| {
                let (joint, actuator) = actuator(element)?;
                let mut joints = reader.chains.joints.iter_mut();
                let found = joints.find(|other| other.name == joint);
                let Some(found) = found else {
                    let names = reader.chains.joints.iter().map(|joint| joint.name.as_str());
                    let hint = crate::spelling::hint(&joint, names);
                    return Err(element.wrong(&format!("it drives the unknown joint `{joint}`: {hint}")));
                };
                if !matches!(found.kind.as_str(), "revolute" | "prismatic") {
                    return Err(element.wrong(&format!(
                        "it drives `{joint}`, which neither turns nor slides about one axis: state its force in the model"
                    )));
                }
                found.actuators.get_or_insert_default().push(actuator);
                Ok(())
            });
        }
    }
}

/// The joint that an actuator drives, and its law.
fn actuator(element: &Element) -> Result<(String, Actuator), String> {
    let joint = element.text("joint").ok_or_else(|| {
        element.wrong("only actuators of a `joint` are imported: state the force of others in the model")
    })?;
    let name = element.text("name").unwrap_or(joint).to_owned();
    let gear = element.list("gear")?.and_then(|gear| gear.first().copied()).unwrap_or(1.0);
    let (gain, bias) = match element.kind.as_str() {
        "motor" => (1.0, [0.0; 3]),
        "position" => {
            let (stiff, damp) = (element.amount("kp", 1.0)?, element.amount("kv", 0.0)?);
            if element.text("dampratio").is_some() {
                return Err(element.wrong("`dampratio` is not imported: state `kv`"));
            }
            (stiff, [0.0, -stiff, -damp])
        }
        "velocity" => {
            let damp = element.amount("kv", 1.0)?;
            (damp, [0.0, 0.0, -damp])
        }
        "general" => {
            let first = |name: &str, default: &[f64]| -> Result<Vec<f64>, String> {
                let mut list = element.list(name)?.unwrap_or_else(|| default.to_vec());
                list.resize(3, 0.0);
                Ok(list)
            };
            let (gain, bias) = (first("gainprm", &[1.0])?, first("biasprm", &[])?);
            let is = |name: &str, value: &str| element.is_or_lacks(name, value);
            let affine = element.text("biastype") == Some("affine");
            if !is("dyntype", "none") || !is("gaintype", "fixed") || !(affine || is("biastype", "none")) {
                return Err(element.wrong(
                    "only `dyntype` none, `gaintype` fixed and `biastype` none or affine are imported",
                ));
            }
            (gain[0], if affine { [bias[0], bias[1], bias[2]] } else { [0.0; 3] })
        }
        kind => {
            return Err(element.wrong(&format!(
                "a {kind} cannot be imported, only motor, position, velocity and general: state its force in the model"
            )));
        }
    };
    Ok((joint.to_owned(), Actuator { name, gain, bias, gear }))
}
