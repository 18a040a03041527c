//! The quantities that a program can compute. Their properties are in [`table`].

mod description;
pub mod table;

use std::fmt;

use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::rust_names::snake_case;

pub use description::{Axes, Description, Entries, Extent, Offer, Takes};

/// A quantity that a program computes. Shapes: `p` independent speeds, `d` dependent speeds, `n` coordinates,
/// `c` configuration equations (as many as dependent coordinates). Matrices are stored by rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// q' (n)
    CoordinateRates,
    /// dependent speeds (d)
    DependentSpeeds,
    #[doc(alias = "CRBA")]
    /// M (p x p), all entries
    MassMatrix,
    /// forcing (p): M u' = forcing
    Forcing,
    #[doc(alias = "ABA")]
    /// u' of the independent speeds (p)
    Accelerations,
    /// u' of the dependent speeds (d)
    DependentAccelerations,
    #[doc(alias = "RNEA")]
    /// generalised forces (p) that must be added to the loads for the given u' (inputs `Acceleration`): M u' - forcing
    InverseDynamics,
    /// derivative of the rates of the independent coordinates and of the accelerations along a direction
    /// (inputs `Tangent`): a column of the linearised equations (number of independent coordinates + p)
    StateTangent,
    /// u' and its derivatives with respect to independent coordinates, independent speeds and named inputs: p
    /// rows; columns: the value, then one per coordinate, speed and input. Dependent coordinates and speeds
    /// follow the independent ones; parameters and time are constant
    AccelerationsDerivatives,
    /// inverse dynamics and its derivatives, likewise, for given u' (inputs `Acceleration`), which is
    /// constant
    InverseDynamicsDerivatives,
    /// derivatives of the rates of the independent coordinates (rows); columns: one per independent
    /// coordinate, independent speed and named input
    RatesDerivatives,
    /// kinetic energy (1), J
    KineticEnergy,
    /// potential energy of gravity and springs (1), J
    PotentialEnergy,
    /// residual of the configuration equations (c)
    ConfigurationResidual,
    /// its derivatives with respect to the dependent coordinates (c x c)
    ConfigurationJacobian,
    /// residual of the velocity constraints after substitution of the dependent speeds (d), zero up to
    /// rounding
    ConstraintResidual,
    /// momentum of all bodies (3), along N.x, N.y, N.z, as are the next four
    Momentum,
    /// angular momentum of all bodies about O (3)
    AngularMomentum,
    /// angular momentum of all bodies about their mass centre (3)
    CentralAngularMomentum,
    /// position of the mass centre of all bodies from O (3)
    MassCentrePosition,
    /// velocity of the mass centre of all bodies (3)
    MassCentreVelocity,
    /// a quantity of a contact (index into `Mechanism::contacts`)
    Contact(u32, ContactQuantity),
    /// a quantity of a point (index into `Mechanism::points`)
    Point(u32, PointQuantity),
    /// components of the axes of a frame in N (3 x 3: columns are the frame's x, y, z; index into
    /// `Mechanism::frames`)
    Orientation(u32),
}

/// Quantities of a contact. The contact basis is `normal`, `first`, `second`, right-handed (second = normal x
/// first).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ContactQuantity {
    /// n along N.x, N.y, N.z (3)
    Normal,
    /// first tangential axis along N.x, N.y, N.z (3)
    First,
    /// second tangential axis along N.x, N.y, N.z (3)
    Second,
    /// v^R in the contact basis (3)
    Velocity,
    /// rows: contact basis, columns: independent speeds (3 x p); the paper's V_n, V_t, V_s
    PartialVelocities,
    /// derivative of v^R in the contact basis (3) along (1, q', u'): its rates without contact forces
    FreeAcceleration,
    /// v_t^R in the contact basis (3)
    Remainder,
    #[doc(alias = "Delassus")]
    /// reduced matrix V M^-1 V^T in the contact basis: nn, n1, n2, 11, 12, 22 (6)
    Reduced,
    /// change of the independent speeds per unit impulse, M^-1 V^T (p x 3)
    Response,
    /// change of the dependent speeds per unit impulse (d x 3)
    DependentResponse,
    /// gap (1), only where the model gives one
    Gap,
    /// how far the contact point is inside the features that touch (1), only if these are bounded
    Validity,
    /// a bound from below on how far the two shapes are apart (1); of the first contact of shapes that have many
    Clearance,
    /// sum over bodies of (m v_t . dv) per unit impulse (3): the work of prescribed motion in (24)
    PrescribedWork,
    /// angular velocity of the striking body relative to the struck one (3) in the contact basis; this and
    /// the next three only if the surface has rolling or pivoting friction
    AngularVelocity,
    /// its partial velocities: rows: contact basis, columns: independent speeds (3 x p)
    PartialAngularVelocities,
    /// derivative of the relative angular velocity (3) along (1, q', u'): its rates without contact forces
    FreeAngularAcceleration,
    /// change of the independent speeds per unit angular impulse along the contact basis (p x 3)
    AngularResponse,
    /// derivatives of velocity (3), reduced matrix (6), response (3 p, by rows) and gap (1, if the contact
    /// has one) along a direction (inputs `Tangent`), if none of them depends on time explicitly
    Tangent,
    /// the same quantities (rows) with their derivatives; columns: the value, then one per independent
    /// coordinate, independent speed and named input
    Derivatives,
}

/// Quantities of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PointQuantity {
    /// position from O along N.x, N.y, N.z (3)
    Position,
    /// velocity in N along N.x, N.y, N.z (3)
    Velocity,
    /// partial velocities along N.x, N.y, N.z (3 x p)
    Jacobian,
    /// acceleration in N along N.x, N.y, N.z (3) for given rates of the independent speeds (inputs
    /// `Acceleration`)
    Acceleration,
}

