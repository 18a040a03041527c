//! Lowers a syntax tree to a [`Mechanism`]: resolves all names, checks all dimensions, collects all mistakes.

mod balances;
mod blame;
mod bodies;
mod calls;
mod contacts;
mod dimensions;
mod equations;
mod expressions;
mod frames;
mod loads;
mod points;
mod quantities;
mod rates;

use std::collections::HashSet;

use super::dependency_order::{Item, Stated, order};
use super::mechanism::*;
use super::names::{Names, Symbol};
use super::provenance::Provenance;
use super::readable::Readable;
use super::typed::{Traits, Typed, TypedValue};
use crate::diagnostics::{Code, Diagnostic, Label, codes};
use crate::letters;
use crate::span::Span;
use crate::syntax::tree::{Declaration, ExprKind, Name, Tree};
use crate::syntax::units::{self, Unit};
use crate::vocabulary;
use balances::Balances;

/// Lowers a tree. The mechanism is complete only if no error was reported; what of it can be relied on otherwise is said beside it.
pub fn lower(tree: &Tree, diagnostics: Vec<Diagnostic>) -> (Mechanism, Readable, Vec<Diagnostic>) {
    let mut diagnostics = diagnostics;
    if let Some(error) = tree.name.as_ref().and_then(super::names::reserved) {
        diagnostics.push(error);
    }
    let names = Names::collect(tree, &mut diagnostics);
    let plan = order(tree, &names, &mut diagnostics);
    let mut lowering = Lowering::new(tree, names, diagnostics);
    lowering.quantities();
    lowering.declarations();
    for item in plan.items {
        if plan.cyclic.contains(&item) {
            lowering.give_up(item);
            continue;
        }
        match item {
            Item::Definition(i) => lowering.definition(i),
            Item::Orientation(i) => lowering.orientation(i),
            Item::AngularVelocity(i) => lowering.angular_velocity(i),
            Item::Position(i) => lowering.position(i),
            Item::Velocity(i) => lowering.velocity(i),
        }
    }
    let frames = lowering.frames.iter().map(|frame| !frame.broken).collect();
    let value = |(source, read): (&Declaration, &Variable)| source.value.is_none() || read.value.is_some();
    let initial_values =
        !tree.incomplete && tree.coordinates.iter().zip(&lowering.out.coordinates).all(value);
    let motion = lowering.mistakes() == 0;
    lowering.readable = Readable { motion, initial_values, frames, ..Readable::default() };
    // what is wrong with these does not touch the motion
    let motion = lowering.balances.incomplete;
    lowering.bodies();
    lowering.loads();
    lowering.balances.incomplete = motion;
    lowering.equations();
    lowering.contacts();
    lowering.gather();
    lowering.copied();
    lowering.unused();
    (lowering.out, lowering.readable, lowering.diagnostics)
}

/// At most this number of unknown names is compared with the declared ones.
const MAX_SUGGESTIONS: usize = 20;

/// What is known of a quantity besides what the mechanism holds.
pub(super) struct QuantityFacts {
    /// its unit; `None` where that is a mistake
    pub unit: Option<Unit>,
    /// the exact value of a `fixed` parameter
    pub fixed: Option<Typed>,
}

/// What is known of a definition.
#[derive(Clone, Default)]
pub(super) struct DefinitionFacts {
    /// its value; `None` where that is a mistake
    pub typed: Option<Typed>,
}

/// What is known of a frame.
#[derive(Clone, Default)]
pub(super) struct FrameFacts {
    /// it could not be read: what rests on it is no further mistake
    pub broken: bool,
    /// it has axes: neither itself nor what it is oriented in is made by `spin`
    pub no_axes: bool,
    /// on what its orientation depends
    pub orientation: Traits,
    /// on what its angular velocity in N depends
    pub angular_velocity: Traits,
}

/// What is known of a point.
#[derive(Clone, Default)]
pub(super) struct PointFacts {
    /// it could not be read: what rests on it is no further mistake
    pub broken: bool,
    /// the point from which its position is known: O, or a point known by its velocity only
    pub root: usize,
    /// on what its position from there depends
    pub position: Traits,
    /// on what its velocity depends
    pub velocity: Traits,
}

fn unknown_name(name: &str) -> String {
    format!("unknown name `{name}`")
}

