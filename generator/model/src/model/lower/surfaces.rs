//! Lowers the surfaces of contacts: friction and restitution.

use super::super::mechanism::{ContactLaw, Named, Surface};
use super::Lowering;
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::suggest;
use crate::syntax::tree::{ExprKind, Field};
use crate::words;

/// The numbers of a law.
enum Form {
    /// so many, all positive
    Positive(usize),
    /// pairs of a speed and a coefficient
    Table,
}

/// The laws of sliding friction, as functions of the speed of slip.
const SLIDING: [(&str, Form); 2] = [("constant", Form::Positive(0)), ("stribeck", Form::Positive(1))];
/// The laws of restitution, as functions of the speed of approach.
const RESTITUTION: [(&str, Form); 5] = [
    ("constant", Form::Positive(0)),
    ("threshold", Form::Positive(1)),
    ("power", Form::Positive(2)),
    ("loss", Form::Positive(2)),
    ("table", Form::Table),
];

impl Lowering<'_> {
    /// Friction and restitution.
    pub(super) fn surface(&mut self, field: &Field) -> (Surface, ContactLaw) {
        let (mut surface, mut more) = (Surface::PLAIN, ContactLaw::default());
        let Some(fields) = &field.fields else {
            let form = "surface: { mu: 0.3, e: 0.5, law: stronge }";
            let message = "a surface is friction and restitution in braces";
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            self.report(error.help(format!("write `{form}`; what is struck stands under `against`")));
            return (surface, more);
        };
        if fields.is_empty() {
            let message = "a surface that says nothing";
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            let usual = "mu: 0.3, e: 0.5, law: stronge";
            let error = error.fix(Place::IntoBraces(field.name.span), usual);
            self.report(error.help("state `mu`, `e` and `law`, or leave `surface` out"));
            return (surface, more);
        }
        let owner = &field.name;
        let known = words::SURFACE;
        let [mu, e, law, mu_static, mu_impact, sliding, restitution, rolling, spinning] =
            self.record("a surface", owner, fields, known, &[]);
        if let Some(value) = mu.and_then(|mu| self.friction(mu, "a coefficient of friction")) {
            surface.mu = value;
        }
        if let Some((value, field)) =
            e.and_then(|e| Some((self.coefficient(e, "a coefficient of restitution")?, e)))
        {
            if value > 1.0 {
                let message = "a coefficient of restitution is at most 1";
                let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
                self.report(error.help("1 gives back all, 0 nothing"));
            }
            surface.e = value;
        }
        if let Some(law) = law {
            surface.law = self.law(law).unwrap_or(surface.law);
        }
        more.mu_static = mu_static.and_then(|mu| self.friction(mu, "a coefficient of static friction"));
        more.mu_impact = mu_impact.and_then(|mu| self.friction(mu, "a coefficient of friction in impacts"));
        if let (Some(value), Some(field)) = (more.mu_static, mu_static)
            && value < surface.mu
        {
            let message = "static friction is not less than sliding friction";
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            self.report(error.help(format!("`mu` is {}", surface.mu)));
        }
        more.sliding = sliding.and_then(|field| {
            let law = self.named(field, "sliding friction", &SLIDING, Named::SLIDING)?;
            if law.name == "stribeck" && mu_static.is_none() {
                let message = "friction falls from the static coefficient, which is missing";
                let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
                self.report(error.help("state `mu_static` too"));
            }
            Some(law)
        });
        more.restitution =
            restitution.and_then(|field| self.named(field, "restitution", &RESTITUTION, Named::RESTITUTION));
        more.rolling =
            rolling.and_then(|arm| self.coefficient(arm, "the lever arm of rolling friction, in m,"));
        more.spinning =
            spinning.and_then(|arm| self.coefficient(arm, "the lever arm of spinning friction, in m,"));
        (surface, more)
    }

    /// A law of a speed: a name with numbers.
    fn named(&mut self, field: &Field, of: &str, known: &[(&str, Form)], forms: &str) -> Option<Named> {
        self.notes(field, &[]);
        let (name, span, given): (&str, _, &[_]) = match &field.value.kind {
            ExprKind::Name(name) => (name.as_str(), field.value.span, &[]),
            ExprKind::Call(name, numbers) => (name.text.as_str(), name.span, numbers.as_slice()),
            ExprKind::Error => return None,
            _ => ("", field.value.span, &[]),
        };
        let Some((name, form)) = known.iter().find(|(known, _)| *known == name) else {
            let message = format!("there is no such law of {of}");
            let error = Diagnostic::new(codes::SURFACE, span, message);
            let near = suggest::nearest(name, known.iter().map(|(known, _)| *known));
            self.report(match near {
                Some(near) => error
                    .fix(Place::Replace(span), near)
                    .help(format!("did you mean `{near}`? The laws are {forms}")),
                None => error.help(format!("the laws are {forms}")),
            });
            return None;
        };
        let numbers: Option<Vec<f64>> = given.iter().map(|number| self.constant(number).constant).collect();
        let numbers = numbers?;
        let wrong = match form {
            Form::Positive(0) if !numbers.is_empty() => Some("this law takes no numbers"),
            Form::Positive(1) if numbers.len() != 1 => Some("this law takes one number"),
            Form::Positive(count) if numbers.len() != *count => Some("this law takes two numbers"),
            Form::Positive(_) if !numbers.iter().all(|number| *number > 0.0) => {
                Some("its numbers are positive")
            }
            Form::Positive(_) => None,
            Form::Table if numbers.is_empty() || numbers.len() % 2 != 0 => {
                Some("a table is pairs of a speed and a coefficient")
            }
            Form::Table => {
                let rows: Vec<&[f64]> = numbers.chunks_exact(2).collect();
                let rise = rows[0][0] >= 0.0 && rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
                let between = rows.iter().all(|row| (0.0..=1.0).contains(&row[1]));
                match (rise, between) {
                    (false, _) => Some("the speeds of a table are not negative, and rise"),
                    (_, false) => Some("a coefficient of restitution lies between 0 and 1"),
                    _ => None,
                }
            }
        };
        if let Some(message) = wrong {
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            self.report(error.help(format!("the laws are {forms}")));
            return None;
        }
        (*name != "constant").then(|| Named { name: (*name).to_owned(), numbers })
    }

    /// A number that is not negative.
    fn coefficient(&mut self, field: &Field, what: &str) -> Option<f64> {
        self.notes(field, &[]);
        let typed = self.constant(&field.value);
        let value = typed.constant?;
        if value < 0.0 {
            let message = format!("{what} is not negative");
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            self.report(error.help("give a positive number, or 0 for none"));
        }
        Some(value)
    }

    /// A coefficient of friction.
    fn friction(&mut self, field: &Field, what: &str) -> Option<f64> {
        let value = self.coefficient(field, what)?;
        if value > Surface::MOST_FRICTION {
            let message = format!("{what} is at most {:e}", Surface::MOST_FRICTION);
            let error = Diagnostic::new(codes::SURFACE, field.value.span, message);
            self.report(error.help("1e6 holds as well"));
        }
        Some(value)
    }

    fn law(&mut self, field: &Field) -> Option<&'static str> {
        self.notes(field, &[]);
        let name = match &field.value.kind {
            ExprKind::Name(name) => name.to_lowercase(),
            ExprKind::Error => return None,
            _ => String::new(),
        };
        let law = words::look(words::LAWS, &name).map(|law| law.text);
        if law.is_none() {
            let error =
                Diagnostic::new(codes::SURFACE, field.value.span, "there is no such law of restitution");
            let near = suggest::nearest(&name, words::LAWS.iter().map(|law| law.text));
            self.report(match near {
                Some(near) => error.did_you_mean(near),
                None => error.help(format!("the laws are {}", words::texts(words::LAWS))),
            });
        }
        law
    }
}
