//! Determines which speeds and coordinates of a mechanism are angular, from their units.

use hodograph::{ComponentKind, Contacts};

/// The angular speeds and coordinates of a mechanism.
#[derive(Clone, Debug)]
pub(crate) struct Angles {
    /// for each speed whether it is angular
    speeds: Vec<bool>,
    /// for each coordinate the angle of rotation per change of the coordinate
    coordinates: Vec<f64>,
}

impl Angles {
    /// The angles of a mechanism.
    pub fn of(mechanism: &dyn Contacts<f64>) -> Self {
        let unit = |kind, index| mechanism.component(kind, index).map(|component| component.unit);
        let is_angular = |unit: &str| unit.contains("rad") || unit.contains("deg");
        Self {
            speeds: (0..mechanism.count(ComponentKind::Speed))
                .map(|index| unit(ComponentKind::Speed, index).is_some_and(is_angular))
                .collect(),
            coordinates: (0..mechanism.count(ComponentKind::Coordinate))
                .map(|index| match unit(ComponentKind::Coordinate, index) {
                    Some("rad" | "deg") => 1.0,
                    // A quaternion contains half the angle.
                    Some("1" | "") => 2.0,
                    _ => 0.0,
                })
                .collect(),
        }
    }

    /// Whether a speed is an angular one.
    pub fn is_angular(&self, speed: usize) -> bool {
        self.speeds.get(speed).copied().unwrap_or(false)
    }

    /// The sum of all angular speeds, rad/s.
    pub fn speed(&self, speeds: &[f64]) -> f64 {
        speeds.iter().zip(&self.speeds).filter(|(_, angular)| **angular).map(|(u, _)| u.abs()).sum()
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