/// The state of lowering.
pub(super) struct Lowering<'a> {
    pub tree: &'a Tree,
    pub stated: Stated<'a>,
    pub names: Names,
    pub diagnostics: Vec<Diagnostic>,
    pub used: HashSet<Symbol>,
    /// coordinates of quaternions whose units are wrong: their frames say nothing of their rates
    pub unread_quaternions: HashSet<usize>,
    /// unknown names that are reported already
    pub unknown: HashSet<String>,
    pub out: Mechanism,
    pub parameters: Vec<QuantityFacts>,
    pub inputs: Vec<QuantityFacts>,
    pub coordinates: Vec<QuantityFacts>,
    pub speeds: Vec<QuantityFacts>,
    pub definitions: Vec<DefinitionFacts>,
    pub frames: Vec<FrameFacts>,
    pub points: Vec<PointFacts>,
    /// only numbers and functions are allowed
    pub constant_only: bool,
    /// what is found out about dimensions
    pub(in crate::model::lower) balances: Balances,
    /// what of the mechanism could be read
    pub readable: Readable,
}

impl<'a> Lowering<'a> {
    fn new(tree: &'a Tree, names: Names, diagnostics: Vec<Diagnostic>) -> Self {
        let out = Mechanism {
            name: tree.name.as_ref().map_or(String::new(), |name| name.text.clone()),
            docs: tree.docs.clone(),
            parameters: Vec::new(),
            inputs: Vec::new(),
            coordinates: Vec::new(),
            speeds: Vec::new(),
            definitions: Vec::new(),
            frames: Vec::new(),
            points: Vec::new(),
            bodies: Vec::new(),
            loads: Vec::new(),
            kinematics: Vec::new(),
            constraints: Vec::new(),
            determining_constraints: None,
            configuration: Vec::new(),
            contacts: Vec::new(),
        };
        Lowering {
            tree,
            stated: Stated::of(tree),
            names,
            diagnostics,
            used: HashSet::new(),
            unread_quaternions: HashSet::new(),
            unknown: HashSet::new(),
            out,
            parameters: Vec::new(),
            inputs: Vec::new(),
            coordinates: Vec::new(),
            speeds: Vec::new(),
            definitions: vec![DefinitionFacts::default(); tree.definitions.len()],
            frames: vec![FrameFacts::default(); tree.frames.len() + 1],
            points: vec![PointFacts::default(); tree.points.len() + 1],
            constant_only: false,
            balances: Balances::default(),
            readable: Readable::default(),
        }
    }

    /// How many mistakes there are so far that leave the meaning of something open: what adds one is not to be relied on.
    pub fn mistakes(&self) -> usize {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.hides_meaning()).count()
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub fn error(&mut self, code: Code, span: Span, message: impl Into<String>) {
        self.report(Diagnostic::new(code, span, message));
    }

    /// Places for everything, so that ids are in range whatever goes wrong later.
    fn declarations(&mut self) {
        let nowhere = Span::default();
        for definition in &self.tree.definitions {
            self.out.definitions.push(Definition {
                name: definition.name.text.clone(),
                docs: definition.docs.clone(),
                value: DefinitionValue::Vector(Vector::Zero),
                span: definition.name.span,
            });
        }
        let frame = |name: &str, docs: &str, span, orientation_span, motion_span| Frame {
            name: name.to_owned(),
            docs: docs.to_owned(),
            parent: None,
            orientation: Orientation::Aligned,
            angular_velocity: None,
            span,
            orientation_span,
            motion_span,
        };
        self.out.frames.push(frame("N", "", nowhere, nowhere, nowhere));
        for f in &self.tree.frames {
            let stated = self.stated.angular_velocities.get(f.name.text.as_str());
            let motion = stated.map_or(f.name.span, |stated| stated.frame.span);
            self.out.frames.push(frame(&f.name.text, &f.docs, f.name.span, f.value.span, motion));
        }
        let point = |name: &str, docs: &str, span, motion_span| Point {
            name: name.to_owned(),
            docs: docs.to_owned(),
            place: Place::Origin,
            velocity: None,
            span,
            motion_span,
        };
        self.out.points.push(point("O", "", nowhere, nowhere));
        for p in &self.tree.points {
            let stated = self.stated.velocities.get(p.name.text.as_str());
            let motion = stated.map_or(p.name.span, |stated| stated.point.span);
            self.out.points.push(point(&p.name.text, &p.docs, p.name.span, motion));
        }
        self.stated_motions();
    }

