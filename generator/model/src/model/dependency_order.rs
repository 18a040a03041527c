//! The order in which definitions, frames and points can be resolved, each after those that it refers to;
//! reports cycles.

use std::collections::{HashMap, HashSet};

use super::names::{Names, Symbol};
use crate::diagnostics::{Diagnostic, codes};
use crate::span::Span;
use crate::syntax::tree::{AngularVelocity, Expr, ExprKind, Name, Tree, Velocity};

/// Something that must be understood before what refers to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// value of a definition
    Definition(usize),
    /// orientation of a frame
    Orientation(usize),
    /// angular velocity of a frame
    AngularVelocity(usize),
    /// position of a point
    Position(usize),
    /// velocity of a point
    Velocity(usize),
}

/// Names may refer to names that refer to names .. to this depth: four for each link of the longest chain of
/// links.
const MAX_CHAIN: usize = 600;

/// All items, each after those it refers to, and those that take part in a cycle.
pub struct Order {
    /// in order
    pub items: Vec<Item>,
    /// these are defined through themselves; reported
    pub cyclic: HashSet<Item>,
}

/// Finds the order. Names that are unknown are passed over here.
pub fn order(tree: &Tree, names: &Names, diagnostics: &mut Vec<Diagnostic>) -> Order {
    let graph = Graph { tree, names, stated: Stated::of(tree) };
    let counts = [tree.definitions.len(), tree.frames.len() + 1, tree.points.len() + 1];
    let mut all = Vec::new();
    all.extend((0..counts[0]).map(Item::Definition));
    all.extend((0..counts[1]).map(Item::Orientation));
    all.extend((0..counts[2]).map(Item::Position));
    all.extend((0..counts[1]).map(Item::AngularVelocity));
    all.extend((0..counts[2]).map(Item::Velocity));
    let mut depths: HashMap<Item, usize> = HashMap::new();
    let mut out = Order { items: Vec::new(), cyclic: HashSet::new() };
    let mut done: HashSet<Item> = HashSet::new();
    // one word about chains that are too long is enough
    let mut too_deep = false;
    // a walk with its own stack: chains of definitions may be long
    for start in all {
        if done.contains(&start) {
            continue;
        }
        let mut open: HashSet<Item> = HashSet::from([start]);
        let mut stack = vec![(start, graph.references(start), 0_usize)];
        while let Some((item, references, next)) = stack.last_mut() {
            let (item, next_reference) = (*item, references.get(*next).copied());
            *next += 1;
            let Some((reference, _)) = next_reference else {
                let deepest = references.iter().filter_map(|(r, _)| depths.get(r)).max().map_or(0, |d| d + 1);
                depths.insert(item, deepest);
                if deepest == MAX_CHAIN {
                    if !too_deep {
                        diagnostics.push(graph.too_deep(item));
                    }
                    too_deep = true;
                    out.cyclic.insert(item);
                }
                open.remove(&item);
                done.insert(item);
                out.items.push(item);
                stack.pop();
                continue;
            };
            if done.contains(&reference) {
                continue;
            }
            if open.insert(reference) {
                stack.push((reference, graph.references(reference), 0));
                continue;
            }
            let from = stack.iter().position(|(i, ..)| *i == reference).unwrap_or(0);
            let circle: Vec<(Item, Span)> =
                stack[from..].iter().filter_map(|(i, refs, n)| Some((*i, refs.get(*n - 1)?.1))).collect();
            // a motion that follows from positions in a cycle is no further mistake
            let place = |item: &Item| match item {
                Item::AngularVelocity(i) => Item::Orientation(*i),
                Item::Velocity(i) => Item::Position(*i),
                other => *other,
            };
            let known = |item: &Item| out.cyclic.contains(item) || out.cyclic.contains(&place(item));
            if !circle.iter().any(|(item, _)| known(item)) {
                diagnostics.push(graph.cycle(&circle));
            }
            out.cyclic.extend(circle.iter().map(|(item, _)| *item));
        }
    }
    out
}

/// Where the motion of a frame or a point is stated, by its name; of several statements the first.
pub struct Stated<'a> {
    /// angular velocities of frames
    pub angular_velocities: HashMap<&'a str, &'a AngularVelocity>,
    /// velocities of points
    pub velocities: HashMap<&'a str, &'a Velocity>,
}

impl<'a> Stated<'a> {
    /// All statements of a model.
    pub fn of(tree: &'a Tree) -> Self {
        let mut out = Stated { angular_velocities: HashMap::new(), velocities: HashMap::new() };
        for statement in &tree.angular_velocities {
            out.angular_velocities.entry(&statement.frame.text).or_insert(statement);
        }
        for statement in &tree.velocities {
            out.velocities.entry(&statement.point.text).or_insert(statement);
        }
        out
    }
}

