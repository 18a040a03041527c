//! The table of quantities, the only place that states their properties. It determines the words and shapes
//! in derivation files, the headings of equations, the methods of generated modules with their arguments and
//! documentation, the routines of the interpreter, the quantities that the traits and the bindings offer by
//! name, and the reports of the tool.
//!
//! A new quantity needs a variant of its enum, a row here, and its derivation (`generator/derive/src/kane`).

use super::description::{Axes, Description, Entries, Extent, Offer, PLAIN, Takes};
use super::{ContactQuantity as C, PointQuantity as P, Quantity as Q};

/// The quantity of a row.
pub(super) fn key<K: Copy>(rows: &[(K, Description)], word: &str) -> Option<K> {
    rows.iter().find(|(_, row)| row.word == word).map(|(key, _)| *key)
}

/// The row of a quantity.
pub(super) fn find<K: PartialEq>(
    rows: &'static [(K, Description)],
    quantity: K,
) -> Option<&'static Description> {
    rows.iter().find(|(key, _)| *key == quantity).map(|(_, row)| row)
}

const STATE: Takes = Takes { speeds: false, loads: false, accelerations: false, tangent: false };
const MOVING: Takes = Takes { speeds: true, ..STATE };
const LOADED: Takes = Takes { loads: true, ..MOVING };

const FORCES: &str = "N for a speed in m/s, N*m for one in rad/s";
const SPACE: [Axes; 2] = [Axes::Space, Axes::None];
const BASIS: [Axes; 2] = [Axes::Contact, Axes::None];

/// A vector of the whole mechanism that is offered by name.
const VECTOR: Description = Description { axes: SPACE, takes: MOVING, offer: Offer::Named, ..PLAIN };

