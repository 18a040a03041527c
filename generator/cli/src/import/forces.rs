//! The forces along the axes of joints: inputs, actuators and damping; and their springs.

use super::description::Actuator;
use super::formulas::bracketed;
use super::text::{JointNames, Writer};
use super::tree::Joint;

impl Writer<'_> {
    /// The force along the axis of a joint, if any: that of its input or actuators, minus damping.
    pub(super) fn effort(
        &mut self,
        moves: &JointNames,
        joint: &Joint,
        base: &str,
        units: [&str; 3],
    ) -> Option<String> {
        let (coordinate, speed) = (bracketed(&moves.coordinates[0]), bracketed(&moves.speeds[0]));
        let mut terms = moves.inputs.clone();
        for actuator in joint.actuators.iter().flatten() {
            terms.push(self.actuator(actuator, &coordinate, &speed, units));
        }
        let [position, _, force] = units;
        if joint.damping != 0.0 {
            let unit = format!("{}*s{}", force, if position == "rad" { "/rad" } else { "/m" });
            let docs = format!("damping of joint `{base}`");
            let name = self.parameter(&format!("d_{base}"), &unit, joint.damping, &docs);
            terms.push(format!("-{name}*{speed}"));
        }
        let sum = terms.join(" + ").replace("+ -", "- ");
        match terms.len() {
            0 => None,
            1 if !sum.starts_with('-') && !sum.contains(' ') => Some(sum),
            _ => Some(format!("({sum})")),
        }
    }

    /// The stiffness of the spring of a joint, and the coordinate at which it exerts no force unless that is
    /// 0: two parameters. `None` if it has no spring.
    pub(super) fn spring(
        &mut self,
        joint: &Joint,
        base: &str,
        units: [&str; 3],
    ) -> Option<(String, Option<String>)> {
        let ([stiffness, rests_at], [position, _, force]) = (joint.spring, units);
        if stiffness == 0.0 {
            return None;
        }
        let docs = format!("stiffness of joint `{base}`");
        let unit = format!("{force}/{position}");
        let name = self.parameter(&format!("s_{base}"), &unit, stiffness, &docs);
        let docs = format!("where the spring of joint `{base}` is without force");
        let rests =
            (rests_at != 0.0).then(|| self.parameter(&format!("q0_{base}"), position, rests_at, &docs));
        Some((name, rests))
    }

    /// The force of an actuator.
    fn actuator(&mut self, actuator: &Actuator, coordinate: &str, speed: &str, units: [&str; 3]) -> String {
        let Actuator { name, gain, bias, gear } = actuator;
        let [position, rate, force] = units;
        let docs = |what: &str| format!("{what} of actuator `{name}`");
        // with a gain of one the input is the force
        let mut terms = Vec::new();
        if *gain != 0.0 {
            let input = self.input(&format!("ctrl_{name}"), if *gain == 1.0 { force } else { "1" });
            terms.push(match *gain {
                1.0 => input,
                gain => {
                    let gain = self.parameter(
                        &format!("gain_{name}"),
                        force,
                        gain,
                        &docs("force for an input of 1"),
                    );
                    format!("{gain}*{input}")
                }
            });
        }
        let shares = [
            ("f0", "", force.to_owned()),
            ("kq", coordinate, format!("{force}/{position}")),
            ("ku", speed, format!("{force}*s/{}", rate.trim_end_matches("/s"))),
        ];
        for ((letter, factor, unit), &number) in shares.into_iter().zip(bias) {
            if number == 0.0 {
                continue;
            }
            // the gear multiplies both the coordinate and the force
            let number = if factor.is_empty() { number } else { number * gear };
            let name = self.parameter(&format!("{letter}_{name}"), &unit, number, &docs("share"));
            terms.push(if factor.is_empty() { name } else { format!("{name}*{factor}") });
        }
        let sum = terms.join(" + ");
        match (*gear, terms.len()) {
            (_, 0) => "0".to_owned(),
            (1.0, _) => sum,
            (gear, count) => {
                let gear = self.parameter(&format!("gear_{name}"), "1", gear, &docs("gear"));
                if count == 1 { format!("{gear}*{sum}") } else { format!("{gear}*({sum})") }
            }
        }
    }
}
