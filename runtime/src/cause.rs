//! The causes of all errors without their numbers, in one table: what other languages know errors by.

use crate::table::table;

/// Why there is no answer: what the errors of this package have in common with those of other languages.
///
/// [`ImpactError::cause`](crate::ImpactError::cause) and its like give that of an error. New causes come last, so
/// that numbers stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Cause {
    /// The state is singular.
    SingularState,
    /// A number that went in, or the answer, is not finite.
    NotFinite,
    /// A slice has the wrong length.
    WrongLength,
    /// The model has no component of that name or number.
    UnknownName,
    /// The model does not determine the quantity.
    Undefined,
    /// A mass is not positive.
    ImpossibleMass,
    /// No body has the inertia.
    ImpossibleInertia,
    /// A divisor that depends on parameters alone is zero.
    SingularParameters,
    /// The coefficient of friction is negative.
    NegativeFriction,
    /// The coefficient of restitution is outside [0, 1].
    RestitutionOutOfRange,
    /// The bodies do not approach each other.
    NotApproaching,
    /// No mechanism has the reduced matrix.
    NotPositiveSemidefinite,
    /// No impulse changes the normal velocity.
    NoNormalMobility,
    /// There is no impact without collision.
    NoImpact,
    /// Rounding forbids an outcome.
    Inaccurate,
    /// No impulse ends the collision.
    Wedged,
    /// The budget of quadratures is spent.
    BudgetExceeded,
    /// An impact without collision follows.
    ImpactWithoutCollision,
    /// The contact jams.
    Jam,
    /// No mode of the contact fits.
    NoMode,
    /// No hypothesis of restitution has that name or number.
    UnknownLaw,
    /// A contact that can close has no surface: no mu, e or law.
    NoSurface,
    /// A dimension of a shape is not positive.
    ImpossibleSize,
}

table! { Cause
    SingularState "singular_state" "the state is singular",
    NotFinite "not_finite" "a number that went in, or the answer, is not finite",
    WrongLength "wrong_length" "there are too many or too few numbers",
    UnknownName "unknown_name" "the model has no component of that name or number",
    Undefined "undefined" "the model does not determine the quantity",
    ImpossibleMass "impossible_mass" "a mass is not positive",
    ImpossibleInertia "impossible_inertia" "no body has the inertia",
    SingularParameters "singular_parameters" "a divisor that depends on parameters alone is zero",
    NegativeFriction "negative_friction" "the coefficient of friction is negative",
    RestitutionOutOfRange "restitution_out_of_range" "the coefficient of restitution is not between 0 and 1",
    NotApproaching "not_approaching" "the bodies do not approach each other: there is no collision",
    NotPositiveSemidefinite "not_positive_semidefinite" "no mechanism has such a reduced matrix",
    NoNormalMobility "no_normal_mobility" "no impulse changes the normal velocity",
    NoImpact "no_impact" "finite forces exist: there is no impact without collision",
    Inaccurate "inaccurate" "the outcome would break a law of mechanics by rounding",
    Wedged "wedged" "the bodies wedge: no impulse ends the collision under this hypothesis",
    BudgetExceeded "budget_exceeded" "the collision needs more quadratures than allowed",
    ImpactWithoutCollision "impact_without_collision" "no finite force satisfies Coulomb's law: an impact without collision follows",
    Jam "jam" "the contact jams: the force grows without bound",
    NoMode "no_mode" "no mode of the contact fits",
    UnknownLaw "unknown_law" "no hypothesis of restitution has that name or number",
    NoSurface "no_surface" "a contact that can close has no surface",
    ImpossibleSize "impossible_size" "a dimension of a shape is not positive",
}
