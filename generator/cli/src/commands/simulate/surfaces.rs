//! The surfaces of a motion: one for all contacts, or one for each.

use hodograph::{Contacts, Kind as Of, State, Surface};
use hodograph_interpreter::motion::{GivenSurface, surfaces};

use crate::json::{Failure, Kind};
use crate::output;
use crate::spelling;
use crate::stop::{Outcome, Stop};
use crate::surface::{law, stated_in};

/// Surfaces as they stand on the command line.
#[derive(Clone, Debug, clap::Args)]
pub struct MotionSurfaces {
    /// Coulomb's coefficient of friction, not negative [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    mu: Option<f64>,
    /// coefficient of restitution, between 0 and 1 [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    e: Option<f64>,
    /// hypothesis of restitution: newton, poisson or stronge [default: that of the model]
    #[arg(long, value_name = "LAW")]
    law: Option<String>,
    /// the surface of one contact, as `tip=0.5,0.8,stronge`; may be given several times
    #[arg(long, value_name = "CONTACT=MU,E,LAW")]
    surface: Vec<String>,
}

impl MotionSurfaces {
    /// The surface of every contact that has a gap.
    ///
    /// # Errors
    ///
    /// Numbers or names that are impossible, and [`Stop::Call`] where a contact is left without a surface.
    pub fn of(
        &self,
        mechanism: &dyn Contacts<f64>,
        state: &State<'_>,
    ) -> Outcome<Vec<(usize, Surface<f64>)>> {
        let name = |contact| mechanism.component(Of::Contact, contact).map_or("", |component| component.name);
        let law = self.law.as_deref().map(law).transpose()?;
        // What is given is checked even where it is not enough.
        let all = GivenSurface { mu: self.mu, e: self.e, law }.check().map_err(Failure::from)?;
        let mut own: Vec<(usize, GivenSurface)> = Vec::new();
        for text in &self.surface {
            let (contact, surface) = one(text)?;
            let place = place_of(contact, mechanism)?;
            if own.iter().any(|(other, _)| *other == place) {
                return Err(Stop::Call(format!(
                    "--surface {text}: {contact} has two surfaces: leave one out"
                )));
            }
            own.push((place, surface));
        }
        // What the options leave open stands in the model, if at all.
        for contact in 0..mechanism.count(Of::Contact) {
            let has_gap = !matches!(mechanism.gap(contact, state), Ok(None));
            if has_gap && own.iter().all(|(other, _)| *other != contact) {
                own.push((contact, stated_in(mechanism, contact, all)));
            }
        }
        let found = surfaces(mechanism, state, all, &own).map_err(|error| {
            Stop::Call(format!(
                "{error}: give --mu, --e and --law for all contacts, or --surface {}=MU,E,LAW, or state its `surface` in the model",
                error.contact
            ))
        })?;
        for contact in found.without_gap {
            output::say(format_args!(
                "note: contact {} has no gap in the model: it is never seen to close",
                name(contact)
            ));
        }
        Ok(found.of_contacts)
    }
}

/// The number of a contact.
fn place_of(contact: &str, mechanism: &dyn Contacts<f64>) -> Outcome<usize> {
    let names = || {
        let component = |place| mechanism.component(Of::Contact, place);
        (0..mechanism.count(Of::Contact)).filter_map(component).map(|component| component.name)
    };
    mechanism.index(Of::Contact, contact).ok_or_else(|| {
        let hint = spelling::hint(contact, names().collect::<Vec<_>>());
        Failure::new(Kind::UnknownName, format!("there is no contact `{contact}`: {hint}")).into()
    })
}

/// The stiffnesses of contacts, by number.
///
/// # Errors
///
/// [`Stop::Call`] where a text is no stiffness, and a name that is none.
pub fn stiffnesses(texts: &[String], mechanism: &dyn Contacts<f64>) -> Outcome<Vec<(usize, f64)>> {
    let mut stiffnesses = Vec::new();
    for text in texts {
        let read = text.split_once('=').and_then(|(contact, number)| {
            let number = number.trim().parse::<f64>().ok()?;
            (number.is_finite() && number > 0.0).then_some((contact.trim(), number))
        });
        let Some((contact, number)) = read else {
            return Err(Stop::Call(format!(
                "--stiffness {text}: give CONTACT=NUMBER with a positive number, as in left=2"
            )));
        };
        let place = place_of(contact, mechanism)?;
        if stiffnesses.iter().any(|(other, _)| *other == place) {
            return Err(Stop::Call(format!(
                "--stiffness {text}: {contact} has two stiffnesses: leave one out"
            )));
        }
        stiffnesses.push((place, number));
    }
    Ok(stiffnesses)
}

/// A surface of one contact.
fn one(text: &str) -> Outcome<(&str, GivenSurface)> {
    let wrong = || Stop::Call(format!("--surface {text}: give CONTACT=MU,E,LAW, as in tip=0.5,0.8,stronge"));
    let (contact, rest) = text.split_once('=').ok_or_else(wrong)?;
    let parts: Vec<&str> = rest.split(',').map(str::trim).collect();
    let [mu, e, named] = parts[..] else { return Err(wrong()) };
    let number = |text: &str| text.parse::<f64>().map_err(|_| wrong());
    let surface = GivenSurface::from(Surface { mu: number(mu)?, e: number(e)?, law: law(named)? });
    Ok((contact.trim(), surface.check().map_err(Failure::from)?))
}
