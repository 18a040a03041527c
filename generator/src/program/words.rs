//! Words for quantities and structures, as derivations and cost tables write them.

use std::fmt;

use super::routine::{ContactQuantity, PointQuantity, Quantity, Structure};

/// Quantities of the whole mechanism.
const WHOLE: [(Quantity, &str); 13] = [
    (Quantity::CoordinateRates, "coordinate_rates"),
    (Quantity::DependentSpeeds, "dependent_speeds"),
    (Quantity::MassMatrix, "mass_matrix"),
    (Quantity::Forcing, "forcing"),
    (Quantity::Accelerations, "accelerations"),
    (Quantity::DependentAccelerations, "dependent_accelerations"),
    (Quantity::InverseDynamics, "inverse_dynamics"),
    (Quantity::StateTangent, "state_tangent"),
    (Quantity::KineticEnergy, "kinetic_energy"),
    (Quantity::PotentialEnergy, "potential_energy"),
    (Quantity::ConfigurationResidual, "configuration_residual"),
    (Quantity::ConfigurationJacobian, "configuration_jacobian"),
    (Quantity::ConstraintResidual, "constraint_residual"),
];

/// Quantities of a contact.
const CONTACT: [(ContactQuantity, &str); 12] = [
    (ContactQuantity::Normal, "normal"),
    (ContactQuantity::First, "first"),
    (ContactQuantity::Second, "second"),
    (ContactQuantity::Velocity, "velocity"),
    (ContactQuantity::PartialVelocities, "partial_velocities"),
    (ContactQuantity::Remainder, "remainder"),
    (ContactQuantity::Reduced, "reduced"),
    (ContactQuantity::Response, "response"),
    (ContactQuantity::DependentResponse, "dependent_response"),
    (ContactQuantity::Gap, "gap"),
    (ContactQuantity::PrescribedWork, "prescribed_work"),
    (ContactQuantity::Tangent, "tangent"),
];

/// Quantities of a point.
const POINT: [(PointQuantity, &str); 3] = [
    (PointQuantity::Position, "position"),
    (PointQuantity::Velocity, "velocity"),
    (PointQuantity::Jacobian, "jacobian"),
];

/// Structures of a reduced matrix.
const STRUCTURE: [(Structure, &str); 5] = [
    (Structure::General, "general"),
    (Structure::Planar, "planar"),
    (Structure::Balanced, "balanced"),
    (Structure::Diagonal, "diagonal"),
    (Structure::Isotropic, "isotropic"),
];

fn word<K: PartialEq>(table: &[(K, &'static str)], key: &K) -> &'static str {
    table.iter().find(|(known, _)| known == key).map_or("?", |(_, word)| word)
}

fn key<K: Copy>(table: &[(K, &'static str)], word: &str) -> Option<K> {
    table.iter().find(|(_, known)| *known == word).map(|(key, _)| *key)
}

impl fmt::Display for Quantity {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::Contact(index, quantity) => write!(out, "contact {index} {}", word(&CONTACT, quantity)),
            Quantity::Point(index, quantity) => write!(out, "point {index} {}", word(&POINT, quantity)),
            Quantity::Orientation(index) => write!(out, "orientation {index}"),
            whole => out.write_str(word(&WHOLE, whole)),
        }
    }
}

impl Quantity {
    /// The quantity that these words mean, as `Display` writes them.
    pub fn from_words(words: &[&str]) -> Option<Self> {
        match *words {
            [whole] => key(&WHOLE, whole),
            ["contact", index, quantity] => {
                Some(Quantity::Contact(index.parse().ok()?, key(&CONTACT, quantity)?))
            }
            ["point", index, quantity] => Some(Quantity::Point(index.parse().ok()?, key(&POINT, quantity)?)),
            ["orientation", index] => Some(Quantity::Orientation(index.parse().ok()?)),
            _ => None,
        }
    }
}

impl fmt::Display for Structure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(word(&STRUCTURE, self))
    }
}

impl Structure {
    /// The structure that this word means.
    pub fn from_word(word: &str) -> Option<Self> {
        key(&STRUCTURE, word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_read_back() {
        let wholes = WHOLE.iter().map(|(quantity, _)| *quantity);
        let contacts = CONTACT.iter().map(|(quantity, _)| Quantity::Contact(3, *quantity));
        let points = POINT.iter().map(|(quantity, _)| Quantity::Point(7, *quantity));
        for quantity in wholes.chain(contacts).chain(points).chain([Quantity::Orientation(2)]) {
            let text = quantity.to_string();
            assert_eq!(Quantity::from_words(&text.split(' ').collect::<Vec<_>>()), Some(quantity), "{text}");
        }
        for (structure, word) in STRUCTURE {
            assert_eq!(Structure::from_word(word), Some(structure));
        }
    }
}
