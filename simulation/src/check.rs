//! Checks options, surfaces and start state before a motion begins.

use hodograph::{ComponentKind, Contacts, State, Surface};

use crate::pair::Pair;
use crate::{ContactLaw, Drive, ErrorKind, Options, SimulationError};

/// Below this the roundings of a step exceed what is asked for, and no step is short enough.
const LEAST_TOLERANCE: f64 = 1e-16;

/// Checks options and state, and gives each contact its surfaces; a contact without a gap has none.
pub(crate) fn check(
    mechanism: &dyn Contacts<f64>,
    state: &State<'_>,
    options: &Options,
) -> Result<Vec<Option<Pair>>, SimulationError> {
    let error =
        |contact: Option<usize>, kind: ErrorKind| SimulationError::new(mechanism, state.time, contact, kind);
    let bad = |message: String| Err(error(None, ErrorKind::BadOption(message)));
    for (what, value) in [
        ("the relative tolerance", options.relative_tolerance),
        ("the absolute tolerance", options.absolute_tolerance),
        ("the greatest step", options.max_step),
    ] {
        if value.is_nan() || value <= 0.0 {
            return bad(format!("{what} is {value}: it must be positive"));
        }
    }
    if options.relative_tolerance < LEAST_TOLERANCE {
        return bad(format!(
            "the relative tolerance is {:e}: doubles have 16 digits, and the least is {LEAST_TOLERANCE:e}",
            options.relative_tolerance
        ));
    }
    let rising = |pair: &[f64]| pair[0] < pair[1];
    if !options.breaks.iter().all(|time| time.is_finite()) || !options.breaks.windows(2).all(rising) {
        return bad("the times at which inputs jump must be finite and rise".to_owned());
    }
    if let Drive::Sampled { period, .. } = &options.drive
        && !(period.is_finite() && *period > 0.0)
    {
        return bad(format!("the sampling time is {period}: it must be positive"));
    }
    for (kind, have) in [
        (ComponentKind::Coordinate, state.coordinates.len()),
        (ComponentKind::Speed, state.speeds.len()),
        (ComponentKind::Input, state.inputs.len()),
    ] {
        let count = mechanism.count(kind);
        if have != count {
            return bad(format!("the state has {have} numbers for {count} {}s", kind.noun()));
        }
    }
    let numbers = [state.coordinates, state.speeds, state.inputs].concat();
    if let Some(value) = numbers.iter().find(|value| !value.is_finite()) {
        return bad(format!("a number of the start state is {value}: it must be finite"));
    }
    let count = mechanism.count(ComponentKind::Contact);
    for (contact, surface) in &options.surfaces {
        if *contact >= count {
            return bad(format!(
                "there is a surface for contact {contact}, but the mechanism has {count} contacts"
            ));
        }
        if let Some(message) = wrong(surface) {
            return Err(error(Some(*contact), ErrorKind::BadOption(message)));
        }
    }
    if let Some(surface) = &options.surface
        && let Some(message) = wrong(surface)
    {
        return bad(message);
    }
    if let Some((contact, _)) = options.laws.iter().find(|(contact, _)| *contact >= count) {
        return bad(format!("there is a law for contact {contact}, but the mechanism has {count} contacts"));
    }
    for &(contact, stiffness) in &options.stiffness {
        if contact >= count {
            return bad(format!(
                "there is a stiffness for contact {contact}, but the mechanism has {count} contacts"
            ));
        }
        if !(stiffness.is_finite() && stiffness > 0.0) {
            let message = format!("its stiffness is {stiffness}: it must be finite and positive");
            return Err(error(Some(contact), ErrorKind::BadOption(message)));
        }
    }
    let mut surfaces: Vec<Option<Pair>> = vec![None; count];
    for (contact, slot) in surfaces.iter_mut().enumerate() {
        let fault = |error| SimulationError::new(mechanism, state.time, None, ErrorKind::State(error));
        let gap = mechanism.gap(contact, state).map_err(fault)?;
        // A contact without a gap cannot be seen to close.
        if gap.is_none() {
            continue;
        }
        let own = options.surfaces.iter().rev().find(|(index, _)| *index == contact);
        let given = own.map(|(_, surface)| *surface).or(options.surface);
        let Some(surface) = given.or_else(|| mechanism.surface(contact)) else {
            return Err(error(
                Some(contact),
                ErrorKind::BadOption(
                    "no surface is given for it, and the model states none: it needs mu, e and a law"
                        .to_owned(),
                ),
            ));
        };
        let own = options.laws.iter().rev().find(|(index, _)| *index == contact);
        let law = match own.map(|(_, law)| law).or(options.law.as_ref()) {
            Some(law) => law.clone(),
            None => ContactLaw::stated(&mechanism.stated_law(contact))
                .map_err(|message| error(Some(contact), ErrorKind::BadOption(message)))?,
        };
        let ends = mechanism.validity(contact, state).map_err(fault)?.is_some();
        let pair = Pair { surface, law, ends };
        pair.check().map_err(|message| error(Some(contact), ErrorKind::BadOption(message)))?;
        *slot = Some(pair);
    }
    Ok(surfaces)
}

/// What is wrong with a surface.
fn wrong(surface: &Surface<f64>) -> Option<String> {
    let Surface { mu, e, .. } = surface;
    if !(mu.is_finite() && *mu >= 0.0) {
        return Some(format!("the coefficient of friction is {mu}: it must be finite and not negative"));
    }
    if !(*e >= 0.0 && *e <= 1.0) {
        return Some(format!("the coefficient of restitution is {e}: it must lie between 0 and 1"));
    }
    None
}
