//! The surfaces of a motion: one for all contacts, or one for each.

use hodograph::{Contacts, ImpactError, Kind as Of, State, Surface};
use hodograph_generator::model::mechanism::Mechanism;

use super::gap::gap;
use crate::json::{Failure, Kind};
use crate::spelling;
use crate::stop::{Outcome, Stop};
use crate::surface::{Given, law};

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
        model: &Mechanism,
        state: &State<'_>,
    ) -> Outcome<Vec<(usize, Surface<f64>)>> {
        let count = mechanism.count(Of::Contact);
        let name = |contact| mechanism.component(Of::Contact, contact).map_or("", |component| component.name);
        let given = Given { mu: self.mu, e: self.e, law: self.law.as_deref().map(law).transpose()? };
        // What is given is checked even where it is not enough.
        checked(Surface {
            mu: given.mu.unwrap_or(0.0),
            e: given.e.unwrap_or(0.0),
            law: given.law.unwrap_or(hodograph::Law::Newton),
        })?;
        let mut own = vec![None; count];
        for text in &self.surface {
            let (contact, surface) = one(text)?;
            if own[place_of(contact, mechanism)?].replace(surface).is_some() {
                return Err(Stop::Call(format!(
                    "--surface {text}: {contact} has two surfaces: leave one out"
                )));
            }
        }
        let mut surfaces = Vec::new();
        for (contact, own) in own.into_iter().enumerate() {
            if gap(mechanism, contact, state).is_none() {
                eprintln!(
                    "note: contact {} has no gap in the model: it is never seen to close",
                    name(contact)
                );
                continue;
            }
            let stated = || model.contacts.get(contact).and_then(|contact| given.of(contact));
            let Some(surface) = own.or_else(stated) else {
                let name = name(contact);
                return Err(Stop::Call(format!(
                    "contact {name} has no surface: give --mu, --e and --law for all contacts, or --surface {name}=MU,E,LAW, or state `surface: {{ mu: .., e: .., law: .. }}` in the model"
                )));
            };
            surfaces.push((contact, surface));
        }
        Ok(surfaces)
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
fn one(text: &str) -> Outcome<(&str, Surface<f64>)> {
    let wrong = || Stop::Call(format!("--surface {text}: give CONTACT=MU,E,LAW, as in tip=0.5,0.8,stronge"));
    let (contact, rest) = text.split_once('=').ok_or_else(wrong)?;
    let parts: Vec<&str> = rest.split(',').map(str::trim).collect();
    let [mu, e, named] = parts[..] else { return Err(wrong()) };
    let number = |text: &str| text.parse::<f64>().map_err(|_| wrong());
    Ok((contact.trim(), checked(Surface { mu: number(mu)?, e: number(e)?, law: law(named)? })?))
}

/// A surface that the solver will take.
fn checked(surface: Surface<f64>) -> Result<Surface<f64>, Failure> {
    let Surface { mu, e, .. } = surface;
    let wrong = if let Some(&value) = [mu, e].iter().find(|value| !value.is_finite()) {
        ImpactError::NotFinite { value }
    } else if mu < 0.0 {
        ImpactError::NegativeFriction { mu }
    } else if !(0.0..=1.0).contains(&e) {
        ImpactError::RestitutionOutOfRange { e }
    } else {
        return Ok(surface);
    };
    Err(wrong.into())
}