/// The structure of a reduced matrix that its symbols show: which entries vanish or are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Structure {
    /// no structure
    General,
    /// n2 = 12 = 0 and no velocity along `second`; n1 arbitrary: planar
    Planar,
    /// n1 = n2 = 0
    Balanced,
    /// n1 = n2 = 12 = 0
    Diagonal,
    /// 12 = 0 and 11 = 22
    Isotropic,
}

/// The words of structures in derivation files.
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
        let word = self.description().word;
        match self {
            Quantity::Contact(index, _) => write!(out, "contact {index} {word}"),
            Quantity::Point(index, _) => write!(out, "point {index} {word}"),
            Quantity::Orientation(index) => write!(out, "orientation {index}"),
            _ => out.write_str(word),
        }
    }
}

impl Quantity {
    /// The properties of the quantity.
    pub fn description(self) -> &'static Description {
        let row = match self {
            Quantity::Contact(_, quantity) => table::find(table::CONTACT, quantity),
            Quantity::Point(_, quantity) => table::find(table::POINT, quantity),
            Quantity::Orientation(_) => Some(&table::ORIENTATION),
            whole => table::find(table::WHOLE, whole),
        };
        // A test ensures that every quantity has a row.
        row.unwrap_or(&description::PLAIN)
    }

    /// The name of the method that computes it in the module of a mechanism, if there is one.
    pub fn method(self, mechanism: &Mechanism) -> Option<String> {
        let prefix = self.description().method?;
        let of = match self {
            Quantity::Contact(index, _) => &mechanism.contacts.get(index as usize)?.name,
            Quantity::Point(index, _) => &mechanism.points.get(index as usize)?.name,
            Quantity::Orientation(index) => &mechanism.frames.get(index as usize)?.name,
            _ => return Some(prefix.to_owned()),
        };
        Some(format!("{prefix}_{}", snake_case(of)))
    }

    /// Whether it is a matrix whose columns solve systems of equations. Few values are live if its entries
    /// are computed column by column.
    pub fn is_solved_by_columns(self) -> bool {
        matches!(self, Quantity::AccelerationsDerivatives)
    }

    /// The quantity with these words, as `Display` writes them.
    pub fn from_words(words: &[&str]) -> Option<Self> {
        match *words {
            [word] => table::key(table::WHOLE, word),
            ["contact", index, word] => {
                Some(Quantity::Contact(index.parse().ok()?, table::key(table::CONTACT, word)?))
            }
            ["point", index, word] => {
                Some(Quantity::Point(index.parse().ok()?, table::key(table::POINT, word)?))
            }
            ["orientation", index] => Some(Quantity::Orientation(index.parse().ok()?)),
            _ => None,
        }
    }

    /// The quantities of the whole mechanism that are offered by name, in the order of their indices.
    pub fn named() -> impl Iterator<Item = Quantity> {
        table::WHOLE.iter().filter(|(_, row)| row.offer == Offer::Named).map(|(quantity, _)| *quantity)
    }
}

impl fmt::Display for Structure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(word(&STRUCTURE, self))
    }
}

impl Structure {
    /// The structure with this word.
    pub fn from_word(word: &str) -> Option<Self> {
        key(&STRUCTURE, word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_read_back() {
        let wholes = table::WHOLE.iter().map(|(quantity, _)| *quantity);
        let contacts = table::CONTACT.iter().map(|(quantity, _)| Quantity::Contact(3, *quantity));
        let points = table::POINT.iter().map(|(quantity, _)| Quantity::Point(7, *quantity));
        for quantity in wholes.chain(contacts).chain(points).chain([Quantity::Orientation(2)]) {
            let text = quantity.to_string();
            assert_eq!(Quantity::from_words(&text.split(' ').collect::<Vec<_>>()), Some(quantity), "{text}");
        }
        for (structure, word) in STRUCTURE {
            assert_eq!(Structure::from_word(word), Some(structure));
        }
    }

    /// Every variant has one row: the variants count up, so that a missing row leaves a gap.
    #[test]
    fn every_quantity_has_one_row() {
        fn complete<K: Copy + Ord + fmt::Debug>(rows: &[(K, Description)], last: K, count: usize) {
            let mut keys: Vec<K> = rows.iter().map(|(key, _)| *key).collect();
            keys.sort_unstable();
            keys.dedup();
            assert_eq!((keys.len(), rows.len()), (count, count), "{keys:?}");
            assert_eq!(keys.last(), Some(&last));
        }
        let whole = Quantity::MassCentreVelocity;
        complete(table::WHOLE, whole, 21);
        complete(table::CONTACT, ContactQuantity::Derivatives, ContactQuantity::Derivatives as usize + 1);
        complete(table::POINT, PointQuantity::Acceleration, PointQuantity::Acceleration as usize + 1);
    }

    /// Every text for readers is present for every quantity, and quantities offered by name have a unit.
    #[test]
    fn every_row_is_filled_in() {
        let rows = table::WHOLE.iter().map(|(_, row)| row);
        let rows = rows.chain(table::CONTACT.iter().map(|(_, row)| row));
        for row in rows.chain(table::POINT.iter().map(|(_, row)| row)).chain([&table::ORIENTATION]) {
            assert!(!row.word.is_empty() && !row.title.is_empty() && !row.symbol.is_empty(), "{row:?}");
            assert!(row.offer != Offer::Named || !row.unit.is_empty() && row.method.is_some(), "{row:?}");
            assert!(row.offer != Offer::Written || !row.slice.0.is_empty(), "{row:?}");
            assert!(row.docs.is_empty() || row.docs.ends_with('.'), "{row:?}");
        }
    }
}
