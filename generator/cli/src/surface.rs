//! Reads laws of restitution by name, and determines the surface of a contact: from the options, else from
//! the model.

use hodograph::{Cause, ComponentKind, Contacts, Law, Surface};
use hodograph_interpreter::motion::GivenSurface;

use crate::json::{Failure, Kind};
use crate::output;
use crate::stop::{Outcome, Stop};

/// The law of that name.
///
/// # Errors
///
/// `unknown_law`.
pub fn law(name: &str) -> Result<Law, Failure> {
    Law::read(name).map_err(|error| Failure::new(Kind::Of(error.cause()), error.to_string()))
}

/// What the option `--law` says of itself.
pub fn help_of_law() -> String {
    format!("hypothesis of restitution, one of {} [default: that of the model]", Law::NAMES.join(", "))
}

/// What contacts take from the model, for they are not given it: one note for all that take the same.
#[derive(Debug, Default)]
pub struct FromModel {
    /// what is taken, and the names of the contacts
    notes: Vec<(String, Vec<String>)>,
}

/// How many contacts are named in a note, unless it tells the first ones, the last one and their number.
const MOST_NAMES: usize = 4;

impl FromModel {
    /// Notes what a contact takes, such as `mu = 0.3`.
    pub fn add(&mut self, contact: &str, parts: &[String]) {
        if parts.is_empty() {
            return;
        }
        let taken = parts.join(", ");
        match self.notes.iter_mut().find(|(other, _)| *other == taken) {
            Some((_, names)) => names.push(contact.to_string()),
            None => self.notes.push((taken, vec![contact.to_string()])),
        }
    }

    /// Writes the notes to standard error.
    pub fn say(self) {
        for (taken, names) in self.notes {
            let who = match &names[..] {
                [name] => format!("contact {name}"),
                [first, second, .., last] if names.len() > MOST_NAMES => {
                    format!("{} contacts {first}, {second}, .. {last}", names.len())
                }
                _ => format!("contacts {}", names.join(", ")),
            };
            output::say(format_args!("note: {who}: {taken} of the model"));
        }
    }
}

/// The surface of a contact: the given values, and for the others those of the model, which are noted.
pub fn stated_in(
    mechanism: &dyn Contacts<f64>,
    contact: usize,
    given: GivenSurface,
    notes: &mut FromModel,
) -> GivenSurface {
    let Some(stated) = mechanism.surface(contact) else { return given };
    let says = [
        given.mu.is_none().then(|| format!("mu = {}", stated.mu)),
        given.e.is_none().then(|| format!("e = {}", stated.e)),
        given.law.is_none().then(|| format!("law = {}", stated.law.name())),
    ];
    let says: Vec<String> = says.into_iter().flatten().collect();
    let name = mechanism.component(ComponentKind::Contact, contact).map_or("", |component| component.name);
    notes.add(name, &says);
    given.or(stated.into())
}

/// The options for a surface.
#[derive(Clone, Debug, clap::Args)]
pub struct SurfaceArguments {
    /// Coulomb's coefficient of friction, not negative [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub mu: Option<f64>,
    /// coefficient of restitution, between 0 and 1 [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub e: Option<f64>,
    #[arg(long, value_name = "LAW", help = help_of_law())]
    pub law: Option<String>,
}

impl SurfaceArguments {
    /// The surface of a contact; the solver checks the numbers.
    ///
    /// # Errors
    ///
    /// `unknown_law`, `not_finite`, and [`Stop::Call`] if a value is given neither here nor in the model.
    pub fn surface(&self, mechanism: &dyn Contacts<f64>, contact: usize) -> Outcome<Surface<f64>> {
        let law = self.law.as_deref().map(law).transpose()?;
        let given = GivenSurface { mu: self.mu, e: self.e, law };
        finite(given, ["--mu", "--e"])?;
        let mut notes = FromModel::default();
        let surface = stated_in(mechanism, contact, given, &mut notes);
        notes.say();
        surface.whole().ok_or_else(|| {
            let name =
                mechanism.component(ComponentKind::Contact, contact).map_or("", |component| component.name);
            Stop::Call(format!(
                "contact {name} has no surface: give --mu, --e and --law, or state its `surface` in the model"
            ))
        })
    }
}

/// Checks that the numbers of a surface are finite; they are told by these names.
///
/// # Errors
///
/// `not_finite`.
fn finite(given: GivenSurface, names: [&str; 2]) -> Outcome<()> {
    for (name, value) in names.into_iter().zip([given.mu, given.e]) {
        if let Some(value) = value.filter(|value| !value.is_finite()) {
            let message = format!("{name} is {value}: it must be finite");
            return Err(Failure::new(Kind::Of(Cause::NotFinite), message).into());
        }
    }
    Ok(())
}

/// Checks what is given of a surface, whose mu and e are told by these names.
///
/// # Errors
///
/// Those of the solver.
pub fn checked(given: GivenSurface, names: [&str; 2]) -> Outcome<GivenSurface> {
    finite(given, names)?;
    Ok(given.check().map_err(Failure::from)?)
}
