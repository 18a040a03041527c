//! The units of coordinates and speeds in SI, as far as tolerances need them.

use std::f64::consts::PI;

/// The prefixes of units, and their powers of ten.
const PREFIXES: [(&str, i32); 13] = [
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("da", 1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// Metres in a unit of length; `None` if it is another unit.
pub(crate) fn metres(unit: &str) -> Option<f64> {
    with_prefix(unit, "m")
}

/// Radians in a unit of angle; `None` if it is another unit.
pub(crate) fn radians(unit: &str) -> Option<f64> {
    match unit {
        "deg" => Some(PI / 180.0),
        "rev" => Some(2.0 * PI),
        _ => with_prefix(unit, "rad"),
    }
}

/// Radians per second in a unit of angular speed; `None` if it is another unit.
pub(crate) fn radians_per_second(unit: &str) -> Option<f64> {
    let (angle, time) = unit.split_once('/')?;
    Some(radians(angle)? / seconds(time)?)
}

fn seconds(unit: &str) -> Option<f64> {
    match unit {
        "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => with_prefix(unit, "s"),
    }
}

/// The size of a unit with a prefix, or without one, in that without one.
fn with_prefix(unit: &str, symbol: &str) -> Option<f64> {
    let prefix = unit.strip_suffix(symbol)?;
    if prefix.is_empty() {
        return Some(1.0);
    }
    PREFIXES.iter().find(|(name, _)| *name == prefix).map(|(_, power)| 10.0_f64.powi(*power))
}

#[cfg(test)]
mod tests {
    use super::{PI, metres, radians, radians_per_second};

    fn near(found: Option<f64>, wanted: f64) -> bool {
        found.is_some_and(|found| (found - wanted).abs() <= 1e-15 * wanted)
    }

    #[test]
    fn units_are_known() {
        for (unit, factor) in [("m", 1.0), ("um", 1e-6), ("km", 1e3), ("dam", 10.0)] {
            assert!(near(metres(unit), factor), "{unit}");
        }
        for (unit, factor) in [("rad", 1.0), ("mrad", 1e-3), ("deg", PI / 180.0), ("rev", 2.0 * PI)] {
            assert!(near(radians(unit), factor), "{unit}");
        }
        for (unit, factor) in
            [("rad/s", 1.0), ("deg/s", PI / 180.0), ("rev/min", PI / 30.0), ("mrad/ms", 1.0)]
        {
            assert!(near(radians_per_second(unit), factor), "{unit}");
        }
    }

    #[test]
    fn other_units_are_no_lengths_and_no_angles() {
        for unit in ["1", "", "kg*m", "min", "rad", "s", "m/s"] {
            assert_eq!(metres(unit), None, "{unit}");
        }
        for unit in ["1", "m", "rad/s", "grad/s"] {
            assert_eq!(radians(unit), None, "{unit}");
        }
        for unit in ["m/s", "1/s", "rad", "rad/m"] {
            assert_eq!(radians_per_second(unit), None, "{unit}");
        }
    }
}
