//! The places of the fields of a model function's argument: `two_sleds_collide(named_struct('q3', 0.8, 'mu',
//! 0.5, ..))`.

use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::common::{Result, plan_err};
use hodograph::{ComponentKind, Contacts as _, Mechanism};
use hodograph_interpreter::InterpretedMechanism;

use super::{is_number, is_text};

/// The meaning of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// time, s
    Time,
    /// coordinate with this index
    Coordinate(usize),
    /// independent speed with this index
    Speed(usize),
    /// parameter with this index
    Parameter(usize),
    /// named input with this index
    Input(usize),
    /// coefficient of friction
    Mu,
    /// coefficient of restitution
    E,
    /// hypothesis of restitution
    Law,
    /// name of the contact
    Contact,
    /// final time of a motion, s
    Until,
    /// tolerance of the integration
    Tolerance,
    /// static coefficient of friction
    MuStatic,
    /// coefficient of friction in impacts
    MuImpact,
    /// lever arm of rolling friction, m
    Rolling,
    /// lever arm of spinning friction, m
    Spinning,
    /// law of sliding friction, such as `stribeck(0.01)`
    Sliding,
    /// law of restitution, such as `power(1, 0.25)`
    Restitution,
}

/// The fields that belong to a motion, not to a model.
const MOTION: [(&str, Place); 11] = [
    ("until", Place::Until),
    ("mu", Place::Mu),
    ("e", Place::E),
    ("law", Place::Law),
    ("mu_static", Place::MuStatic),
    ("mu_impact", Place::MuImpact),
    ("rolling", Place::Rolling),
    ("spinning", Place::Spinning),
    ("sliding", Place::Sliding),
    ("restitution", Place::Restitution),
    ("tolerance", Place::Tolerance),
];

impl Place {
    /// Whether the field holds text.
    pub fn is_text(self) -> bool {
        matches!(self, Self::Law | Self::Contact | Self::Sliding | Self::Restitution)
    }
}

/// The fields that belong to a collision, not to a model.
const SURFACE: [(&str, Place); 4] =
    [("mu", Place::Mu), ("e", Place::E), ("law", Place::Law), ("contact", Place::Contact)];

/// All fields of a function of this mechanism. A component of the model with the name of a field of the
/// collision, or `time`, gets the prefix `model_`.
pub fn known(mechanism: &InterpretedMechanism, collision: bool) -> Vec<(String, Place)> {
    known_with(mechanism, if collision { SURFACE.as_slice() } else { &[] })
}

/// All fields of the motions of this mechanism.
pub fn known_of_motions(mechanism: &InterpretedMechanism) -> Vec<(String, Place)> {
    known_with(mechanism, &MOTION)
}

fn known_with(mechanism: &InterpretedMechanism, surface: &[(&str, Place)]) -> Vec<(String, Place)> {
    let mut all: Vec<(String, Place)> =
        surface.iter().map(|&(name, place)| (name.to_owned(), place)).collect();
    all.push(("time".to_owned(), Place::Time));
    let reserved = all.len();
    type PlaceOf = fn(usize) -> Place;
    let kinds: [(ComponentKind, PlaceOf); 4] = [
        (ComponentKind::Coordinate, Place::Coordinate),
        (ComponentKind::Speed, Place::Speed),
        (ComponentKind::Input, Place::Input),
        (ComponentKind::Parameter, Place::Parameter),
    ];
    for (kind, place) in kinds {
        for index in 0..Mechanism::count(mechanism, kind) {
            let name = Mechanism::component(mechanism, kind, index).map_or("", |component| component.name);
            let taken = all.iter().take(reserved).any(|(reserved, _)| reserved == name);
            all.push((if taken { format!("model_{name}") } else { name.to_owned() }, place(index)));
        }
    }
    all
}

/// The place of each field of an argument.
///
/// # Errors
///
/// A field is unknown, given twice, of a wrong type, or missing.
pub fn resolve(
    function: &str,
    mechanism: &InterpretedMechanism,
    known: &[(String, Place)],
    collision: bool,
    given: &Fields,
) -> Result<Vec<Place>> {
    let places = places_of(function, known, given)?;
    // missing fields are those of the model, if it states the surface of every contact
    let mut contacts = 0..Mechanism::count(mechanism, ComponentKind::Contact);
    let open = contacts.find(|&contact| collision && mechanism.surface(contact).is_none());
    for (name, place) in SURFACE.iter().take(3) {
        if let Some(open) = open
            && !places.contains(place)
        {
            let contact = Mechanism::component(mechanism, ComponentKind::Contact, open);
            let contact = contact.map_or("", |contact| contact.name);
            return plan_err!(
                "contact {contact} has no surface: {function} needs the field `{name}`: a collision has 'mu', 'e' and 'law' ('newton', 'poisson' or 'stronge') unless the model states \
                 the `surface` of its contacts, and the state where it differs from the initial one of the model"
            );
        }
    }
    Ok(places)
}

/// The place of each field of the argument of a motion.
///
/// # Errors
///
/// Those of [`resolve`].
pub fn resolve_motion(function: &str, known: &[(String, Place)], given: &Fields) -> Result<Vec<Place>> {
    let places = places_of(function, known, given)?;
    if !places.contains(&Place::Until) {
        return plan_err!("{function} needs the field `until`: when the motion ends, s");
    }
    Ok(places)
}

fn places_of(function: &str, known: &[(String, Place)], given: &Fields) -> Result<Vec<Place>> {
    let mut places = Vec::with_capacity(given.len());
    for field in given {
        let Some(&(_, place)) = known.iter().find(|(name, _)| name == field.name()) else {
            let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
            return plan_err!(
                "{function}: there is no parameter, number of the state or field `{}`: there are: {}",
                field.name(),
                names.join(", ")
            );
        };
        if places.contains(&place) {
            return plan_err!("{function}: the field `{}` is given twice", field.name());
        }
        check(function, field, place)?;
        places.push(place);
    }
    Ok(places)
}

fn check(function: &str, field: &Field, place: Place) -> Result<()> {
    let given: &DataType = field.data_type();
    let text = place.is_text();
    if if text { is_text(given) } else { is_number(given) } {
        return Ok(());
    }
    let noun = if text { "text" } else { "a number" };
    plan_err!("{function}: the field `{}` is {given}, it must be {noun}", field.name())
}
