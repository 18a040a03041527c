//! What the table of quantities says of each.

/// What is to be said of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// its word in derivation files, cost tables, reports and JSON
    pub word: &'static str,
    /// its method in generated modules; after it stands the name of the point, frame or contact
    pub method: Option<&'static str>,
    /// the documentation of the method; `{}` stands for the point, frame or contact. Empty: the method is
    /// made of several quantities, or has documentation of its own
    pub docs: &'static str,
    /// what it is, over its equations
    pub title: &'static str,
    /// its symbol in equations
    pub symbol: &'static str,
    /// its unit, or in which units its entries are; empty where they are those of coordinates or speeds
    pub unit: &'static str,
    /// rows and columns
    pub shape: [Extent; 2],
    /// what rows and columns belong to
    pub axes: [Axes; 2],
    /// what the entries are
    pub entries: Entries,
    /// what it depends on, by definition
    pub takes: Takes,
    /// how the traits of all mechanisms offer it
    pub offer: Offer,
    /// the slice into which the traits write it: its name and what it holds, for messages
    pub slice: (&'static str, &'static str),
    /// whether it is among the equations that a reader of the paper looks for
    pub usual: bool,
}

/// How many rows or columns a quantity has in a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// so many
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

/// What rows or columns belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// no axes
    None,
    /// N.x, N.y, N.z
    Space,
    /// n, t, s: the contact basis
    Contact,
}

/// What the entries of a quantity are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entries {
    /// a number
    Scalar,
    /// numbers by rows and columns
    Numbers,
    /// the six of a symmetric 3 x 3 matrix: nn, nt, ns, tt, ts, ss
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
    /// lists one after the other
    Lists,
}

/// What a quantity depends on by definition, besides parameters, coordinates and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Takes {
    /// independent speeds
    pub speeds: bool,
    /// loads
    pub loads: bool,
    /// given rates of the independent speeds
    pub accelerations: bool,
    /// a direction
    pub tangent: bool,
}

/// How the traits `Mechanism` and `Contacts` offer a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// by a method that writes it into a slice
    Written,
    /// by a method that answers it, or that answers it with others
    Answered,
    /// by `Mechanism::quantity`, under its name
    Named,
    /// not: generated modules alone have it
    No,
}

/// A row in which nothing is said.
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
