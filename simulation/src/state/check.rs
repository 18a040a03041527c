//! Checks options, surfaces and start state before a motion begins.

use hodograph::{Cause, ComponentKind, Contacts, ImpactError, State, StateError, Surface};

use crate::closed::pair::Pair;
use crate::{ContactLaw, Drive, ErrorKind, Options, Samples, SimulationError};

/// Checks options and state, and returns the surfaces of each contact; a contact without a gap has none.
pub(crate) fn check(
    mechanism: &dyn Contacts<f64>,
    state: &State<'_>,
    options: &Options,
) -> Result<Vec<Option<Pair>>, SimulationError> {
    let error =
        |contact: Option<usize>, kind: ErrorKind| SimulationError::new(mechanism, state.time, contact, kind);
    let bad = |message: String| Err(error(None, ErrorKind::BadOption(message)));
    if let Err(message) = Options::check_tolerance(options.relative_tolerance) {
        return bad(message);
    }
    for (what, value) in
        [("the absolute tolerance", options.absolute_tolerance), ("the greatest step", options.max_step)]
    {
        if value.is_nan() || value <= 0.0 {
            return bad(format!("{what} is {value}: it must be positive"));
        }
    }
    if options.absolute_tolerance.is_infinite() {
        return bad("the absolute tolerance is inf: it must be finite".to_owned());
    }
    if !state.time.is_finite() {
        let message = format!("the time of the start is {}: it must be finite", state.time);
        return Err(error(None, ErrorKind::Argument { cause: Cause::NotFinite, message }));
    }
    let rising = |pair: &[f64]| pair[0] < pair[1];
    if !options.breaks.iter().all(|time| time.is_finite()) || !options.breaks.windows(2).all(rising) {
        return bad("the times at which inputs jump must be finite and rise".to_owned());
    }
    if let Drive::Sampled { period, .. } | Drive::Table(Samples { period, .. }) = &options.drive
        && !(period.is_finite() && *period > 0.0)
    {
        return bad(format!("the sampling time is {period}: it must be positive"));
    }
    if let Drive::Table(Samples { values, .. }) = &options.drive {
        let inputs = mechanism.count(ComponentKind::Input);
        if values.is_empty() {
            return bad("the table of sampled inputs is empty: it must have one row at least".to_owned());
        }
        if let Some(row) = values.iter().position(|values| values.len() != inputs) {
            let have = values[row].len();
            return bad(format!("sample {row} of the inputs has {have} numbers: it must have {inputs}"));
        }
    }
    let argument = |contact, cause, message| Err(error(contact, ErrorKind::Argument { cause, message }));
    for (kind, numbers) in [
        (ComponentKind::Coordinate, state.coordinates),
        (ComponentKind::Speed, state.speeds),
        (ComponentKind::Input, state.inputs),
    ] {
        let (count, have) = (mechanism.count(kind), numbers.len());
        if have != count {
            let message = format!("the slice for {}s has {have} numbers: it must have {count}", kind.noun());
            return argument(None, Cause::WrongLength, message);
        }
        if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
            let name = mechanism.component(kind, index).map_or("a number", |component| component.name);
            let message = format!("{name} is {}: it must be finite", numbers[index]);
            return argument(None, Cause::NotFinite, message);
        }
    }
    let count = mechanism.count(ComponentKind::Contact);
    for (contact, surface) in &options.surfaces {
        if *contact >= count {
            return Err(error(None, unknown(*contact)));
        }
        if let Some(kind) = wrong(surface) {
            return Err(error(Some(*contact), kind));
        }
    }
    if let Some(surface) = &options.surface
        && let Some(kind) = wrong(surface)
    {
        return Err(error(None, kind));
    }
    if let Some((contact, _)) = options.laws.iter().find(|(contact, _)| *contact >= count) {
        return Err(error(None, unknown(*contact)));
    }
    for &(contact, stiffness) in &options.stiffness {
        if contact >= count {
            return Err(error(None, unknown(contact)));
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
        // A contact without a gap cannot be detected when it closes.
        if gap.is_none() {
            continue;
        }
        let own = options.surfaces.iter().rev().find(|(index, _)| *index == contact);
        let given = own.map(|(_, surface)| *surface).or(options.surface);
        let Some(surface) = given.or_else(|| mechanism.surface(contact)) else {
            let name = mechanism.component(ComponentKind::Contact, contact).map_or("", |found| found.name);
            let message = format!("contact {name} has no surface: it needs mu, e and a law");
            return argument(None, Cause::NoSurface, message);
        };
        let own = options.laws.iter().rev().find(|(index, _)| *index == contact);
        let law = match own.map(|(_, law)| law).or(options.law.as_ref()) {
            Some(law) => law.clone(),
            None => ContactLaw::stated(&mechanism.stated_law(contact))
                .map_err(|message| error(Some(contact), ErrorKind::BadOption(message)))?,
        };
        let ends = mechanism.validity(contact, state).map_err(fault)?.is_some();
        let pair = Pair { surface, law, ends, first: mechanism.pair(contact) };
        pair.check().map_err(|message| error(Some(contact), ErrorKind::BadOption(message)))?;
        *slot = Some(pair);
    }
    Ok(surfaces)
}

/// The mistake in a surface, if any.
fn wrong(surface: &Surface<f64>) -> Option<ErrorKind> {
    let Surface { mu, e, .. } = *surface;
    for (what, value) in [("friction", mu), ("restitution", e)] {
        if !value.is_finite() {
            let message = format!("the coefficient of {what} is {value}: it must be finite");
            return Some(ErrorKind::Argument { cause: Cause::NotFinite, message });
        }
    }
    let error = match () {
        () if mu < 0.0 => ImpactError::NegativeFriction { mu },
        () if !(0.0..=1.0).contains(&e) => ImpactError::RestitutionOutOfRange { e },
        () => return None,
    };
    Some(error.into())
}

/// An option is about a contact that the mechanism does not have.
fn unknown(contact: usize) -> ErrorKind {
    ErrorKind::State(StateError::Missing { kind: ComponentKind::Contact, index: contact })
}
