//! The surfaces of a motion: one for all contacts, or one for each.

use hodograph::{ComponentKind, Contacts, State, Surface};
use hodograph_interpreter::motion::{GivenSurface, surfaces};
use hodograph_simulation::{ContactLaw, GivenLaw};

use crate::json::{Failure, Kind};
use crate::output;
use crate::spelling;
use crate::stop::{Outcome, Stop};
use crate::surface::{FromModel, checked, help_of_law, law, stated_in};

/// The options for surfaces.
#[derive(Clone, Debug, clap::Args)]
pub struct MotionSurfaces {
    /// Coulomb's coefficient of friction, not negative [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    mu: Option<f64>,
    /// coefficient of restitution, between 0 and 1 [default: that of the model]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    e: Option<f64>,
    #[arg(long, value_name = "LAW", help = help_of_law())]
    law: Option<String>,
    /// static coefficient of friction, not less than mu: slip begins where friction exceeds it [default: mu]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    mu_static: Option<f64>,
    /// coefficient of friction in impacts [default: mu]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    mu_impact: Option<f64>,
    /// sliding friction by the speed of slip: constant, or stribeck(SPEED), which falls from the static
    /// coefficient to mu [default: constant]
    #[arg(long, value_name = "LAW")]
    sliding: Option<String>,
    /// e by the speed of approach: constant, threshold(SPEED), power(SPEED, EXPONENT), loss(SPEED, EXPONENT)
    /// or table(SPEED, E, SPEED, E, ..) [default: constant]
    #[arg(long, value_name = "LAW")]
    restitution: Option<String>,
    /// lever arm of rolling friction, m: a torque of at most this times the normal force resists rolling
    /// [default: that of the model]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    rolling: Option<f64>,
    /// lever arm of spinning friction, m: the same about the normal [default: that of the model]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    spinning: Option<f64>,
    /// the surface of one contact, as `tip=0.5,0.8,stronge`, with parts such as `mu_static=0.6` after
    /// these; may be given several times
    #[arg(long, value_name = "CONTACT=MU,E,LAW")]
    surface: Vec<String>,
}

/// The surfaces of contacts, and their laws beyond mu, e and law, by the index of the contact.
pub struct Found {
    pub surfaces: Vec<(usize, Surface<f64>)>,
    pub laws: Vec<(usize, ContactLaw)>,
}

impl MotionSurfaces {
    /// The options as they were given.
    pub fn given(&self) -> Vec<String> {
        let numbers = [
            ("mu", self.mu),
            ("e", self.e),
            ("mu-static", self.mu_static),
            ("mu-impact", self.mu_impact),
            ("rolling", self.rolling),
            ("spinning", self.spinning),
        ];
        let texts = [("law", &self.law), ("sliding", &self.sliding), ("restitution", &self.restitution)];
        let numbers = numbers.into_iter().filter_map(|(name, value)| Some((name, value?.to_string())));
        let texts = texts.into_iter().filter_map(|(name, value)| Some((name, value.clone()?)));
        let own = self.surface.iter().map(|text| ("surface", text.clone()));
        numbers.chain(texts).chain(own).map(|(name, value)| format!("--{name}={value}")).collect()
    }

    /// The surface of every contact that has a gap.
    ///
    /// # Errors
    ///
    /// Impossible numbers or names, and [`Stop::Call`] if a contact has no surface.
    pub fn of(&self, mechanism: &dyn Contacts<f64>, state: &State<'_>) -> Outcome<Found> {
        let name = |contact| {
            mechanism.component(ComponentKind::Contact, contact).map_or("", |component| component.name)
        };
        let law = self.law.as_deref().map(law).transpose()?;
        // Check the given values even if others are missing.
        let all = checked(GivenSurface { mu: self.mu, e: self.e, law }, ["--mu", "--e"])?;
        let all_laws = self.laws_of_all()?;
        let mut laws: Vec<(usize, GivenLaw)> = Vec::new();
        let mut own: Vec<(usize, GivenSurface)> = Vec::new();
        for text in &self.surface {
            let (contact, surface, law) = one(text)?;
            let place = place_of(contact, mechanism)?;
            if own.iter().any(|(other, _)| *other == place) {
                return Err(Stop::Call(format!(
                    "--surface {text}: {contact} has two surfaces: leave one out"
                )));
            }
            own.push((place, surface));
            laws.push((place, law.or(all_laws.clone())));
        }
        // Values that the options do not give are those of the model.
        let mut notes = FromModel::default();
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            let has_gap = !matches!(mechanism.gap(contact, state), Ok(None));
            if has_gap && own.iter().all(|(other, _)| *other != contact) {
                own.push((contact, stated_in(mechanism, contact, all, &mut notes)));
            }
        }
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            let replaced = laws.iter().any(|(other, _)| *other == contact);
            if !replaced {
                let stated = stated_law(mechanism, contact, name(contact), all_laws.clone(), &mut notes)?;
                laws.push((contact, stated));
            }
        }
        notes.say();
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
        let laws = laws.into_iter().map(|(contact, law)| (contact, law.law())).collect();
        Ok(Found { surfaces: found.of_contacts, laws })
    }

    /// The laws that the options give for all contacts, beyond mu, e and law.
    fn laws_of_all(&self) -> Outcome<GivenLaw> {
        let call = |option: &str, message: String| Stop::Call(format!("{option}: {message}"));
        let sliding = self.sliding.as_ref().map(|text| text.parse()).transpose();
        let restitution = self.restitution.as_ref().map(|text| text.parse()).transpose();
        Ok(GivenLaw {
            mu_static: self.mu_static,
            mu_impact: self.mu_impact,
            sliding: sliding.map_err(|message| call("--sliding", message))?,
            restitution: restitution.map_err(|message| call("--restitution", message))?,
            rolling: self.rolling,
            spinning: self.spinning,
        })
    }
}

