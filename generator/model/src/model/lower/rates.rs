//! Finds the coordinates whose rates appear in the kinematical equations, and adds `d(q..)/dt = u..` for the
//! others.

use std::collections::HashMap;

use super::super::mechanism::*;
use super::super::names::{Symbol, speeds_of};
use super::super::provenance::Provenance;
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;

/// A set of coordinates.
#[derive(Clone, Default)]
struct Set(Vec<bool>);

impl Set {
    fn insert(&mut self, i: usize) {
        if self.0.len() <= i {
            self.0.resize(i + 1, false);
        }
        self.0[i] = true;
    }

    fn extend(&mut self, other: &Set) {
        for (i, _) in other.0.iter().enumerate().filter(|(_, there)| **there) {
            self.insert(i);
        }
    }

    fn contains(&self, i: usize) -> bool {
        self.0.get(i).copied().unwrap_or(false)
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    /// coordinates in a definition
    Definition(usize),
    /// rates in a definition
    DefinitionRates(usize),
    /// coordinates in the orientation of a frame in N
    Orientation(usize),
    /// rates in the angular velocity of a frame in N
    Turning(usize),
    /// coordinates in the position of a point
    Position(usize),
    /// rates in the velocity of a point
    Velocity(usize),
}

impl Lowering<'_> {
    /// Adds `d(q..)/dt = u..` for the coordinates of whose rates no equation speaks.
    pub(super) fn default_rates(&mut self) {
        // with mistakes in the motion, what is missing may only be hidden; a cycle would not end
        let hides = |d: &Diagnostic| d.hides_meaning() && d.code != codes::DIMENSION;
        let unclear = self.balances.incomplete || self.diagnostics.iter().any(hides);
        if unclear && !self.readable.motion {
            return;
        }
        let mut walk = Walk { mechanism: &self.out, known: HashMap::new() };
        let mut stated = Set::default();
        for equation in &self.out.kinematics {
            walk.equation_rates(equation, &mut stated);
        }
        for (i, frame) in self.out.frames.iter().enumerate() {
            if let Some((within, value)) = &frame.angular_velocity {
                walk.relative_orientation(i, within.0, &mut stated);
                walk.vector_rates(value, &mut stated);
            }
        }
        for point in &self.out.points {
            if let (Some(_), Place::Offset { from, by } | Place::Material { from, by, .. }) =
                (&point.velocity, &point.place)
            {
                walk.vector_coordinates(by, &mut stated);
                let rates = walk.get(Key::Velocity(from.0));
                stated.extend(&rates);
            }
        }
        let mut defaults = Vec::new();
        let mut missing = Vec::new();
        for (i, coordinate) in self.out.coordinates.iter().enumerate() {
            if stated.contains(i) || self.unread_quaternions.contains(&i) {
                continue;
            }
            let named = speeds_of(&coordinate.name).find_map(|speed| match self.names.get(&speed) {
                Some(Symbol::Speed(speed)) => Some(speed),
                _ => None,
            });
            match named {
                Some(speed) => defaults.push((i, speed)),
                None => missing.push((i, speeds_of(&coordinate.name).next())),
            }
        }
        self.without_rate(&missing);
        for (i, speed) in defaults {
            let second = Dimension::of(0, 0, 1);
            let units = (&self.coordinates[i].unit, &self.speeds[speed].unit);
            let (coordinate, rate) = (self.out.coordinates[i].clone(), self.out.speeds[speed].clone());
            if let (Some(q), Some(u)) = units {
                let provenance =
                    Provenance::of(Symbol::Speed(speed)).over(&Provenance::of(Symbol::Coordinate(i)));
                let needed = q.dimension.over(&second);
                if needed == Some(u.dimension) {
                    self.agreement(provenance);
                } else {
                    let message = format!(
                        "without another equation `d({})/dt = {}` is assumed, but the units do not agree",
                        coordinate.name, rate.name
                    );
                    let error = Diagnostic::new(codes::DIMENSION, rate.span, message)
                        .label(format!("this is in {}", rate.unit))
                        .related(coordinate.span, format!("this is in {}", coordinate.unit))
                        .help("state the kinematical equation, or correct a unit");
                    let missing = needed.and_then(|needed| needed.over(&u.dimension));
                    let says = format!("`d({})/dt = {}` is meant", coordinate.name, rate.name);
                    self.contradiction(error, provenance, missing, says);
                    continue;
                }
            }
            self.places.implied(Symbol::Coordinate(i));
            let sides = {
                let left = self.quantity_in_expression(Symbol::Coordinate(i), coordinate.span);
                let right = self.quantity_in_expression(Symbol::Speed(speed), rate.span);
                match (left.value, right.value) {
                    (super::TypedValue::Scalar(q), super::TypedValue::Scalar(u)) => {
                        EquationSides::Scalar(Scalar::Rate(Box::new(q)), u)
                    }
                    _ => continue,
                }
            };
            self.out.kinematics.push(Equation { sides, span: coordinate.span });
        }
    }
}