    /// What is stated of the motion of frames and points must name some, and each once.
    fn stated_motions(&mut self) {
        let tree = self.tree;
        let mut seen: std::collections::HashMap<&str, Span> = std::collections::HashMap::new();
        for name in tree.angular_velocities.iter().map(|a| &a.frame) {
            self.frame_named(name);
            if let Some(first) = seen.insert(&name.text, name.span) {
                let message = format!("the angular velocity of `{}` is stated twice", name.text);
                self.report(
                    Diagnostic::new(codes::MOTION_TWICE, name.span, message).related(first, "first here"),
                );
            }
        }
        seen.clear();
        for name in tree.velocities.iter().map(|v| &v.point) {
            self.point_named(name);
            if let Some(first) = seen.insert(&name.text, name.span) {
                let message = format!("the velocity of `{}` is stated twice", name.text);
                self.report(
                    Diagnostic::new(codes::MOTION_TWICE, name.span, message).related(first, "first here"),
                );
            }
        }
    }

    /// `l1: m = 1, l1: m = 2` where `l2` is used: a declaration was copied, and its name not changed. That is one mistake.
    fn copied(&mut self) {
        let mut names = self.names.ambiguous();
        let (Some(twice), None) = (names.next(), names.next()) else { return };
        if self.unknown.len() > MAX_SUGGESTIONS {
            return;
        }
        let mut unknown = self.unknown.iter().filter(|unknown| self.names.is_near(unknown, twice));
        let (Some(unknown), None) = (unknown.next(), unknown.next()) else { return };
        let message = unknown_name(unknown);
        let at = |code: Code| self.diagnostics.iter().position(|error| error.code == code);
        let used = self.diagnostics.iter().position(|error| error.message == message);
        if let (Some(declared), Some(used)) = (at(codes::DUPLICATE_NAME), used) {
            let help = format!("is `{unknown}` meant, which is used, but not declared?");
            let use_of_it =
                Label { span: self.diagnostics[used].primary.span, text: format!("`{unknown}` stands here") };
            let error = &mut self.diagnostics[declared];
            error.help = Some(help);
            error.related.push(use_of_it);
            self.diagnostics.remove(used);
        }
    }

    /// Items of a cycle: nothing more is said of them, or of what rests on them.
    fn give_up(&mut self, item: Item) {
        match item {
            Item::Orientation(i) => self.frames[i].broken = true,
            Item::Position(i) => self.points[i].broken = true,
            Item::Definition(_) | Item::AngularVelocity(_) | Item::Velocity(_) => {}
        }
    }

    /// The value of a definition.
    fn definition(&mut self, i: usize) {
        let source = &self.tree.definitions[i];
        let mut typed = self.expression(&source.value);
        if let Some(stated) = &source.unit
            && let Some(unit) = self.unit(stated)
        {
            match typed.dimension {
                None => typed.dimension = Some(unit.dimension),
                Some(dimension) if dimension != unit.dimension => {
                    let message = format!(
                        "`{}` is stated in {}, but its value is in {dimension}",
                        source.name.text, unit.text
                    );
                    let mut error = Diagnostic::new(codes::DIMENSION, source.value.span, message)
                        .related(stated.span, "stated here");
                    if typed.constant.is_some() {
                        error = error.help(format!(
                            "a plain number has no unit; declare a parameter `fixed {}: {} = ..`",
                            source.name.text, unit.text
                        ));
                    }
                    let says = format!("its value is in {dimension}");
                    let provenance = Provenance::of(Symbol::Definition(i)).over(&typed.provenance);
                    self.contradiction(error, provenance, dimension.over(&unit.dimension), says);
                    typed.dimension = Some(unit.dimension);
                }
                Some(_) => self.agreement(Provenance::of(Symbol::Definition(i)).over(&typed.provenance)),
            }
            typed.provenance = Provenance::of(Symbol::Definition(i));
        } else {
            typed.provenance = typed.provenance.times(&Provenance::of(Symbol::Definition(i)));
        }
        let value = match &typed.value {
            TypedValue::Scalar(scalar) => DefinitionValue::Scalar(scalar.clone()),
            TypedValue::Vector(vector) => DefinitionValue::Vector(vector.clone()),
            TypedValue::Poison => return,
        };
        self.out.definitions[i].value = value;
        self.definitions[i].typed = Some(typed);
    }