/// The law of a contact: the given parts, and for the others those of the model, which are noted.
fn stated_law(
    mechanism: &dyn Contacts<f64>,
    contact: usize,
    name: &str,
    given: GivenLaw,
    notes: &mut FromModel,
) -> Outcome<GivenLaw> {
    let stated = ContactLaw::stated(&mechanism.stated_law(contact)).map_err(Stop::Call)?;
    let stated = GivenLaw::from(stated);
    let whole = given.clone().or(stated.clone());
    let of_model = |(part, _): &&(&str, String)| !given.parts().iter().any(|(other, _)| other == part);
    let parts = stated.parts();
    let says: Vec<String> =
        parts.iter().filter(of_model).map(|(part, text)| format!("{part} = {text}")).collect();
    notes.add(name, &says);
    Ok(whole)
}

/// The index of a contact.
fn place_of(contact: &str, mechanism: &dyn Contacts<f64>) -> Outcome<usize> {
    let names = || {
        let component = |place| mechanism.component(ComponentKind::Contact, place);
        (0..mechanism.count(ComponentKind::Contact)).filter_map(component).map(|component| component.name)
    };
    mechanism.index(ComponentKind::Contact, contact).ok_or_else(|| {
        let hint = spelling::hint(contact, names().collect::<Vec<_>>());
        Failure::new(Kind::UnknownName, format!("there is no contact `{contact}`: {hint}")).into()
    })
}

/// The stiffnesses of contacts, by the index of the contact.
///
/// # Errors
///
/// [`Stop::Call`] if a text is not a stiffness or a name is unknown.
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
fn one(text: &str) -> Outcome<(&str, GivenSurface, GivenLaw)> {
    let wrong = || Stop::Call(format!("--surface {text}: give CONTACT=MU,E,LAW, as in tip=0.5,0.8,stronge"));
    let (contact, rest) = text.split_once('=').ok_or_else(wrong)?;
    let parts = split(rest);
    let [mu, e, named, more @ ..] = &parts[..] else { return Err(wrong()) };
    let mut given = GivenLaw::default();
    let mut names = Vec::new();
    for part in more {
        let (part, value) = part.split_once('=').ok_or_else(|| {
            Stop::Call(format!("--surface {text}: give after MU,E,LAW parts such as mu_static=0.6"))
        })?;
        let part = part.trim();
        if names.contains(&part) {
            return Err(Stop::Call(format!("--surface {text}: {part} is given twice: leave one out")));
        }
        names.push(part);
        given
            .set(part, value.trim())
            .map_err(|message| Stop::Call(format!("--surface {text}: {message}")))?;
    }
    let number = |text: &str| text.parse::<f64>().map_err(|_| wrong());
    let surface = GivenSurface::from(Surface { mu: number(mu)?, e: number(e)?, law: law(named)? });
    let names = ["mu", "e"].map(|name| format!("--surface {text}: {name}"));
    Ok((contact.trim(), checked(surface, names.each_ref().map(String::as_str))?, given))
}

/// The parts between commas outside parentheses.
fn split(text: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut begin) = (Vec::new(), 0_i32, 0);
    for (place, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth <= 0 => {
                parts.push(text[begin..place].trim());
                begin = place + 1;
            }
            _ => {}
        }
    }
    parts.push(text[begin..].trim());
    parts
}