impl Lowering<'_> {
    /// The only speed that can be the rate of this coordinate by its unit, if nothing else is said of it.
    fn only_speed(&self, coordinate: usize) -> Option<&str> {
        let needed = self.coordinates[coordinate].unit.as_ref()?.dimension.over(&Dimension::of(0, 0, 1))?;
        let fits = |i: &usize| {
            let fits = self.speeds[*i].unit.as_ref().is_some_and(|unit| unit.dimension == needed);
            fits && !self.places.is_used(Symbol::Speed(*i))
        };
        let mut fitting = (0..self.speeds.len()).filter(fits);
        match (fitting.next(), fitting.next()) {
            (Some(speed), None) => Some(self.out.speeds[speed].name.as_str()),
            _ => None,
        }
    }

    /// Coordinates of whose rates nothing is said, with the speeds to which they might be equal: mostly one
    /// statement is missing.
    fn without_rate(&mut self, missing: &[(usize, Option<String>)]) {
        let Some(((first, _), others)) = missing.split_first() else { return };
        let coordinates: Vec<&Variable> = missing.iter().map(|(i, _)| &self.out.coordinates[*i]).collect();
        let shown = &coordinates[..coordinates.len().min(6)];
        let names: Vec<String> = shown.iter().map(|q| format!("`{}`", q.name)).collect();
        let message = match (&names[..], coordinates.len() - shown.len()) {
            ([name], _) => format!("the coordinate {name} has no kinematical equation"),
            ([names @ .., last], 0) => {
                format!("the coordinates {} and {last} have no kinematical equations", names.join(", "))
            }
            (names, more) => {
                format!("the coordinates {} and {more} more have no kinematical equations", names.join(", "))
            }
        };
        let meant = |(i, _): &(usize, Option<String>)| self.only_speed(*i);
        let speeds_meant: Vec<Option<&str>> = missing.iter().map(meant).collect();
        // a speed for each, or for none: one that fits two says nothing
        let mut once = std::collections::HashSet::new();
        let clear = speeds_meant.iter().flatten().all(|speed| once.insert(*speed));
        let rate = |(q, speed): (&&Variable, &Option<&str>)| {
            format!("d({})/dt = {};", q.name, speed.filter(|_| clear).unwrap_or(".."))
        };
        let rates: Vec<String> = shown.iter().zip(&speeds_meant).map(rate).collect();
        let known = clear && speeds_meant.iter().all(Option::is_some);
        let kinematics = format!("add `kinematics {{ {} }}`", rates.join(" "));
        let speeds: Option<Vec<String>> = missing.iter().map(|(_, speed)| speed.clone()).collect();
        let help = match speeds.as_deref() {
            _ if known => kinematics,
            Some([speed]) => format!("{kinematics}, or a speed `{speed}`, to which its rate is then equal"),
            Some(speeds) if speeds.len() == shown.len() => {
                format!(
                    "{kinematics}, or speeds `{}`, to which the rates are then equal",
                    speeds.join("`, `")
                )
            }
            _ => kinematics,
        };
        let mut error =
            Diagnostic::new(codes::NO_RATE, self.out.coordinates[*first].span, message).help(help);
        for (i, _) in others.iter().take(5) {
            error = error.related(self.out.coordinates[*i].span, "this has none either");
        }
        self.report(error);
    }
}

/// Walks expressions; what is behind a name is found once. Chains of frames and points may be long, so it is
/// found with a stack of its own, in `get`.
struct Walk<'a> {
    mechanism: &'a Mechanism,
    known: HashMap<Key, Set>,
}

