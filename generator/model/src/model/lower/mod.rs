//! Lowers a syntax tree to a [`Mechanism`]: resolves all names, checks all dimensions, collects all mistakes.

mod axes;
mod balances;
mod blame;
mod bodies;
mod calls;
mod contacts;
mod declarations;
mod definitions;
mod dimensions;
mod equations;
mod expressions;
mod frames;
mod initial;
mod loads;
mod points;
mod products;
mod quantities;
mod rates;
mod requirements;
mod resolve;
mod shapes;
mod sums;
mod surfaces;
mod table;
mod turning;
mod vanishing;

use std::collections::HashSet;

use super::dependency_order::{Item, Stated, order};
use super::hulls::Hulls;
use super::mechanism::*;
use super::names::Names;
use super::readable::Readable;
use super::symbols::{Places, Symbols};
use super::typed::{Traits, Typed, TypedValue};
use crate::diagnostics::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::tree::{Declaration, Tree};
use crate::syntax::units::Unit;
use balances::Balances;

/// Lowers a tree, of whose polytopes the hulls are known where they are needed. The mechanism is complete only if no error was reported; what of it can be relied on
/// otherwise is said beside it.
pub fn lower(tree: &Tree, hulls: &Hulls, diagnostics: Vec<Diagnostic>) -> Lowered {
    let mut diagnostics = diagnostics;
    if let Some(error) = tree.name.as_ref().and_then(super::names::reserved) {
        diagnostics.push(error);
    }
    let names = Names::collect(tree, hulls, &mut diagnostics);
    let plan = order(tree, &names, &mut diagnostics);
    let mut lowering = Lowering::new(tree, hulls, names, diagnostics);
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
    let value = |(source, read): (&Declaration, &Variable)| {
        source.value.is_none() || read.value.is_some() || read.initial.is_some()
    };
    let initial_values =
        !tree.incomplete && tree.coordinates.iter().zip(&lowering.out.coordinates).all(value);
    let motion = lowering.mistakes() == 0;
    lowering.readable = Readable { motion, initial_values, frames, ..Readable::default() };
    // what is wrong with these does not touch the motion
    let motion = lowering.balances.incomplete;
    lowering.bodies();
    lowering.shapes();
    lowering.masses_of_shapes();
    lowering.loads();
    lowering.balances.incomplete = motion;
    lowering.equations();
    lowering.contacts();
    lowering.gather();
    lowering.copied();
    lowering.unused();
    lowering.without_gap();
    let symbols = lowering.table();
    let Lowering { out: mechanism, readable, diagnostics, .. } = lowering;
    Lowered { mechanism, readable, diagnostics, symbols }
}

/// What a tree means.
pub struct Lowered {
    /// the mechanism; complete only if no error was reported
    pub mechanism: Mechanism,
    /// what of it can be relied on
    pub readable: Readable,
    /// all mistakes so far
    pub diagnostics: Vec<Diagnostic>,
    /// its names and their places
    pub symbols: Symbols,
}

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
    /// it has no axes of its own: it, or a frame that it is oriented in, is made by `spin`
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

/// The state of lowering.
pub(super) struct Lowering<'a> {
    pub tree: &'a Tree,
    /// the hulls of the polytopes that need them
    pub hulls: &'a Hulls,
    pub stated: Stated<'a>,
    pub names: Names,
    pub diagnostics: Vec<Diagnostic>,
    /// what is used, read and demanded at places of the text
    pub(in crate::model) places: Places,
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
    /// so many of `x`, `y` and `z` stand for a place along a surface
    pub along_surface: usize,
    /// what is found out about dimensions
    pub(in crate::model::lower) balances: Balances,
    /// what of the mechanism could be read
    pub readable: Readable,
}

impl<'a> Lowering<'a> {
    fn new(tree: &'a Tree, hulls: &'a Hulls, names: Names, diagnostics: Vec<Diagnostic>) -> Self {
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
            shapes: Vec::new(),
        };
        Lowering {
            tree,
            hulls,
            stated: Stated::of(tree),
            names,
            diagnostics,
            places: Places::default(),
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
            along_surface: 0,
            balances: Balances::default(),
            readable: Readable::default(),
        }
    }

    /// How many mistakes there are so far that leave the meaning of something open: what adds one is not to
    /// be relied on.
    pub fn mistakes(&self) -> usize {
        self.diagnostics.iter().filter(|diagnostic| diagnostic.hides_meaning()).count()
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub fn error(&mut self, code: Code, span: Span, message: impl Into<String>) {
        self.report(Diagnostic::new(code, span, message));
    }

    /// Items of a cycle: nothing more is said of them, or of what rests on them.
    fn give_up(&mut self, item: Item) {
        match item {
            Item::Orientation(i) => self.frames[i].broken = true,
            Item::Position(i) => self.points[i].broken = true,
            Item::Definition(_) | Item::AngularVelocity(_) | Item::Velocity(_) => {}
        }
    }
}
