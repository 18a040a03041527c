//! The columns of the table of quantities.

/// The properties of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// its word in derivation files, cost tables, reports and JSON
    pub word: &'static str,
    /// its method in generated modules, a prefix to the name of a point, frame or contact
    pub method: Option<&'static str>,
    /// the documentation of the method; `{}` stands for the point, frame or contact. Empty: the method
    /// returns several quantities, or has documentation elsewhere
    pub docs: &'static str,
    /// title of its equations
    pub title: &'static str,
    /// its symbol in equations
    pub symbol: &'static str,
    /// its unit, or the units of its entries; empty if they are those of coordinates or speeds
    pub unit: &'static str,
    /// rows and columns
    pub shape: [Extent; 2],
    /// the basis of its rows and columns
    pub axes: [Axes; 2],
    /// the meaning of its entries
    pub entries: Entries,
    /// the inputs that it depends on, by definition
    pub takes: Takes,
    /// how the traits of all mechanisms offer it
    pub offer: Offer,
    /// the slice argument of the traits: its name, and its description in messages
    pub slice: (&'static str, &'static str),
    /// whether it is among the equations that a reader of the paper looks for
    pub usual: bool,
}

impl Description {
    /// Whether the number of entries depends on the mechanism.
    pub fn grows(&self) -> bool {
        self.shape.iter().any(|extent| !matches!(extent, Extent::Count(_)))
    }
}

/// How many rows or columns a quantity has in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// a fixed number
    Count(usize),
    /// n: coordinates
    Coordinates,
    /// coordinates that no configuration equation determines
    IndependentCoordinates,
    /// c: coordinates that configuration equations determine
    DependentCoordinates,
    /// p: independent speeds
    Speeds,
    /// d: dependent speeds
    DependentSpeeds,
    /// independent coordinates and speeds
    States,
    /// independent coordinates, independent speeds and named inputs
    Directions,
    /// a value and its derivatives in these directions
    ValueAndDirections,
    /// velocity, reduced matrix, response and, where there is one, gap of a contact
    Collision,
}

/// The basis of rows or columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// no basis
    None,
    /// N.x, N.y, N.z
    Space,
    /// n, t, s: the contact basis
    Contact,
}

/// The meaning of the entries of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entries {
    /// a single number
    Scalar,
    /// numbers by rows and columns
    Numbers,
    /// the six entries of a symmetric 3 x 3 matrix: nn, nt, ns, tt, ts, ss
    Symmetric,
    /// one per coordinate: its rate
    RatesOfCoordinates,
    /// one per independent speed: its rate
    RatesOfSpeeds,
    /// one per dependent speed
    DependentSpeeds,
    /// one per dependent speed: its rate
    RatesOfDependentSpeeds,
    /// in the first column the value, in the others its derivatives
    ValueAndDerivatives,
    /// several lists, one after the other
    Lists,
}

/// The inputs on which a quantity depends by definition, besides parameters, coordinates and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Takes {
    /// independent speeds
    pub speeds: bool,
    /// loads
    pub loads: bool,
    /// given rates of the independent speeds
    pub accelerations: bool,
    /// the direction of a linearisation
    pub tangent: bool,
}

/// How the traits `Mechanism` and `Contacts` offer a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// by a method that writes it into a slice
    Written,
    /// by a method that returns it, alone or with others
    Answered,
    /// by `Mechanism::quantity`, by its name
    Named,
    /// only generated modules have it
    No,
}

/// A row with empty entries, as a base for others.
pub const PLAIN: Description = Description {
    word: "",
    method: None,
    docs: "",
    title: "",
    symbol: "",
    unit: "",
    shape: [Extent::Count(3), Extent::Count(1)],
    axes: [Axes::None, Axes::None],
    entries: Entries::Numbers,
    takes: Takes { speeds: false, loads: false, accelerations: false, tangent: false },
    offer: Offer::No,
    slice: ("", ""),
    usual: false,
};