    /// Resolves a name; reports it if unknown. `fits` says what may be suggested instead.
    pub fn resolve(&mut self, name: &Name, fits: impl Fn(Symbol) -> bool) -> Option<Symbol> {
        match self.names.get(&name.text) {
            Some(Symbol::Broken) => return None,
            Some(symbol) => {
                self.used.insert(symbol);
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
            self.report(error.help(advice));
            return None;
        }
        // comparing spellings is slow; nobody reads so many suggestions
        let near =
            if self.unknown.len() <= MAX_SUGGESTIONS { self.names.nearest(&name.text, fits) } else { None };
        if near.is_none() && units::is_symbol(&name.text) && name.text.chars().count() > 1 {
            self.report(error.help(format!(
                "units stand in declarations only: declare a quantity in it, as in `a: {} = ..`",
                name.text
            )));
            return None;
        }
        let error = match near {
            Some(near) => {
                let help = format!("did you mean `{near}`?");
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
        if let Some(found) = letters::lookalike(text)
            && self.names.get(&found.latin).is_some()
        {
            return Some((found.advice(), self.names.place(&found.latin)));
        }
        // as for suggestions, nobody reads so many
        if self.unknown.len() > MAX_SUGGESTIONS {
            return None;
        }
        let (other, found) = self.names.all().find_map(|other| {
            letters::lookalike(other)
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
                let frame = super::dependency_order::body_frame(self.tree, b);
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
                let records = self.tree.bodies.iter().chain(&self.tree.particles);
                let centre = records.filter(|record| record.name.text == name.text).find_map(|record| {
                    let field =
                        record.fields.iter().find(|f| matches!(f.name.text.as_str(), "centre" | "point"))?;
                    if let ExprKind::Name(centre) = &field.value.kind { Some(centre.clone()) } else { None }
                });
                if let (Symbol::Body(_), Some(centre), Some(error)) =
                    (other, centre, self.diagnostics.last_mut())
                {
                    error.help = Some(format!("its mass centre is `{centre}`"));
                }
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
        self.report(error);
    }

    /// Demands a scalar.
    pub fn need_scalar(&mut self, typed: &Typed, what: &str) -> Option<Scalar> {
        match &typed.value {
            TypedValue::Scalar(scalar) => Some(scalar.clone()),
            TypedValue::Poison => None,
            TypedValue::Vector(_) => {
                let message = format!("{what} must be a scalar, but this is a vector");
                let error = Diagnostic::new(codes::SCALAR_VECTOR, typed.span, message)
                    .help("take a component with `dot(v, A.x)` or the magnitude with `norm(v)`");
                self.report(error);
                None
            }
        }
    }

    /// Demands a vector; the number 0 is one.
    pub fn need_vector(&mut self, typed: &Typed, what: &str) -> Option<Vector> {
        match &typed.value {
            TypedValue::Vector(vector) => Some(vector.clone()),
            TypedValue::Poison => None,
            TypedValue::Scalar(_) if typed.is_zero() => Some(Vector::Zero),
            TypedValue::Scalar(_) => {
                let message = format!("{what} must be a vector, but this is a scalar");
                let error = Diagnostic::new(codes::SCALAR_VECTOR, typed.span, message)
                    .help("multiply it by an axis, for instance `s*N.x`, or write `A.vec(a, b, c)`");
                self.report(error);
                None
            }
        }
    }

    /// Demands that no speed enters.
    pub fn need_free_of_speeds(&mut self, typed: &Typed, what: &str) {
        if typed.traits.degree > 0 {
            let message = format!("{what} must not depend on speeds");
            let mut error = Diagnostic::new(codes::SPEED_DEPENDENT, typed.span, message);
            match typed.traits.speed_at {
                Some(place) if place != typed.span => {
                    error = error.related(place, "this is or contains a speed")
                }
                _ => error = error.label("this is or contains a speed"),
            }
            self.report(error);
        }
    }

    /// Demands that its rate is known.
    pub fn need_rate(&mut self, typed: &Typed, what: &str) {
        if let Some(place) = typed.traits.input {
            let message = format!("{what} must not depend on an input, whose rate is not known");
            let error = Diagnostic::new(codes::INPUT_MOVES, typed.span, message)
                .help("prescribe motion by `time` and parameters, or by a coordinate with its speed");
            self.report(if place == typed.span {
                error.label("this is or contains an input")
            } else {
                error.related(place, "this is or contains an input")
            });
        }
    }

    /// Demands that speeds enter linearly at most.
    pub fn need_linear(&mut self, typed: &Typed, what: &str) {
        if typed.traits.degree > 1 {
            let message = format!("{what} must be linear in the speeds");
            let mut error = Diagnostic::new(codes::NOT_LINEAR, typed.span, message);
            match typed.traits.speed_at {
                Some(place) if place != typed.span => {
                    error = error.related(place, "this does not enter linearly")
                }
                _ => error = error.label("this does not enter linearly"),
            }
            error = error.help("each term holds one speed at most, times a factor that is free of speeds");
            self.report(error);
        }
    }
}
