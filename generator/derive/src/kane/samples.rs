//! Sample states of a mechanism, at which passes estimate rounding errors.

use std::f64::consts::PI;

use hodograph_model::arbitrary::Arbitrary;
use hodograph_model::model::mechanism::{Mechanism, Orientation, Variable};
use hodograph_program::program::Inputs;

/// Number of samples.
const SAMPLES: u64 = 24;

/// Half a turn in the units of angles that coordinates commonly have.
const HALF_TURNS: [(&str, f64); 4] = [("rad", PI), ("mrad", 1000.0 * PI), ("deg", 180.0), ("rev", 0.5)];

/// Random states over the mechanism's whole range, and parameters of common sizes, always the same. Default
/// values are not used, so that the equations do not depend on them.
pub fn samples(mechanism: &Mechanism) -> Vec<Inputs> {
    (0..SAMPLES).map(|seed| sample(mechanism, seed)).collect()
}

fn sample(mechanism: &Mechanism, seed: u64) -> Inputs {
    let mut arbitrary = Arbitrary::after(0xd1b5_4a32_d192_ed03_u64.wrapping_mul(2 * seed + 1));
    let mut next = || arbitrary.number();
    let half_turn = |unit: &str| HALF_TURNS.iter().find(|(name, _)| *name == unit).map(|(_, size)| *size);
    let parameters =
        mechanism.parameters.iter().map(|parameter| match parameter.value.filter(|_| parameter.fixed) {
            Some(value) => value,
            None => parameter.typical * (1.0 + 0.5 * next()),
        });
    let parameters: Vec<f64> = parameters.collect();
    // An angle may have any value; other quantities have the size that their unit suggests.
    let mut around = |quantity: &Variable, angle: bool| match half_turn(&quantity.unit) {
        Some(half_turn) if angle => half_turn * next(),
        _ => 2.0 * quantity.typical * next(),
    };
    let mut coordinates: Vec<f64> =
        mechanism.coordinates.iter().map(|coordinate| around(coordinate, true)).collect();
    let speeds: Vec<f64> = mechanism.speeds.iter().map(|speed| around(speed, false)).collect();
    let inputs: Vec<f64> = mechanism.inputs.iter().map(|input| around(input, false)).collect();
    for frame in &mechanism.frames {
        if let Orientation::Quaternion(parts) = &frame.orientation {
            let length = parts.iter().map(|part| coordinates[part.0].powi(2)).sum::<f64>().sqrt();
            parts.iter().for_each(|part| coordinates[part.0] /= length);
        }
    }
    let directions = coordinates.len() + speeds.len() + inputs.len();
    Inputs {
        parameters,
        time: next(),
        accelerations: speeds.iter().map(|_| next()).collect(),
        tangent: (0..directions).map(|_| next()).collect(),
        coordinates,
        speeds,
        inputs,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mechanism(model: &str) -> Mechanism {
        let checked = hodograph_model::check::check(&hodograph_model::source::Source::file("m.mech", model));
        checked.mechanism.unwrap_or_else(|| panic!("{:?}", checked.diagnostics))
    }

    const MODEL: &str = "mechanism M; parameters { fixed m: kg = 2, l: m = 7 } coordinates { q1: rad = 0.1, x: mm = 4, y: m, q2: deg }
        speeds { u1: rad/s, u2: mm/s = 3, u3: m/s, u4: rad/s } frames { B = N.rotate(z, q1); C = N.rotate(z, q2); } points { G = O + x*N.x + y*N.y; }
        bodies { R { frame: B, centre: G, mass: m, inertia: [m*l^2, m*l^2, m*l^2] }, S { frame: C, centre: G, mass: m, inertia: [m*l^2, m*l^2, m*l^2] } }
        kinematics { d(x)/dt = u2; d(y)/dt = u3; d(q2)/dt = u4; }";

    #[test]
    fn samples_are_of_common_sizes_whatever_the_unit() {
        let samples = samples(&mechanism(MODEL));
        assert!(samples.iter().all(|sample| sample.parameters[0] == 2.0));
        assert!(samples.iter().all(|sample| (0.25..=0.75).contains(&sample.parameters[1])));
        assert!(samples.iter().any(|sample| sample.coordinates[0] > 2.0));
        assert!(samples.iter().any(|sample| sample.coordinates[1] > 500.0));
        assert!(samples.iter().all(|sample| sample.coordinates[1].abs() <= 1000.0));
        assert!(samples.iter().all(|sample| sample.coordinates[2].abs() <= 1.0));
        assert!(samples.iter().any(|sample| sample.coordinates[3] > 90.0));
        assert!(samples.iter().any(|sample| sample.speeds[1].abs() > 1000.0));
    }

    #[test]
    fn samples_do_not_depend_on_defaults() {
        let other = MODEL
            .replace("l: m = 7", "l: m = 0.001")
            .replace("q1: rad = 0.1", "q1: rad")
            .replace("u2: mm/s = 3", "u2: mm/s = -1");
        assert_eq!(samples(&mechanism(MODEL)), samples(&mechanism(&other)));
    }
}
