//! Which words of a stretch of a model are names: those that it declares, and those that it refers to. The
//! others are words of the grammar: fields, functions, axes, units.

use std::collections::HashMap;

use crate::span::Span;
use crate::syntax::tree::{Declaration, Equation, Expr, ExprKind, Field, Name, Record, Tree};
use crate::words;

/// What is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Kind {
    Parameter,
    Input,
    Coordinate,
    Speed,
    Definition,
    Frame,
    Point,
    Body,
    Shape,
    Contact,
}

impl Kind {
    /// With its article, for messages.
    pub fn describe(self) -> &'static str {
        match self {
            Kind::Parameter => "a parameter",
            Kind::Input => "an input",
            Kind::Coordinate => "a coordinate",
            Kind::Speed => "a speed",
            Kind::Definition => "a definition",
            Kind::Frame => "a frame",
            Kind::Point => "a point",
            Kind::Body => "a body",
            Kind::Shape => "a shape",
            Kind::Contact => "a contact",
        }
    }
}

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// it declares a name
    Declared(Kind),
    /// it refers to a name
    Reference,
}

/// The names of a tree, by the place at which they begin.
pub fn roles(tree: &Tree) -> HashMap<u32, Role> {
    let mut roles = Roles::default();
    // whoever adds to the tree says here which of it are names
    let Tree {
        docs: _,
        name: _,
        parameters,
        inputs,
        coordinates,
        speeds,
        dependent,
        definitions,
        frames,
        angular_velocities,
        points,
        velocities,
        bodies,
        particles,
        shapes,
        loads,
        kinematics,
        constraints,
        configuration,
        contacts,
        broken: _,
        doubtful: _,
        incomplete: _,
        sections: _,
    } = tree;
    roles.quantities(parameters, Kind::Parameter);
    roles.quantities(inputs, Kind::Input);
    roles.quantities(coordinates, Kind::Coordinate);
    roles.quantities(speeds, Kind::Speed);
    roles.quantities(dependent, Kind::Speed);
    for definition in definitions {
        roles.declares(&definition.name, Kind::Definition);
        roles.expression(&definition.value);
    }
    for frame in frames {
        roles.declares(&frame.name, Kind::Frame);
        roles.expression(&frame.value);
    }
    for statement in angular_velocities {
        roles.refers(statement.frame.span);
        statement.within.iter().for_each(|name| roles.refers(name.span));
        roles.expression(&statement.value);
    }
    for point in points {
        roles.declares(&point.name, Kind::Point);
        point.of.iter().for_each(|name| roles.refers(name.span));
        roles.expression(&point.value);
    }
    for statement in velocities {
        roles.refers(statement.point.span);
        roles.expression(&statement.value);
    }
    roles.records(bodies, Kind::Body);
    roles.records(particles, Kind::Body);
    for shape in shapes {
        roles.declares(&shape.name, Kind::Shape);
        shape.fields.iter().for_each(|field| roles.dimension(field));
    }
    roles.records(contacts, Kind::Contact);
    for load in loads {
        load.ends.iter().for_each(|(_, name)| roles.refers(name.span));
        load.about.iter().chain(&load.value).for_each(|value| roles.expression(value));
        roles.fields(&load.fields);
    }
    for equations in [kinematics, constraints, configuration] {
        equations.iter().for_each(|equation| roles.equation(equation));
    }
    roles.found
}

#[derive(Default)]
struct Roles {
    found: HashMap<u32, Role>,
    /// coordinates of a place: they are words here
    own: &'static [&'static str],
}

/// Words that a field takes in place of a name.
const CHOICES: [&str; 3] = ["law", "gap", "colour"];

impl Roles {
    fn declares(&mut self, name: &Name, kind: Kind) {
        self.found.insert(name.span.start, Role::Declared(kind));
    }

    fn refers(&mut self, span: Span) {
        self.found.insert(span.start, Role::Reference);
    }

    fn quantities(&mut self, list: &[Declaration], kind: Kind) {
        for quantity in list {
            self.declares(&quantity.name, kind);
            quantity.value.iter().for_each(|value| self.expression(value));
        }
    }

    fn records(&mut self, list: &[Record], kind: Kind) {
        for record in list {
            self.declares(&record.name, kind);
            self.fields(&record.fields);
        }
    }

    fn fields(&mut self, fields: &[Field]) {
        for field in fields {
            let is_choice = CHOICES.contains(&field.name.text.as_str())
                && matches!(&field.value.kind, ExprKind::Name(word) if field.name.text != "gap" || word == "none");
            if !is_choice {
                self.expression(&field.value);
            }
            field.notes.iter().filter_map(|note| note.name.as_ref()).for_each(|name| self.refers(name.span));
            field.fields.iter().for_each(|fields| self.fields(fields));
        }
    }

    /// A field of a shape. In the expression of a surface, a curve or an implicit surface `x`, `y` and `z` are coordinates
    /// of its own.
    fn dimension(&mut self, field: &Field) {
        let own = words::places(&field.name.text);
        if own.is_empty() {
            return self.fields(std::slice::from_ref(field));
        }
        let mut inner = Roles { own, ..Roles::default() };
        inner.expression(&field.value);
        self.found.extend(inner.found);
    }

    fn equation(&mut self, equation: &Equation) {
        self.expression(&equation.left);
        self.expression(&equation.right);
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Error | ExprKind::Number(_) => {}
            ExprKind::Name(name) if self.own.contains(&name.as_str()) => {}
            ExprKind::Name(_) => self.refers(expr.span),
            ExprKind::Sum(terms) | ExprKind::Product(terms) => {
                terms.iter().for_each(|(_, term)| self.expression(term));
            }
            ExprKind::Power(base, exponent) => {
                self.expression(base);
                self.expression(exponent);
            }
            ExprKind::Neg(inner) | ExprKind::Rate(inner) => self.expression(inner),
            ExprKind::Call(_, items) | ExprKind::List(items) => {
                items.iter().for_each(|item| self.expression(item));
            }
            ExprKind::Field(base, _) => self.expression(base),
            ExprKind::Method(base, method, arguments) => {
                self.expression(base);
                // the axes of rotations are words
                let axes = ["rotate", "euler", "space"].contains(&method.text.as_str());
                let is_word = |argument: &Expr| match &argument.kind {
                    ExprKind::Name(_) => true,
                    ExprKind::Neg(inner) => matches!(inner.kind, ExprKind::Name(_)),
                    _ => false,
                };
                let words = usize::from(axes && arguments.first().is_some_and(is_word));
                arguments[words..].iter().for_each(|argument| self.expression(argument));
            }
        }
    }
}
