//! The sizes of coordinates in metres and radians, whatever the units are in which a model counts them.

use hodograph::{ComponentKind, Contacts};

use crate::closed::units::{metres, radians};

/// Metres or radians per unit of each coordinate; 1 for what is neither.
#[derive(Clone, Debug)]
pub(crate) struct Lengths(Vec<f64>);

impl Lengths {
    /// Those of a mechanism.
    pub fn of(mechanism: &dyn Contacts<f64>) -> Self {
        let unit =
            |index| mechanism.component(ComponentKind::Coordinate, index).map_or("", |found| found.unit);
        let factor = |unit| metres(unit).or_else(|| radians(unit)).unwrap_or(1.0);
        Self((0..mechanism.count(ComponentKind::Coordinate)).map(|index| factor(unit(index))).collect())
    }

    /// The greatest coordinate, m or rad.
    pub fn greatest(&self, coordinates: &[f64]) -> f64 {
        coordinates.iter().zip(&self.0).fold(0.0_f64, |size, (q, factor)| size.max((q * factor).abs()))
    }
}
