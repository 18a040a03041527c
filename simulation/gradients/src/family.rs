//! A mechanism and its surfaces with other values of parameters, mu and e.

use hodograph::{ComponentKind, Contacts, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;

use crate::By;

/// Gives a parameter, mu or e another value.
///
/// # Errors
///
/// Why it is refused.
pub(crate) fn changed(
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
            stated(mechanism, options);
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

/// Gives each contact the surface of its own that it has by the options or the model.
fn stated(mechanism: &InterpretedMechanism, options: &mut Options) {
    for contact in 0..mechanism.count(ComponentKind::Contact) {
        if options.surfaces.iter().all(|(place, _)| *place != contact) {
            let surface = options.surface.or_else(|| mechanism.surface(contact));
            options.surfaces.extend(surface.map(|surface| (contact, surface)));
        }
    }
}
