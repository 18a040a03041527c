//! Reads and changes the values of parameters, mu and e of a mechanism and its surfaces.

use hodograph::{ComponentKind, Contacts, Mechanism, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;

use crate::By;

/// Sets a parameter, mu or e to another value.
///
/// # Errors
///
/// Why the value is refused.
pub(crate) fn set_value(
    mechanism: &mut InterpretedMechanism,
    options: &mut Options,
    by: By,
    value: f64,
) -> Result<(), String> {
    match by {
        By::Parameter(index) => {
            let mut all = vec![0.0; mechanism.count(ComponentKind::Parameter)];
            mechanism.parameter_values(&mut all).map_err(|error| error.to_string())?;
            *all.get_mut(index).ok_or("there is no such parameter")? = value;
            mechanism.set_parameter_values(&all).map_err(|error| error.to_string())
        }
        By::Friction(contact) | By::Restitution(contact) => {
            resolve_surfaces(mechanism, options);
            let is_friction = matches!(by, By::Friction(_));
            let of = |place: usize| contact.is_none_or(|contact| contact == place);
            for (_, surface) in options.surfaces.iter_mut().filter(|(place, _)| of(*place)) {
                *if is_friction { &mut surface.mu } else { &mut surface.e } = value;
            }
            Ok(())
        }
        _ => Err("only parameters of the model, mu and e may change".to_owned()),
    }
}

/// A mechanism and options with other values of parameters, mu and e.
///
/// # Errors
///
/// Why a value is refused.
pub fn with_values(
    mechanism: &InterpretedMechanism,
    options: &Options,
    variables: &[By],
    values: &[f64],
) -> Result<(InterpretedMechanism, Options), String> {
    let (mut mechanism, mut options) = (mechanism.clone(), options.clone());
    for (&by, &value) in variables.iter().zip(values) {
        set_value(&mut mechanism, &mut options, by, value)?;
    }
    Ok((mechanism, options))
}

/// The value of a parameter, mu or e; for all contacts together that of the first.
///
/// # Errors
///
/// Why there is no such value.
pub(crate) fn value_of(mechanism: &InterpretedMechanism, options: &Options, by: By) -> Result<f64, String> {
    match by {
        By::Parameter(index) => {
            let mut all = vec![0.0; mechanism.count(ComponentKind::Parameter)];
            mechanism.parameter_values(&mut all).map_err(|error| error.to_string())?;
            all.get(index).copied().ok_or_else(|| "there is no such parameter".to_owned())
        }
        By::Friction(contact) | By::Restitution(contact) => {
            let mut options = options.clone();
            resolve_surfaces(mechanism, &mut options);
            let own = |(place, _): &&(usize, Surface<f64>)| contact.is_none_or(|contact| contact == *place);
            let (_, surface) = options.surfaces.iter().find(own).ok_or("the contact has no surface")?;
            Ok(if matches!(by, By::Friction(_)) { surface.mu } else { surface.e })
        }
        _ => Err("only parameters of the model, mu and e are fitted or followed".to_owned()),
    }
}

/// Gives each contact its own entry in the options, with the surface of the options or else of the model.
pub(crate) fn resolve_surfaces(mechanism: &InterpretedMechanism, options: &mut Options) {
    for contact in 0..mechanism.count(ComponentKind::Contact) {
        if options.surfaces.iter().all(|(place, _)| *place != contact) {
            let surface = options.surface.or_else(|| mechanism.surface(contact));
            options.surfaces.extend(surface.map(|surface| (contact, surface)));
        }
    }
}