/// Quantities of the whole mechanism, in the order of the methods of the trait.
pub const WHOLE: &[(Q, Description)] = &[
    (
        Q::CoordinateRates,
        Description {
            word: "coordinate_rates",
            method: Some("coordinate_rates"),
            docs: "Rates q' of the generalised coordinates, in their units per second.",
            title: "Rates of the coordinates",
            symbol: "q",
            shape: [Extent::Coordinates, Extent::Count(1)],
            entries: Entries::RatesOfCoordinates,
            takes: MOVING,
            offer: Offer::Written,
            slice: ("rates", "the rates of the coordinates"),
            usual: true,
            ..PLAIN
        },
    ),
    (
        Q::Accelerations,
        Description {
            word: "accelerations",
            method: Some("accelerations"),
            docs: "Rates u' of the independent speeds without contact forces, in the units of the speeds per second.",
            title: "Accelerations",
            symbol: "a",
            shape: [Extent::Speeds, Extent::Count(1)],
            entries: Entries::RatesOfSpeeds,
            takes: LOADED,
            offer: Offer::Written,
            slice: ("accelerations", "the accelerations"),
            ..PLAIN
        },
    ),
    (
        Q::DependentSpeeds,
        Description {
            word: "dependent_speeds",
            method: Some("dependent_speeds"),
            docs: "Dependent generalised speeds, which the velocity constraints determine from the independent ones.",
            title: "Dependent speeds",
            symbol: "u",
            shape: [Extent::DependentSpeeds, Extent::Count(1)],
            entries: Entries::DependentSpeeds,
            takes: MOVING,
            offer: Offer::Written,
            slice: ("speeds", "the dependent speeds"),
            usual: true,
            ..PLAIN
        },
    ),
    (
        Q::DependentAccelerations,
        Description {
            word: "dependent_accelerations",
            method: Some("dependent_accelerations"),
            docs: "Rates of the dependent speeds without contact forces, in the units of the speeds per second.",
            title: "Rates of the dependent speeds",
            symbol: "a",
            shape: [Extent::DependentSpeeds, Extent::Count(1)],
            entries: Entries::RatesOfDependentSpeeds,
            takes: LOADED,
            offer: Offer::Written,
            slice: ("accelerations", "the dependent accelerations"),
            ..PLAIN
        },
    ),
    (
        Q::MassMatrix,
        Description {
            word: "mass_matrix",
            method: Some("mass_matrix"),
            docs: "Mass matrix M of the independent speeds (rows and columns in their order), symmetric and positive definite: M u' = forcing, and u.M u/2 is in J.",
            title: "Mass matrix",
            symbol: "M",
            unit: "kg for two speeds in m/s, kg*m^2 for two in rad/s, kg*m for one of each",
            shape: [Extent::Speeds, Extent::Speeds],
            offer: Offer::Written,
            slice: ("matrix", "the mass matrix"),
            usual: true,
            ..PLAIN
        },
    ),
    (
        Q::Forcing,
        Description {
            word: "forcing",
            method: Some("forcing"),
            docs: "Forcing, the right side of M u' = forcing: loads, and inertia terms without u'. An entry times its speed is in W.",
            title: "Forcing: M du/dt = F",
            symbol: "F",
            unit: FORCES,
            shape: [Extent::Speeds, Extent::Count(1)],
            takes: LOADED,
            offer: Offer::Written,
            slice: ("forcing", "the forcing"),
            usual: true,
            ..PLAIN
        },
    ),
    (
        Q::InverseDynamics,
        Description {
            word: "inverse_dynamics",
            method: Some("inverse_dynamics"),
            docs: "Generalised forces that must be added to the loads so that the independent speeds have the rates `acceleration`: M u' - forcing. An entry times its speed is in W.",
            title: "Inverse dynamics",
            symbol: "Q",
            unit: FORCES,
            shape: [Extent::Speeds, Extent::Count(1)],
            takes: Takes { accelerations: true, ..LOADED },
            offer: Offer::Written,
            slice: ("forces", "the generalised forces"),
            ..PLAIN
        },
    ),
    (
        Q::KineticEnergy,
        Description {
            word: "kinetic_energy",
            method: Some("kinetic_energy"),
            docs: "Kinetic energy of the motion relative to N, in J.",
            title: "Kinetic energy",
            symbol: "K",
            unit: "J",
            shape: [Extent::Count(1), Extent::Count(1)],
            entries: Entries::Scalar,
            takes: MOVING,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        Q::PotentialEnergy,
        Description {
            word: "potential_energy",
            method: Some("potential_energy"),
            docs: "Potential energy of gravity and springs, in J.",
            title: "Potential energy",
            symbol: "W",
            unit: "J",
            shape: [Extent::Count(1), Extent::Count(1)],
            entries: Entries::Scalar,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        Q::ConfigurationResidual,
        Description {
            word: "configuration_residual",
            method: Some("configuration_residual"),
            docs: "Left side minus right side of the configuration equations; zero where the loops are closed.",
            title: "Configuration equations",
            symbol: "c",
            shape: [Extent::DependentCoordinates, Extent::Count(1)],
            offer: Offer::Answered,
            slice: ("residual", "the residual of the configuration equations"),
            ..PLAIN
        },
    ),
    (
        Q::ConfigurationJacobian,
        Description {
            word: "configuration_jacobian",
            method: Some("configuration_jacobian"),
            docs: "Derivatives of the configuration equations (rows) with respect to the dependent coordinates (columns).",
            title: "Their derivatives by the dependent coordinates",
            symbol: "J",
            shape: [Extent::DependentCoordinates, Extent::DependentCoordinates],
            offer: Offer::Answered,
            slice: ("jacobian", "the derivatives of the configuration equations"),
            ..PLAIN
        },
    ),
    (
        Q::Momentum,
        Description {
            word: "momentum",
            method: Some("momentum"),
            docs: "Momentum of all bodies relative to N along N.x, N.y, N.z, in kg m/s.",
            title: "Momentum along N.x, N.y, N.z",
            symbol: "P",
            unit: "kg*m/s",
            ..VECTOR
        },
    ),
    (
        Q::AngularMomentum,
        Description {
            word: "angular_momentum",
            method: Some("angular_momentum"),
            docs: "Angular momentum of all bodies about O along N.x, N.y, N.z, in kg m^2/s. About a point at r it is less by r x `momentum`.",
            title: "Angular momentum about O along N.x, N.y, N.z",
            symbol: "H",
            unit: "kg*m^2/s",
            ..VECTOR
        },
    ),
    (
        Q::CentralAngularMomentum,
        Description {
            word: "central_angular_momentum",
            method: Some("central_angular_momentum"),
            docs: "Angular momentum of all bodies about their mass centre along N.x, N.y, N.z, in kg m^2/s.",
            title: "Angular momentum about the mass centre along N.x, N.y, N.z",
            symbol: "h",
            unit: "kg*m^2/s",
            ..VECTOR
        },
    ),
    (
        Q::MassCentrePosition,
        Description {
            word: "mass_centre_position",
            method: Some("mass_centre_position"),
            docs: "Position of the mass centre of all bodies from O along N.x, N.y, N.z, in m.",
            title: "Position of the mass centre along N.x, N.y, N.z",
            symbol: "r",
            unit: "m",
            takes: STATE,
            ..VECTOR
        },
    ),
    (
        Q::MassCentreVelocity,
        Description {
            word: "mass_centre_velocity",
            method: Some("mass_centre_velocity"),
            docs: "Velocity of the mass centre of all bodies in N along N.x, N.y, N.z, in m/s.",
            title: "Velocity of the mass centre along N.x, N.y, N.z",
            symbol: "v",
            unit: "m/s",
            ..VECTOR
        },
    ),
    (
        Q::StateTangent,
        Description {
            word: "state_tangent",
            method: Some("state_tangent"),
            docs: "Derivative of the rates of the independent coordinates and speeds along a direction: a linear combination of the columns of `linearise`.",
            title: "Linearised rates",
            symbol: "l",
            shape: [Extent::States, Extent::Count(1)],
            takes: Takes { tangent: true, ..LOADED },
            ..PLAIN
        },
    ),
    (
        Q::AccelerationsDerivatives,
        Description {
            word: "accelerations_derivatives",
            method: Some("accelerations_derivatives"),
            docs: "Rates u' of the independent speeds and their derivatives. Dependent coordinates and speeds follow the independent ones; parameters and time are constant. The value is that of `accelerations` up to rounding.",
            title: "Accelerations, and their derivatives",
            symbol: "A",
            shape: [Extent::Speeds, Extent::ValueAndDirections],
            entries: Entries::ValueAndDerivatives,
            takes: LOADED,
            ..PLAIN
        },
    ),
    (
        Q::InverseDynamicsDerivatives,
        Description {
            word: "inverse_dynamics_derivatives",
            method: Some("inverse_dynamics_derivatives"),
            docs: "The value of `inverse_dynamics` (up to rounding) and its derivatives at constant rates `acceleration` of the independent speeds; its derivative with respect to these rates is `mass_matrix`. Dependent coordinates and speeds follow the independent ones; parameters and time are constant. At zero rates the value is minus `forcing`.",
            title: "Inverse dynamics, and its derivatives",
            symbol: "Q",
            shape: [Extent::Speeds, Extent::ValueAndDirections],
            entries: Entries::ValueAndDerivatives,
            takes: Takes { accelerations: true, ..LOADED },
            ..PLAIN
        },
    ),
    (
        Q::RatesDerivatives,
        Description {
            word: "rates_derivatives",
            method: Some("coordinate_rates_derivatives"),
            docs: "Derivatives of the rates of the independent coordinates (rows) with respect to the independent coordinates, the independent speeds and the named inputs (columns).",
            title: "Derivatives of the rates of the coordinates",
            symbol: "L",
            shape: [Extent::IndependentCoordinates, Extent::Directions],
            takes: MOVING,
            ..PLAIN
        },
    ),
    (
        Q::ConstraintResidual,
        Description {
            word: "constraint_residual",
            method: Some("constraint_residual"),
            docs: "Left side minus right side of the velocity constraints with the dependent speeds inserted; zero up to rounding.",
            title: "Velocity constraints",
            symbol: "r",
            shape: [Extent::DependentSpeeds, Extent::Count(1)],
            takes: MOVING,
            ..PLAIN
        },
    ),
];

/// Quantities of a contact.
pub const CONTACT: &[(C, Description)] = &[
    (
        C::Normal,
        Description {
            word: "normal",
            title: "normal along N.x, N.y, N.z",
            symbol: "n",
            axes: SPACE,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::First,
        Description {
            word: "first",
            title: "first tangential axis along N.x, N.y, N.z",
            symbol: "t",
            axes: SPACE,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Second,
        Description {
            word: "second",
            title: "second tangential axis along N.x, N.y, N.z",
            symbol: "s",
            axes: SPACE,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Gap,
        Description {
            word: "gap",
            method: Some("gap"),
            docs: "Gap (distance of the striking point from what it strikes), in m, at {}.",
            title: "gap",
            symbol: "d",
            unit: "m",
            shape: [Extent::Count(1), Extent::Count(1)],
            entries: Entries::Scalar,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Validity,
        Description {
            word: "validity",
            method: Some("validity"),
            docs: "Validity (how far the place of contact is within the faces and edges that touch; the contact ends where it falls below 0), in m, at {}.",
            title: "validity",
            symbol: "i",
            unit: "m",
            shape: [Extent::Count(1), Extent::Count(1)],
            entries: Entries::Scalar,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Clearance,
        Description {
            word: "clearance",
            title: "clearance of both shapes",
            symbol: "c",
            unit: "m",
            shape: [Extent::Count(1), Extent::Count(1)],
            entries: Entries::Scalar,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        C::Velocity,
        Description {
            word: "velocity",
            method: Some("contact_velocity"),
            docs: "Velocity of the striking point relative to what is struck, along the contact basis (rows: normal, first, second), in m/s, at {}.",
            title: "relative velocity along n, t, s",
            symbol: "v",
            unit: "m/s",
            axes: BASIS,
            takes: MOVING,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::PartialVelocities,
        Description {
            word: "partial_velocities",
            method: Some("partial_velocities"),
            docs: "Partial velocities V_n, V_t, V_s of the relative velocity along the contact basis (rows) for the independent speeds (columns) at {}.",
            title: "partial velocities: rows n, t, s",
            symbol: "V",
            shape: [Extent::Count(3), Extent::Speeds],
            axes: BASIS,
            offer: Offer::Written,
            slice: ("partial_velocities", "the partial velocities"),
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Response,
        Description {
            word: "response",
            method: Some("response"),
            docs: "Response M^-1 V^T: change of the independent speeds (rows) per N s of impulse along the contact basis (columns), or of their rates per N of force, at {}.",
            title: "change of the speeds per unit impulse",
            symbol: "R",
            shape: [Extent::Speeds, Extent::Count(3)],
            axes: [Axes::None, Axes::Contact],
            offer: Offer::Written,
            slice: ("response", "the response"),
            ..PLAIN
        },
    ),
    (
        C::FreeAcceleration,
        Description {
            word: "free_acceleration",
            method: Some("free_acceleration"),
            docs: "Free acceleration: time derivatives of the three components of the contact velocity (rows: normal, first, second) without contact forces and at constant named inputs, in m/s^2, at {}.",
            title: "rates of the relative velocity without contact forces, along n, t, s",
            symbol: "b",
            unit: "m/s^2",
            axes: BASIS,
            takes: LOADED,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        C::Remainder,
        Description {
            word: "remainder",
            method: Some("remainder_velocity"),
            docs: "The part of the relative velocity that prescribed motion causes, along the contact basis, in m/s, at {}.",
            title: "velocity that depends on no speed, along n, t, s",
            symbol: "r",
            unit: "m/s",
            axes: BASIS,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::Reduced,
        Description {
            word: "reduced",
            method: Some("reduced_matrix"),
            title: "reduced matrix along n, t, s",
            symbol: "m",
            unit: "1/kg",
            shape: [Extent::Count(6), Extent::Count(1)],
            entries: Entries::Symmetric,
            offer: Offer::Answered,
            usual: true,
            ..PLAIN
        },
    ),
    (
        C::DependentResponse,
        Description {
            word: "dependent_response",
            title: "change of the dependent speeds per unit impulse",
            symbol: "D",
            shape: [Extent::DependentSpeeds, Extent::Count(3)],
            axes: [Axes::None, Axes::Contact],
            ..PLAIN
        },
    ),
    (
        C::PrescribedWork,
        Description {
            word: "prescribed_work",
            title: "work of prescribed motion per unit impulse",
            symbol: "w",
            unit: "m/s",
            axes: BASIS,
            ..PLAIN
        },
    ),
    (
        C::AngularVelocity,
        Description {
            word: "angular_velocity",
            method: Some("relative_angular_velocity"),
            docs: "Angular velocity of what strikes relative to what is struck, along the contact basis (rows: normal, first, second), in rad/s, at {}.",
            title: "relative angular velocity along n, t, s",
            symbol: "o",
            unit: "rad/s",
            axes: BASIS,
            takes: MOVING,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        C::PartialAngularVelocities,
        Description {
            word: "partial_angular_velocities",
            method: Some("partial_angular_velocities"),
            docs: "Partial velocities of the relative angular velocity along the contact basis (rows) for the independent speeds (columns) at {}.",
            title: "partial velocities of the relative angular velocity: rows n, t, s",
            symbol: "O",
            shape: [Extent::Count(3), Extent::Speeds],
            axes: BASIS,
            offer: Offer::Written,
            slice: ("partial_velocities", "the partial angular velocities"),
            ..PLAIN
        },
    ),
    (
        C::FreeAngularAcceleration,
        Description {
            word: "free_angular_acceleration",
            method: Some("free_angular_acceleration"),
            docs: "Time derivatives of the three components of the relative angular velocity (rows: normal, first, second) without contact forces and at constant named inputs, in rad/s^2, at {}.",
            title: "rates of the relative angular velocity without contact forces, along n, t, s",
            symbol: "a",
            unit: "rad/s^2",
            axes: BASIS,
            takes: LOADED,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        C::AngularResponse,
        Description {
            word: "angular_response",
            method: Some("angular_response"),
            docs: "Change of the independent speeds (rows) per N m s of angular impulse along the contact basis (columns), or of their rates per N m of torque, at {}.",
            title: "change of the speeds per unit angular impulse",
            symbol: "S",
            shape: [Extent::Speeds, Extent::Count(3)],
            axes: [Axes::None, Axes::Contact],
            offer: Offer::Written,
            slice: ("response", "the angular response"),
            ..PLAIN
        },
    ),
    (
        C::Tangent,
        Description {
            word: "tangent",
            method: Some("contact_tangent"),
            title: "derivatives of velocity, reduced matrix, response and gap",
            symbol: "l",
            shape: [Extent::Collision, Extent::Count(1)],
            entries: Entries::Lists,
            takes: Takes { tangent: true, ..MOVING },
            ..PLAIN
        },
    ),
    (
        C::Derivatives,
        Description {
            word: "derivatives",
            method: Some("contact_derivatives"),
            title: "velocity, reduced matrix, response and gap (rows) with their derivatives",
            symbol: "l",
            shape: [Extent::Collision, Extent::ValueAndDirections],
            takes: MOVING,
            ..PLAIN
        },
    ),
];

/// Quantities of a point.
pub const POINT: &[(P, Description)] = &[
    (
        P::Position,
        Description {
            word: "position",
            method: Some("position"),
            docs: "Position of {} from O along N.x, N.y, N.z, in m.",
            title: "position along N.x, N.y, N.z",
            symbol: "p",
            unit: "m",
            axes: SPACE,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        P::Velocity,
        Description {
            word: "velocity",
            method: Some("velocity"),
            docs: "Velocity of {} in N along N.x, N.y, N.z, in m/s.",
            title: "velocity along N.x, N.y, N.z",
            symbol: "v",
            unit: "m/s",
            axes: SPACE,
            takes: MOVING,
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
    (
        P::Jacobian,
        Description {
            word: "jacobian",
            method: Some("jacobian"),
            docs: "Partial velocities of {} along N.x, N.y, N.z (rows) for the independent speeds (columns).",
            title: "partial velocities along N.x, N.y, N.z",
            symbol: "V",
            shape: [Extent::Count(3), Extent::Speeds],
            axes: SPACE,
            offer: Offer::Written,
            slice: ("jacobian", "the partial velocities"),
            ..PLAIN
        },
    ),
    (
        P::Acceleration,
        Description {
            word: "acceleration",
            method: Some("acceleration"),
            docs: "Acceleration of {} in N along N.x, N.y, N.z, in m/s^2, for given rates `acceleration` of the independent speeds, such as those of `accelerations` or those under contact forces.",
            title: "acceleration along N.x, N.y, N.z",
            symbol: "a",
            unit: "m/s^2",
            axes: SPACE,
            takes: Takes { accelerations: true, ..MOVING },
            offer: Offer::Answered,
            ..PLAIN
        },
    ),
];

/// The orientation of a frame.
pub const ORIENTATION: Description = Description {
    word: "orientation",
    method: Some("orientation"),
    docs: "Orientation of {}: the columns are its axes x, y, z along N.x, N.y, N.z.",
    title: "its axes in N",
    symbol: "R",
    shape: [Extent::Count(3), Extent::Count(3)],
    axes: [Axes::Space, Axes::Space],
    offer: Offer::Answered,
    ..PLAIN
};