struct Graph<'a> {
    tree: &'a Tree,
    names: &'a Names,
    stated: Stated<'a>,
}

impl Graph<'_> {
    fn cycle(&self, circle: &[(Item, Span)]) -> Diagnostic {
        let chain: Vec<String> = circle.iter().map(|(item, _)| self.name(*item)).collect();
        let (Some((_, place)), Some(first)) = (circle.last(), chain.first()) else {
            return Diagnostic::new(codes::CYCLE, Span::default(), "a cycle of definitions");
        };
        let message = if chain.len() == 1 {
            format!("{first} is defined through itself")
        } else if chain.len() <= 8 {
            format!("a cycle: {} -> {first}", chain.join(" -> "))
        } else {
            format!("a cycle of {} items: {} -> .. -> {first}", chain.len(), chain[..6].join(" -> "))
        };
        let mut error = Diagnostic::new(codes::CYCLE, *place, message);
        for ((_, place), names) in circle.iter().zip(chain.windows(2)).take(5) {
            error = error.related(*place, format!("{} refers to {} here", names[0], names[1]));
        }
        error.help("break the cycle: one of them must be defined without the others")
    }

    fn too_deep(&self, item: Item) -> Diagnostic {
        let span = match item {
            Item::Definition(i) => self.tree.definitions[i].name.span,
            Item::Orientation(i) | Item::AngularVelocity(i) => {
                i.checked_sub(1).map_or(Span::default(), |i| self.tree.frames[i].name.span)
            }
            Item::Position(i) | Item::Velocity(i) => {
                i.checked_sub(1).map_or(Span::default(), |i| self.tree.points[i].name.span)
            }
        };
        let message = format!("{} rests on a chain of more than {MAX_CHAIN} names", self.name(item));
        Diagnostic::new(codes::TOO_DEEP, span, message)
            .help("refer to names nearer to the beginning of the chain")
    }

    fn name(&self, item: Item) -> String {
        match item {
            Item::Definition(i) => format!("`{}`", self.tree.definitions[i].name.text),
            Item::Orientation(0) | Item::AngularVelocity(0) => "`N`".to_owned(),
            Item::Position(0) | Item::Velocity(0) => "`O`".to_owned(),
            Item::Orientation(i) => format!("`{}`", self.tree.frames[i - 1].name.text),
            Item::AngularVelocity(i) => format!("angular_velocity({})", self.tree.frames[i - 1].name.text),
            Item::Position(i) => format!("`{}`", self.tree.points[i - 1].name.text),
            Item::Velocity(i) => format!("velocity({})", self.tree.points[i - 1].name.text),
        }
    }

    fn references(&self, item: Item) -> Vec<(Item, Span)> {
        let mut found = Vec::new();
        match item {
            Item::Definition(i) => self.walk(&self.tree.definitions[i].value, &mut found),
            Item::Orientation(0) | Item::AngularVelocity(0) | Item::Position(0) | Item::Velocity(0) => {}
            Item::Orientation(i) => {
                let value = &self.tree.frames[i - 1].value;
                if let Some(base) = base_frame(value) {
                    self.frame(&base, Item::Orientation, &mut found);
                }
                if let ExprKind::Method(_, method, arguments) = &value.kind
                    && method.text != "spin"
                {
                    arguments.iter().for_each(|argument| self.walk(argument, &mut found));
                }
            }
            Item::AngularVelocity(i) => {
                let frame = &self.tree.frames[i - 1];
                let stated = self.stated.angular_velocities.get(frame.name.text.as_str());
                if let Some(stated) = stated {
                    if let Some(within) = &stated.within {
                        self.frame(within, Item::AngularVelocity, &mut found);
                    }
                    self.walk(&stated.value, &mut found);
                } else {
                    if let Some(base) = base_frame(&frame.value) {
                        self.frame(&base, Item::AngularVelocity, &mut found);
                    }
                    if let ExprKind::Method(_, _, arguments) = &frame.value.kind {
                        arguments.iter().for_each(|argument| self.walk(argument, &mut found));
                    }
                    found.push((Item::Orientation(i), frame.name.span));
                }
            }
            Item::Position(i) => {
                let point = &self.tree.points[i - 1];
                if !point.by_velocity {
                    self.walk(&point.value, &mut found);
                    self.origins(&point.value, Item::Position, &mut found);
                }
            }
            Item::Velocity(i) => self.velocity(i, &mut found),
        }
        found
    }

    fn velocity(&self, i: usize, found: &mut Vec<(Item, Span)>) {
        let point = &self.tree.points[i - 1];
        let stated = self.stated.velocities.get(point.name.text.as_str());
        if let Some(stated) = stated {
            return self.walk(&stated.value, found);
        }
        self.walk(&point.value, found);
        if point.by_velocity {
            return;
        }
        found.push((Item::Position(i), point.name.span));
        self.origins(&point.value, Item::Velocity, found);
        // the axes along which the position is stated turn
        let turning: Vec<(Item, Span)> = found
            .iter()
            .filter_map(|&(item, span)| match item {
                Item::Orientation(f) => Some((Item::AngularVelocity(f), span)),
                _ => None,
            })
            .collect();
        found.extend(turning);
        if let Some(of) = &point.of {
            let frame = match self.names.get(&of.text) {
                Some(Symbol::Body(b)) => body_frame(self.tree, b),
                _ => Some(of.clone()),
            };
            if let Some(frame) = frame {
                self.frame(&frame, Item::AngularVelocity, found);
            }
        }
    }

    /// The point from which another is placed, among the terms of its position.
    fn origins(&self, value: &Expr, item: fn(usize) -> Item, found: &mut Vec<(Item, Span)>) {
        let terms: Vec<&Expr> = match &value.kind {
            ExprKind::Sum(terms) => terms.iter().map(|(_, term)| term).collect(),
            _ => vec![value],
        };
        for term in terms {
            if let ExprKind::Name(name) = &term.kind
                && let Some(Symbol::Point(p)) = self.names.get(name)
            {
                found.push((item(p), term.span));
            }
        }
    }

    fn frame(&self, name: &Name, item: fn(usize) -> Item, found: &mut Vec<(Item, Span)>) {
        let symbol = match self.names.get(&name.text) {
            // a body stands for its frame
            Some(Symbol::Body(b)) => body_frame(self.tree, b).and_then(|frame| self.names.get(&frame.text)),
            symbol => symbol,
        };
        if let Some(Symbol::Frame(f)) = symbol {
            found.push((item(f), name.span));
        }
    }

    fn walk(&self, expr: &Expr, found: &mut Vec<(Item, Span)>) {
        match &expr.kind {
            ExprKind::Error | ExprKind::Number(_) => {}
            ExprKind::Name(name) => {
                if let Some(Symbol::Definition(d)) = self.names.get(name) {
                    found.push((Item::Definition(d), expr.span));
                }
            }
            ExprKind::Sum(items) | ExprKind::Product(items) => {
                items.iter().for_each(|(_, item)| self.walk(item, found));
            }
            ExprKind::Power(a, b) => {
                self.walk(a, found);
                self.walk(b, found);
            }
            ExprKind::Neg(inner) | ExprKind::Rate(inner) => self.walk(inner, found),
            ExprKind::List(items) => items.iter().for_each(|item| self.walk(item, found)),
            ExprKind::Field(base, _) => self.axes(base, found),
            ExprKind::Method(base, _, arguments) => {
                self.axes(base, found);
                arguments.iter().for_each(|argument| self.walk(argument, found));
            }
            ExprKind::Call(function, arguments) => {
                for argument in arguments {
                    let symbol = match &argument.kind {
                        ExprKind::Name(name) => self.names.get(name),
                        _ => None,
                    };
                    match (function.text.as_str(), symbol) {
                        ("position", Some(Symbol::Point(p))) => {
                            found.push((Item::Position(p), argument.span))
                        }
                        ("velocity", Some(Symbol::Point(p))) => {
                            found.push((Item::Velocity(p), argument.span))
                        }
                        ("angular_velocity", Some(Symbol::Frame(f))) => {
                            found.push((Item::AngularVelocity(f), argument.span));
                        }
                        ("angular_velocity", Some(Symbol::Body(b))) => {
                            if let Some(frame) = body_frame(self.tree, b) {
                                self.frame(&frame, Item::AngularVelocity, found);
                            }
                        }
                        _ => self.walk(argument, found),
                    }
                }
            }
        }
    }

    fn axes(&self, base: &Expr, found: &mut Vec<(Item, Span)>) {
        match &base.kind {
            ExprKind::Name(name) => {
                if let Some(Symbol::Frame(f)) = self.names.get(name) {
                    found.push((Item::Orientation(f), base.span));
                }
            }
            _ => self.walk(base, found),
        }
    }
}

/// The frame in which a frame is oriented, as written.
pub fn base_frame(value: &Expr) -> Option<Name> {
    let base = match &value.kind {
        ExprKind::Method(base, ..) => base,
        _ => value,
    };
    match &base.kind {
        ExprKind::Name(name) => Some(Name { text: name.clone(), span: base.span }),
        _ => None,
    }
}

/// The name of the frame of a body, as written.
pub fn body_frame(tree: &Tree, body: usize) -> Option<Name> {
    let field = tree.bodies.get(body)?.fields.iter().find(|field| field.name.text == "frame")?;
    match &field.value.kind {
        ExprKind::Name(name) => Some(Name { text: name.clone(), span: field.value.span }),
        _ => None,
    }
}