impl Walk<'_> {
    /// The set of a key. What it needs is computed first, without recursion.
    fn get(&mut self, key: Key) -> Set {
        let mut stack = vec![key];
        while let Some(&top) = stack.last() {
            if self.known.contains_key(&top) {
                stack.pop();
                continue;
            }
            let mut out = Set::default();
            let mut needs = Vec::new();
            self.compute(top, &mut out, &mut needs);
            needs.retain(|need| !self.known.contains_key(need));
            if needs.is_empty() {
                self.known.insert(top, out);
                stack.pop();
            } else {
                stack.extend(needs);
            }
        }
        self.known.get(&key).cloned().unwrap_or_default()
    }

    fn take(&self, key: Key, out: &mut Set, needs: &mut Vec<Key>) {
        match self.known.get(&key) {
            Some(set) => out.extend(set),
            None => needs.push(key),
        }
    }

    fn compute(&self, key: Key, out: &mut Set, needs: &mut Vec<Key>) {
        let m = self.mechanism;
        match key {
            Key::Definition(i) | Key::DefinitionRates(i) => {
                let rates = matches!(key, Key::DefinitionRates(_));
                match &m.definitions[i].value {
                    DefinitionValue::Scalar(s) => self.scalar(s, rates, out, needs),
                    DefinitionValue::Vector(v) => self.vector(v, rates, out, needs),
                }
            }
            Key::Orientation(i) => {
                let frame = &m.frames[i];
                if let Some(parent) = frame.parent {
                    self.take(Key::Orientation(parent.0), out, needs);
                }
                self.orientation(&frame.orientation, out, needs);
            }
            Key::Turning(i) => {
                let frame = &m.frames[i];
                match (&frame.angular_velocity, frame.parent) {
                    (Some((within, value)), _) => {
                        self.take(Key::Turning(within.0), out, needs);
                        self.vector(value, true, out, needs);
                    }
                    (None, Some(parent)) => {
                        self.take(Key::Turning(parent.0), out, needs);
                        if let Orientation::Spin(value) = &frame.orientation {
                            self.vector(value, true, out, needs);
                        } else {
                            self.orientation(&frame.orientation, out, needs);
                        }
                    }
                    (None, None) => {}
                }
            }
            Key::Position(i) => {
                if let Place::Offset { from, by } | Place::Material { from, by, .. } = &m.points[i].place {
                    self.take(Key::Position(from.0), out, needs);
                    self.vector(by, false, out, needs);
                }
            }
            Key::Velocity(i) => {
                let point = &m.points[i];
                match (&point.velocity, &point.place) {
                    (Some(value), _) | (None, Place::Velocity(value)) => self.vector(value, true, out, needs),
                    (None, Place::Origin) => {}
                    (None, Place::Offset { from, by }) => {
                        self.take(Key::Velocity(from.0), out, needs);
                        self.moving(by, out, needs);
                    }
                    (None, Place::Material { frame, from, .. }) => {
                        self.take(Key::Velocity(from.0), out, needs);
                        self.take(Key::Turning(frame.0), out, needs);
                    }
                }
            }
        }
    }

    /// Rates in the derivative of a vector: those of all its coordinates, or where a frame's angular velocity
    /// is declared, those that its declaration speaks of. Taking both errs on the side of not adding an
    /// equation only where one is stated.
    fn moving(&self, vector: &Vector, out: &mut Set, needs: &mut Vec<Key>) {
        self.vector(vector, false, out, needs);
    }

    fn orientation(&self, orientation: &Orientation, out: &mut Set, needs: &mut Vec<Key>) {
        match orientation {
            Orientation::Aligned | Orientation::Spin(_) => {}
            Orientation::Simple { angle, .. } => self.scalar(angle, false, out, needs),
            Orientation::About { axis, angle } => {
                axis.iter().for_each(|c| self.scalar(c, false, out, needs));
                self.scalar(angle, false, out, needs);
            }
            Orientation::Euler { angles, .. } => {
                angles.iter().for_each(|a| self.scalar(a, false, out, needs))
            }
            Orientation::Quaternion(coordinates) => coordinates.iter().for_each(|c| out.insert(c.0)),
        }
    }

    /// Coordinates in a scalar, or (`rates`) the coordinates whose rates are in it.
    fn scalar(&self, scalar: &Scalar, rates: bool, out: &mut Set, needs: &mut Vec<Key>) {
        match scalar {
            Scalar::Number(_)
            | Scalar::Pi
            | Scalar::Time
            | Scalar::Parameter(_)
            | Scalar::Input(_)
            | Scalar::Speed(_) => {}
            Scalar::Coordinate(i) => {
                if !rates {
                    out.insert(i.0);
                }
            }
            Scalar::Definition(i) => {
                self.take(if rates { Key::DefinitionRates(i.0) } else { Key::Definition(i.0) }, out, needs);
            }
            Scalar::Rate(inner) => self.scalar(inner, false, out, needs),
            Scalar::Neg(inner) => self.scalar(inner, rates, out, needs),
            Scalar::Add(items) | Scalar::Mul(items) | Scalar::Call(_, items) => {
                items.iter().for_each(|item| self.scalar(item, rates, out, needs));
            }
            Scalar::Div(a, b, _) | Scalar::Pow(a, b) => {
                self.scalar(a, rates, out, needs);
                self.scalar(b, rates, out, needs);
            }
            Scalar::Dot(a, b) => {
                self.vector(a, rates, out, needs);
                self.vector(b, rates, out, needs);
            }
            Scalar::Norm(v) => self.vector(v, rates, out, needs),
        }
    }

    fn vector(&self, vector: &Vector, rates: bool, out: &mut Set, needs: &mut Vec<Key>) {
        match vector {
            Vector::Zero => {}
            Vector::Components(frame, components) => {
                components.iter().for_each(|c| self.scalar(c, rates, out, needs));
                if !rates {
                    self.take(Key::Orientation(frame.0), out, needs);
                }
            }
            Vector::Definition(i) => {
                self.take(if rates { Key::DefinitionRates(i.0) } else { Key::Definition(i.0) }, out, needs);
            }
            Vector::Neg(inner) | Vector::Unit(inner, _) => self.vector(inner, rates, out, needs),
            Vector::Add(items) => items.iter().for_each(|item| self.vector(item, rates, out, needs)),
            Vector::Scale(s, v) => {
                self.scalar(s, rates, out, needs);
                self.vector(v, rates, out, needs);
            }
            Vector::Cross(a, b) => {
                self.vector(a, rates, out, needs);
                self.vector(b, rates, out, needs);
            }
            Vector::Position { of, from } => {
                if !rates {
                    self.take(Key::Position(of.0), out, needs);
                    self.take(Key::Position(from.0), out, needs);
                }
            }
            Vector::Velocity(point) => self.take(Key::Velocity(point.0), out, needs),
            Vector::AngularVelocity { of, in_frame } => {
                self.take(Key::Turning(of.0), out, needs);
                self.take(Key::Turning(in_frame.0), out, needs);
            }
        }
    }

    /// Runs a walk until it needs nothing that is not known.
    fn complete(&mut self, out: &mut Set, run: impl Fn(&Self, &mut Set, &mut Vec<Key>)) {
        loop {
            let mut needs = Vec::new();
            run(self, out, &mut needs);
            if needs.is_empty() {
                return;
            }
            for need in needs {
                self.get(need);
            }
        }
    }

    fn vector_rates(&mut self, vector: &Vector, out: &mut Set) {
        self.complete(out, |walk, out, needs| walk.vector(vector, true, out, needs));
    }

    fn vector_coordinates(&mut self, vector: &Vector, out: &mut Set) {
        self.complete(out, |walk, out, needs| walk.vector(vector, false, out, needs));
    }

    fn equation_rates(&mut self, equation: &Equation, out: &mut Set) {
        self.complete(out, |walk, out, needs| match &equation.sides {
            EquationSides::Scalar(l, r) => {
                walk.scalar(l, true, out, needs);
                walk.scalar(r, true, out, needs);
            }
            EquationSides::Vector(l, r) => {
                walk.vector(l, true, out, needs);
                walk.vector(r, true, out, needs);
            }
        });
    }

    /// Coordinates in the orientation of one frame in another.
    fn relative_orientation(&mut self, of: usize, within: usize, out: &mut Set) {
        let mut path = Vec::new();
        let mut at = Some(of);
        while let Some(frame) = at {
            path.push(frame);
            at = self.mechanism.frames[frame].parent.map(|parent| parent.0);
        }
        let mut other = Vec::new();
        let mut at = Some(within);
        while let Some(frame) = at {
            other.push(frame);
            at = self.mechanism.frames[frame].parent.map(|parent| parent.0);
        }
        let frames: Vec<usize> = path
            .iter()
            .filter(|f| !other.contains(f))
            .chain(other.iter().filter(|f| !path.contains(f)))
            .copied()
            .collect();
        let mechanism = self.mechanism;
        for frame in frames {
            self.complete(out, |walk, out, needs| {
                walk.orientation(&mechanism.frames[frame].orientation, out, needs)
            });
        }
    }
}
