//! Resolves names, and suggests others where a name is unknown.

use super::super::dependency_order::body_frame;
use super::super::mechanism::{FrameId, PointId};
use super::super::names::Symbol;
use super::Lowering;
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::span::Span;
use crate::syntax::tree::{ExprKind, Name, Record};
use crate::syntax::units;
use crate::unicode;
use crate::vocabulary;

/// At most this number of unknown names is compared with the declared ones.
pub(super) const MAX_SUGGESTIONS: usize = 20;

impl Lowering<'_> {
    /// Resolves a name; reports it if unknown. `fits` says what may be suggested instead.
    pub fn resolve(&mut self, name: &Name, fits: impl Fn(Symbol) -> bool) -> Option<Symbol> {
        match self.names.get(&name.text) {
            Some(Symbol::Broken) => return None,
            Some(symbol) => {
                self.places.uses(symbol, name.span);
                // of two declarations the other may be meant
                return Some(symbol).filter(|symbol| fits(*symbol) || !self.names.is_ambiguous(&name.text));
            }
            // said once, and not at all where the declaration may be in a part that could not be read
            None if self.tree.incomplete || !self.unknown.insert(name.text.clone()) => return None,
            None => {}
        }
        let error = Diagnostic::new(codes::UNKNOWN_NAME, name.span, unknown_name(&name.text));
        if let Some((advice, place)) = self.looks_like(&name.text) {
            let error = error.help(advice);
            self.report(match place {
                Some(place) => error.related(place, "this is declared"),
                None => error,
            });
            return None;
        }
        if let Some(advice) = self.meant_by(&name.text) {
            let error = match vocabulary::word_meant(&advice) {
                Some(word) => error.fix(Place::Replace(name.span), word),
                None => error,
            };
            self.report(error.help(advice));
            return None;
        }
        // comparing spellings is slow; nobody reads so many suggestions
        let near =
            if self.unknown.len() <= MAX_SUGGESTIONS { self.names.nearest(&name.text, fits) } else { None };
        let is_unit = units::is_symbol(&name.text) && name.text.chars().count() > 1;
        if near.is_none() && is_unit {
            self.report(error.help(format!(
                "units stand in declarations only: declare a quantity in it, as in `a: {} = ..`",
                name.text
            )));
            return None;
        }
        let error = match near {
            Some(near) => {
                let mut help = format!("did you mean `{near}`?");
                if is_unit {
                    help += &format!(" A unit stands in declarations only, as in `a: {} = ..`", name.text);
                }
                let error = error.fix(Place::Replace(name.span), near);
                match self.names.place(near) {
                    Some(place) => error.related(place, format!("`{near}` is declared here")).help(help),
                    None => error.help(help),
                }
            }
            None => error.help("declare it, or correct the spelling"),
        };
        self.report(error);
        None
    }

    /// A declared name that looks the same and is written in letters of another script, and its place.
    fn looks_like(&self, text: &str) -> Option<(String, Option<Span>)> {
        if let Some(found) = unicode::lookalike(text)
            && self.names.get(&found.latin).is_some()
        {
            return Some((found.advice(), self.names.place(&found.latin)));
        }
        // as for suggestions, nobody reads so many
        if self.unknown.len() > MAX_SUGGESTIONS {
            return None;
        }
        let (other, found) = self.names.all().find_map(|other| {
            unicode::lookalike(other)
                .filter(|found| found.latin == text)
                .map(|found| (other.to_owned(), found))
        })?;
        let advice = format!(
            "the name that is declared has the {} letter `{}`: write it in Latin letters",
            found.script, found.letter
        );
        Some((advice, self.names.place(&other)))
    }

    /// What an author means by a name of another language.
    fn meant_by(&self, text: &str) -> Option<String> {
        let declared =
            |name: &str| matches!(self.names.get(name), Some(Symbol::Coordinate(_) | Symbol::Definition(_)));
        if let Some(name) = vocabulary::rate_of(text, declared) {
            return Some(format!("a time derivative is written `d({name})/dt`"));
        }
        if text.contains('·') {
            return Some("write `*` for a product".to_owned());
        }
        if !self.constant_only && ["x", "y", "z"].contains(&text) {
            return Some(format!("an axis belongs to a frame: `N.{text}`"));
        }
        if let Some(given) = vocabulary::name(text) {
            return Some(format!("did you mean `{given}`?"));
        }
        None
    }

    /// The frame of this name; a body stands for its frame.
    pub fn frame_named(&mut self, name: &Name) -> Option<FrameId> {
        match self.resolve(name, |s| matches!(s, Symbol::Frame(_) | Symbol::Body(_)))? {
            Symbol::Frame(f) => Some(FrameId(f)),
            Symbol::Body(b) => {
                let frame = body_frame(self.tree, b);
                match frame.and_then(|frame| self.names.get(&frame.text)) {
                    Some(Symbol::Frame(f)) => Some(FrameId(f)),
                    _ if b < self.tree.bodies.len() => None,
                    _ => {
                        self.wrong_kind(name, "a frame or body", "a particle has no frame");
                        None
                    }
                }
            }
            other => {
                self.wrong_kind(name, "a frame or body", &format!("`{}` is {}", name.text, other.kind()));
                None
            }
        }
    }

    /// The point of this name.
    pub fn point_named(&mut self, name: &Name) -> Option<PointId> {
        match self.resolve(name, |s| matches!(s, Symbol::Point(_)))? {
            Symbol::Point(p) => Some(PointId(p)),
            other => {
                self.wrong_kind(name, "a point", &format!("`{}` is {}", name.text, other.kind()));
                None
            }
        }
    }

    pub fn wrong_kind(&mut self, name: &Name, needed: &str, is: &str) {
        let mut error =
            Diagnostic::new(codes::WRONG_KIND, name.span, format!("{needed} is needed here, but {is}"));
        if let Some(place) = self.names.place(&name.text) {
            error = error.related(place, "declared here");
        }
        let help = self.of_the_kind(&name.text, needed);
        self.report(error.help(help.unwrap_or_else(|| format!("write the name of {needed}"))));
    }

    /// What of the needed kind belongs to what was named.
    fn of_the_kind(&self, name: &str, needed: &str) -> Option<String> {
        let records = || self.tree.bodies.iter().chain(&self.tree.particles);
        let names = |record: &Record, fields: [&str; 2]| {
            let field = record.fields.iter().find(|field| fields.contains(&field.name.text.as_str()))?;
            if let ExprKind::Name(value) = &field.value.kind { Some(value.clone()) } else { None }
        };
        let own = || records().find(|record| record.name.text == name);
        let with = |fields: [&str; 2]| -> Vec<String> {
            let with = records().filter(|record| names(record, fields).as_deref() == Some(name));
            with.map(|record| format!("`{}`", record.name.text)).collect()
        };
        match (needed, self.names.get(name)?) {
            ("a point", Symbol::Body(_)) => {
                Some(format!("its mass centre is `{}`", names(own()?, ["centre", "point"])?))
            }
            ("a point", Symbol::Frame(_)) if name == "N" => Some("`O` is a point fixed in it".to_owned()),
            ("a point", Symbol::Frame(_)) => {
                let body = with(["frame", "frame"]).into_iter().next()?;
                let record = records().find(|record| format!("`{}`", record.name.text) == body)?;
                let centre = names(record, ["centre", "point"])?;
                Some(format!("the mass centre of its body {body} is `{centre}`"))
            }
            ("a frame or body", Symbol::Point(_)) => {
                let mut bodies = self.tree.bodies.iter();
                let own = bodies.find(|body| names(body, ["centre", "centre"]).as_deref() == Some(name));
                Some(match own {
                    Some(body) => format!("it is the mass centre of the body `{}`", body.name.text),
                    None => "name the body that it belongs to, or its frame".to_owned(),
                })
            }
            ("a frame", Symbol::Body(_)) => {
                Some(format!("its frame is `{}`", names(own()?, ["frame", "frame"])?))
            }
            ("a body", symbol @ (Symbol::Frame(_) | Symbol::Point(_))) => {
                let is_frame = matches!(symbol, Symbol::Frame(_));
                let fields = if is_frame { ["frame", "frame"] } else { ["centre", "point"] };
                let kind = if is_frame { "frame" } else { "mass centre" };
                match &with(fields)[..] {
                    [] if is_frame => Some(
                        "no body has this frame: leave `of` out, or declare a body that has it".to_owned(),
                    ),
                    [] => None,
                    [body] => Some(format!("it is the {kind} of the body {body}")),
                    several => Some(format!("it is the {kind} of the bodies {}", several.join(", "))),
                }
            }
            _ => None,
        }
    }
}

/// The message about a name that is not declared.
pub(super) fn unknown_name(name: &str) -> String {
    format!("unknown name `{name}`")
}
