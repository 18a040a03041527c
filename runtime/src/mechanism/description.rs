//! Names, numbers and units of a mechanism's components: parameters, coordinates, speeds, inputs, points,
//! frames and contacts.

/// The kinds of components of a mechanism that have a name and a number, counted from 0 in the order of the
/// model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ComponentKind {
    /// parameters that can be changed at run time; those that the model declares `fixed` are not counted
    Parameter,
    /// generalised coordinates, independent and dependent ones
    Coordinate,
    /// dependent coordinates alone, which the configuration equations determine
    DependentCoordinate,
    /// independent generalised speeds
    Speed,
    /// dependent generalised speeds, which the constraints determine
    DependentSpeed,
    /// named inputs
    Input,
    /// points; the first is O
    Point,
    /// frames; the first is N
    Frame,
    /// contacts
    Contact,
    /// quantities of the whole mechanism that [`Mechanism::quantity`](crate::Mechanism::quantity) computes: the
    /// momenta, and position and velocity of the mass centre, as far as the mechanism has them
    Quantity,
}

impl ComponentKind {
    /// Every kind, in the order of the variants.
    pub const ALL: &'static [Self] = &[
        Self::Parameter,
        Self::Coordinate,
        Self::DependentCoordinate,
        Self::Speed,
        Self::DependentSpeed,
        Self::Input,
        Self::Point,
        Self::Frame,
        Self::Contact,
        Self::Quantity,
    ];

    /// The English noun for one of the kind, for messages.
    pub const fn noun(self) -> &'static str {
        // Whoever is sent here by the compiler for a new kind: it also belongs into `ALL`, just above.
        match self {
            Self::Parameter => "parameter",
            Self::Coordinate => "coordinate",
            Self::DependentCoordinate => "dependent coordinate",
            Self::Speed => "speed",
            Self::DependentSpeed => "dependent speed",
            Self::Input => "input",
            Self::Point => "point",
            Self::Frame => "frame",
            Self::Contact => "contact",
            Self::Quantity => "quantity",
        }
    }
}

/// Name and unit of one component of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Component<'a> {
    /// the name, as the model spells it
    pub name: &'a str,
    /// the unit that the model declares, as `kg*m^2`; `1` for a number without unit, empty for a point,
    /// frame or contact
    pub unit: &'a str,
}
