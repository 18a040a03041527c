//! Actuators of joints, which become inputs.

use roxmltree::Node;

use super::Reader;
use super::elements::Element;
use crate::import::description::Actuator;

impl Reader<'_> {
    /// Reads an `<actuator>`.
    pub(super) fn actuators(&mut self, section: Node) {
        if !self.forces.actuators() {
            let at = self.at(section);
            return self.ignored.count("<actuator>, which is switched off".to_owned(), || at);
        }
        for node in section.children().filter(Node::is_element) {
            self.attempt(node, |reader, element| {
                let (joint, actuator) = actuator(element, &reader.defaults.of_actuator(node, &element.at))?;
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

/// The joint that an actuator drives, and its law: that of `steps`, the defaults of its class and its own
/// attributes, one after another.
fn actuator(element: &Element, steps: &[Element]) -> Result<(String, Actuator), String> {
    let joint = element.text("joint").ok_or_else(|| {
        element.wrong("only actuators of a `joint` are imported: state the force of others in the model")
    })?;
    let name = element.text("name").unwrap_or(joint).to_owned();
    let gear = element.list("gear")?.and_then(|gear| gear.first().copied()).unwrap_or(1.0);
    if !matches!(element.kind.as_str(), "motor" | "position" | "velocity" | "general") {
        return Err(element.wrong(&format!(
            "a {} cannot be imported, only motor, position, velocity and general: state its force in the model",
            element.kind
        )));
    }
    let mut law = Law::default();
    for step in steps {
        law.change(step)?;
        element.read_like(step);
    }
    if law.kinds != ["none", "fixed", "none"] && law.kinds != ["none", "fixed", "affine"] {
        return Err(
            element.wrong("only `dyntype` none, `gaintype` fixed and `biastype` none or affine are imported")
        );
    }
    let affine = law.kinds[2] == "affine";
    if affine && law.damping_by_ratio {
        return Err(element.wrong("`dampratio` is not imported: state `kv`"));
    }
    let bias = if affine { law.bias } else { [0.0; 3] };
    Ok((joint.to_owned(), Actuator { name, gain: law.gain, bias, gear }))
}

/// The law of an actuator in the attributes of `<general>`, which all kinds of actuators set.
struct Law {
    /// the first of `gainprm`
    gain: f64,
    /// the first three of `biasprm`
    bias: [f64; 3],
    /// `dyntype`, `gaintype`, `biastype`
    kinds: [String; 3],
    /// whether the last of `bias` is a `dampratio`
    damping_by_ratio: bool,
}

impl Default for Law {
    fn default() -> Self {
        let kinds = ["none", "fixed", "none"].map(str::to_owned);
        Law { gain: 1.0, bias: [0.0; 3], kinds, damping_by_ratio: false }
    }
}

impl Law {
    /// Makes the changes of an actuator or a default of actuators.
    fn change(&mut self, element: &Element) -> Result<(), String> {
        match element.kind.as_str() {
            "motor" => {
                self.gain = 1.0;
                self.be("none", "fixed", "none");
            }
            kind @ ("position" | "intvelocity") => {
                self.gain = element.amount("kp", self.gain)?;
                self.bias[1] = -self.gain;
                if element.text("kv").is_some() {
                    self.bias[2] = -element.amount("kv", 0.0)?;
                    self.damping_by_ratio = false;
                }
                self.damping_by_ratio |= element.text("dampratio").is_some();
                let dynamics =
                    if kind == "position" { self.kinds[0].clone() } else { "integrator".to_owned() };
                self.be(&dynamics, "fixed", "affine");
            }
            "velocity" => {
                self.gain = element.amount("kv", self.gain)?;
                self.bias = [0.0, 0.0, -self.gain];
                self.damping_by_ratio = false;
                self.be("none", "fixed", "affine");
            }
            "general" => {
                for (place, name) in ["dyntype", "gaintype", "biastype"].into_iter().enumerate() {
                    if let Some(kind) = element.text(name) {
                        kind.clone_into(&mut self.kinds[place]);
                    }
                }
                if let Some(&gain) = element.list("gainprm")?.unwrap_or_default().first() {
                    self.gain = gain;
                }
                let bias = element.list("biasprm")?.unwrap_or_default();
                self.damping_by_ratio &= bias.len() < 3;
                self.bias.iter_mut().zip(bias).for_each(|(own, stated)| *own = stated);
            }
            "adhesion" => {
                self.gain = element.amount("gain", self.gain)?;
                self.be("none", "fixed", "none");
            }
            "damper" => self.be("none", "affine", "none"),
            "cylinder" => self.be("filter", "fixed", "affine"),
            kind => self.be(kind, kind, kind),
        }
        Ok(())
    }

    fn be(&mut self, dynamics: &str, gain: &str, bias: &str) {
        self.kinds = [dynamics, gain, bias].map(str::to_owned);
    }
}
