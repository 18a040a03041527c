//! The sizes of coordinates in metres and radians, whatever the units are in which a model counts them.

use hodograph::{ComponentKind, Contacts};

/// Metres or radians per unit of each coordinate; 1 for what is neither.
#[derive(Clone, Debug)]
pub(crate) struct Lengths(Vec<f64>);

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

impl Lengths {
    /// Those of a mechanism.
    pub fn of(mechanism: &dyn Contacts<f64>) -> Self {
        let unit =
            |index| mechanism.component(ComponentKind::Coordinate, index).map_or("", |found| found.unit);
        Self((0..mechanism.count(ComponentKind::Coordinate)).map(|index| in_si(unit(index))).collect())
    }

    /// The greatest coordinate, m or rad.
    pub fn greatest(&self, coordinates: &[f64]) -> f64 {
        coordinates.iter().zip(&self.0).fold(0.0_f64, |size, (q, factor)| size.max((q * factor).abs()))
    }
}

fn in_si(unit: &str) -> f64 {
    match unit {
        "deg" => std::f64::consts::PI / 180.0,
        "rev" => 2.0 * std::f64::consts::PI,
        _ => {
            let prefix = unit.strip_suffix("rad").or_else(|| unit.strip_suffix('m'));
            let power = PREFIXES.iter().find(|(name, _)| prefix == Some(name)).map_or(0, |(_, power)| *power);
            10.0_f64.powi(power)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::in_si;

    #[test]
    fn units_of_coordinates_are_known() {
        let known =
            [("m", 1.0), ("um", 1e-6), ("km", 1e3), ("dam", 10.0), ("mrad", 1e-3), ("rad", 1.0), ("1", 1.0)];
        for (unit, factor) in known {
            assert!((in_si(unit) - factor).abs() <= 1e-15 * factor, "{unit}");
        }
        assert!((in_si("deg") * 180.0 - std::f64::consts::PI).abs() < 1e-14);
        assert!((in_si("kg*m"), in_si("min")) == (1.0, 1.0));
    }
}
