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

/// The joint that an actuator drives, and its law: that of `classes`, the defaults of its classes from the
/// outermost on and its own attributes.
fn actuator(element: &Element, classes: &[Vec<Element>]) -> Result<(String, Actuator), String> {
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
    let mut laws = Laws::default();
    for class in classes {
        laws.inner();
        for step in class {
            laws.change(step)?;
            element.read_like(step);
        }
    }
    let law = laws.last();
    if law.kinds != ["none", "fixed", "none"] && law.kinds != ["none", "fixed", "affine"] {
        return Err(
            element.wrong(
                "only `dyntype` none (a `position` without `timeconst`), `gaintype` fixed and `biastype` none or affine are \
                 imported: state its force in the model",
            )
        );
    }
    let affine = law.kinds[2] == "affine";
    if affine && law.bias[2] > 0.0 && law.gain == -law.bias[1] {
        return Err(element.wrong("`dampratio` is not imported: state `kv`"));
    }
    let bias = if affine { law.bias } else { [0.0; 3] };
    Ok((joint.to_owned(), Actuator { name, gain: law.gain, bias, gear }))
}

/// The laws of the default actuators of classes, the outermost first, each with the kind of the element that
/// changed it last.
#[derive(Default)]
struct Laws(Vec<(String, Law)>);

impl Laws {
    /// Begins a class in the one before, whose law it inherits.
    fn inner(&mut self) {
        self.0.extend(self.0.last().cloned());
    }

    /// Makes the changes of an actuator or a default of actuators to the law of the class. An element of a
    /// kind changes the innermost law of this kind or of a `<general>`; a `<general>` that of any kind.
    fn change(&mut self, element: &Element) -> Result<(), String> {
        let kind = element.kind.as_str();
        let fits = |(other, _): &&(String, Law)| kind == "general" || other == kind || other == "general";
        let mut law = self.0.iter().rev().find(fits).map_or_else(Law::default, |(_, law)| law.clone());
        law.change(element)?;
        self.0.pop();
        self.0.push((kind.to_owned(), law));
        Ok(())
    }

    /// The law of the innermost class.
    fn last(self) -> Law {
        self.0.into_iter().next_back().map_or_else(Law::default, |(_, law)| law)
    }
}

/// The law of an actuator in the attributes of `<general>`, which all kinds of actuators set.
#[derive(Clone)]
struct Law {
    /// the first of `gainprm`
    gain: f64,
    /// the first three of `biasprm`; a positive last one is the `dampratio` of a servo
    bias: [f64; 3],
    /// `dyntype`, `gaintype`, `biastype`
    kinds: [String; 3],
}

impl Default for Law {
    fn default() -> Self {
        let kinds = ["none", "fixed", "none"].map(str::to_owned);
        Law { gain: 1.0, bias: [0.0; 3], kinds }
    }
}

impl Law {
    /// Makes the changes of an actuator or a default of actuators.
    fn change(&mut self, element: &Element) -> Result<(), String> {
        match element.kind.as_str() {
            "motor" => {
                *self = Law::default();
            }
            kind @ ("position" | "intvelocity") => {
                self.gain = element.amount("kp", self.gain)?;
                self.bias = [0.0, -self.gain, self.bias[2]];
                match ["kv", "dampratio"].map(|name| element.text(name).is_some()) {
                    [true, true] => return Err(element.wrong("state one of `kv` and `dampratio`")),
                    [true, false] => self.bias[2] = -element.amount("kv", 0.0)?,
                    [false, true] => self.bias[2] = element.amount("dampratio", 0.0)?,
                    [false, false] => {}
                }
                let filtered = match element.numbers::<1>("timeconst")? {
                    Some([time]) => time > 0.0,
                    None => self.kinds[0] == "filterexact",
                };
                let dynamics = match kind {
                    "position" if filtered => "filterexact",
                    "position" => "none",
                    _ => "integrator",
                };
                self.be(dynamics, "fixed", "affine");
            }
            "velocity" => {
                self.gain = element.amount("kv", self.gain)?;
                self.bias = [0.0, 0.0, -self.gain];
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
