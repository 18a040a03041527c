//! Determines which speeds and coordinates of a mechanism are angular, from their units.

use hodograph::{ComponentKind, Contacts};

use crate::closed::units::{radians, radians_per_second};

/// The angular speeds and coordinates of a mechanism.
#[derive(Clone, Debug)]
pub(crate) struct Angles {
    /// for each speed that is angular its unit, rad/s
    speeds: Vec<Option<f64>>,
    /// for each coordinate the angle of rotation per change of the coordinate, rad
    coordinates: Vec<f64>,
}

impl Angles {
    /// The angles of a mechanism.
    pub fn of(mechanism: &dyn Contacts<f64>) -> Self {
        let unit = |kind, index| mechanism.component(kind, index).map(|component| component.unit);
        Self {
            speeds: (0..mechanism.count(ComponentKind::Speed))
                .map(|index| unit(ComponentKind::Speed, index).and_then(radians_per_second))
                .collect(),
            coordinates: (0..mechanism.count(ComponentKind::Coordinate))
                .map(|index| match unit(ComponentKind::Coordinate, index) {
                    // A quaternion contains half the angle.
                    Some("1" | "") => 2.0,
                    unit => unit.and_then(radians).unwrap_or(0.0),
                })
                .collect(),
        }
    }

    /// The unit of a speed that is angular, rad/s.
    pub fn unit(&self, speed: usize) -> Option<f64> {
        self.speeds.get(speed).copied().flatten()
    }

    /// The sum of all angular speeds, rad/s.
    pub fn speed(&self, speeds: &[f64]) -> f64 {
        speeds.iter().zip(&self.speeds).filter_map(|(u, unit)| unit.map(|unit| (u * unit).abs())).sum()
    }

    /// Whether no coordinate is an angle.
    pub fn are_none(&self) -> bool {
        self.coordinates.iter().all(|weight| *weight == 0.0)
    }

    /// The sum of the rates of all angles for these rates of the coordinates, rad/s.
    pub fn turned(&self, rates: &[f64]) -> f64 {
        rates.iter().zip(&self.coordinates).map(|(rate, weight)| (rate * weight).abs()).sum()
    }
}
