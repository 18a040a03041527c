//! Lowers orientations and angular velocities of frames.

use super::super::dependency_order::base_frame;
use super::super::mechanism::{Axis, FrameId, Orientation, Scalar};
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::Traits;
use super::Lowering;
use super::axes::axis_named;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::syntax::tree::{Expr, ExprKind, Name};
use crate::{suggest, words};

impl Lowering<'_> {
    /// The orientation of frame `i` in its parent.
    pub(super) fn orientation(&mut self, i: usize) {
        if i > 0 {
            self.frames[i].broken = self.read_orientation(i).is_none();
        }
    }

    fn read_orientation(&mut self, i: usize) -> Option<()> {
        let index = i.checked_sub(1)?;
        let source = &self.tree.frames[index];
        let value = &source.value;
        let Some(base) = base_frame(value) else {
            if !matches!(value.kind, ExprKind::Error) {
                let error = Diagnostic::new(codes::FRAME, value.span, "this is not an orientation");
                let chained = matches!(&value.kind, ExprKind::Method(base, ..) if matches!(base.kind, ExprKind::Method(..)));
                self.report(error.help(if chained {
                    "a frame is turned once: name the one in between, as in `A = N.rotate(z, q1); B = A.rotate(x, q2);`"
                } else {
                    "write `B = N;`, `B = N.rotate(z, q1);`, or use euler, space, quaternion or spin"
                }));
            }
            return None;
        };
        let parent = self.proper_frame(&base)?;
        self.out.frames[i].parent = Some(parent);
        let ExprKind::Method(_, operation, arguments) = &value.kind else {
            if let ExprKind::Field(..) = value.kind {
                let error = Diagnostic::new(codes::FRAME, value.span, "this is not an orientation")
                    .help("write `B = N;` or `B = N.rotate(z, q1);`");
                self.report(error);
                return None;
            }
            // the same axes, or the same lack of them
            if self.need_axes(parent, base.span).is_some() {
                self.frames[i].orientation = self.frames[parent.0].orientation;
            } else if self.frames[parent.0].broken {
                return None;
            } else {
                self.frames[i].no_axes = true;
            }
            return Some(());
        };
        let axes = self.need_axes(parent, base.span);
        if let Some(Expr { kind: ExprKind::List(_), span }) = arguments.first() {
            self.out.frames[i].orientation_span = *span;
        }
        if operation.text == "spin" {
            // its angular velocity is read later
            self.frames[i].no_axes = true;
            if arguments.len() != 1 {
                self.arguments_expected(operation, "the angular velocity, as in `A.spin(u3*A.y)`", value);
                return None;
            }
            return axes.map(drop);
        }
        let read = match operation.text.as_str() {
            "rotate" => self.rotate(operation, arguments, value),
            "euler" | "space" => self.sequence(operation, arguments, value),
            "quaternion" => self.quaternion(operation, arguments, value),
            _ => {
                let message = format!("a frame has no operation `{}`", operation.text);
                let error = Diagnostic::new(codes::FRAME, operation.span, message);
                self.report(match suggest::nearest(&operation.text, words::ORIENTATIONS.into_iter()) {
                    Some(near) => error.did_you_mean(near),
                    None => error.help("a frame is made by rotate, euler, space, quaternion or spin"),
                });
                None
            }
        };
        let (orientation, traits) = read?;
        self.out.frames[i].orientation = orientation;
        self.frames[i].orientation = traits.plus(self.frames[parent.0].orientation);
        (axes.is_some() && !self.frames[parent.0].broken).then_some(())
    }

    fn arguments_expected(&mut self, operation: &Name, what: &str, value: &Expr) {
        let message = format!("`{}` needs {what}", operation.text);
        self.report(Diagnostic::new(codes::FRAME, value.span, message));
    }

    fn angle(&mut self, expr: &Expr) -> Option<(Scalar, Traits)> {
        let (scalar, typed) = self.scalar_like(expr, Dimension::none(), "an angle")?;
        self.need_free_of_speeds(&typed, "an angle");
        self.need_rate(&typed, "an angle");
        Some((scalar, typed.traits.given()))
    }

    fn rotate(
        &mut self,
        operation: &Name,
        arguments: &[Expr],
        value: &Expr,
    ) -> Option<(Orientation, Traits)> {
        let [axis, angle] = arguments else {
            self.arguments_expected(operation, "an axis and an angle, as in `N.rotate(z, q1)`", value);
            return None;
        };
        let (inner, negative) = match &axis.kind {
            ExprKind::Neg(inner) => (&**inner, true),
            _ => (axis, false),
        };
        if let ExprKind::Name(text) = &inner.kind
            && let Some(axis) = axis_named(text)
        {
            let (angle, traits) = self.angle(angle)?;
            return Some((Orientation::Simple { axis, negative, angle }, traits));
        }
        let ExprKind::List(items) = &axis.kind else {
            let error = Diagnostic::new(codes::FRAME, axis.span, "this is not an axis");
            let is_axis =
                |expr: &Expr| matches!(&expr.kind, ExprKind::Name(text) if axis_named(text).is_some());
            let meant = match &inner.kind {
                ExprKind::Field(_, name) => Some(name.text.to_lowercase()),
                ExprKind::Name(text) => Some(text.to_lowercase()),
                _ => None,
            };
            let meant = meant.filter(|text| axis_named(text).is_some());
            self.report(match meant {
                Some(axis) => error.did_you_mean(&format!("{}{axis}", if negative { "-" } else { "" })),
                None if is_axis(angle) => error.help("the axis comes first, then the angle: `N.rotate(z, q1)`"),
                None => error.help("an axis is `x`, `y`, `z`, `-x`, `-y`, `-z`, or `[a, b, c]`, a unit vector in the axes of the frame before `.rotate`"),
            });
            return None;
        };
        let mut traits = Traits::default();
        let mut components = Vec::new();
        let mut moves = false;
        for item in items {
            if let Some((scalar, typed)) = self.scalar_like(item, Dimension::none(), "a component of an axis")
            {
                self.need_free_of_speeds(&typed, "an axis");
                self.need_rate(&typed, "an axis");
                if !moves && typed.traits.degree == 0 && (typed.traits.moves || typed.traits.time) {
                    moves = true;
                    let on = if typed.traits.moves { "coordinates" } else { "time" };
                    let message = format!("an axis of rotation stays where it is, but this depends on {on}");
                    let error = Diagnostic::new(codes::FRAME, item.span, message)
                        .help("make it of numbers and parameters only, and compose the rotation of several about such axes");
                    self.report(error);
                }
                traits = traits.plus(typed.traits.given());
                components.push(scalar);
            }
        }
        let angle = self.angle(angle);
        if items.len() != 3 {
            self.error(codes::FRAME, axis.span, "an axis has three components");
            return None;
        }
        let components: [Scalar; 3] = components.try_into().ok()?;
        let (angle, angle_traits) = angle?;
        Some((Orientation::About { axis: Box::new(components), angle }, traits.plus(angle_traits)))
    }

    fn sequence(
        &mut self,
        operation: &Name,
        arguments: &[Expr],
        value: &Expr,
    ) -> Option<(Orientation, Traits)> {
        let what =
            format!("a sequence of axes and three angles, as in `N.{}(xyz, q1, q2, q3)`", operation.text);
        let Some((sequence, angles)) = arguments.split_first().filter(|(_, angles)| angles.len() == 3) else {
            self.arguments_expected(operation, &what, value);
            return None;
        };
        let axes: Option<Vec<Axis>> = match &sequence.kind {
            ExprKind::Name(text) if text.chars().count() == 3 => {
                text.chars().map(|c| axis_named(c.encode_utf8(&mut [0; 4]))).collect()
            }
            _ => None,
        };
        let angles: Vec<Option<(Scalar, Traits)>> = angles.iter().map(|angle| self.angle(angle)).collect();
        let Some(Ok(axes)) = axes.map(<[Axis; 3]>::try_from) else {
            let error = Diagnostic::new(codes::FRAME, sequence.span, "this is not a sequence of axes");
            self.report(match sequence_meant(sequence) {
                Some(meant) => error.did_you_mean(&meant),
                None => error.help("write three of x, y, z together, as in `xyz` or `zxz`"),
            });
            return None;
        };
        if axes[0] == axes[1] || axes[1] == axes[2] {
            let error = Diagnostic::new(codes::FRAME, sequence.span, "the same axis twice in a row")
                .help("two such rotations are one; neighbours in the sequence must differ");
            self.report(error);
            return None;
        }
        let angles: Vec<(Scalar, Traits)> = angles.into_iter().collect::<Option<_>>()?;
        let traits = angles.iter().fold(Traits::default(), |sum, (_, traits)| sum.plus(*traits));
        let angles: [Scalar; 3] =
            angles.into_iter().map(|(angle, _)| angle).collect::<Vec<_>>().try_into().ok()?;
        let body_fixed = operation.text == "euler";
        Some((Orientation::Euler { axes, angles: Box::new(angles), body_fixed }, traits))
    }

    fn quaternion(
        &mut self,
        operation: &Name,
        arguments: &[Expr],
        value: &Expr,
    ) -> Option<(Orientation, Traits)> {
        if arguments.len() != 4 {
            let what = "four coordinates, the scalar part first, as in `N.quaternion(e0, e1, e2, e3)`";
            self.arguments_expected(operation, what, value);
            return None;
        }
        let (mut coordinates, mut unread) = (Vec::new(), false);
        for argument in arguments {
            match self.as_coordinate(argument) {
                Some(coordinate) => {
                    if coordinates.contains(&coordinate) {
                        self.error(
                            codes::QUATERNION,
                            argument.span,
                            "the same coordinate twice in a quaternion",
                        );
                        return None;
                    }
                    let unit = self.coordinates[coordinate.0].unit.clone();
                    unread |= unit.is_none();
                    if let Some(unit) = unit {
                        let provenance = Provenance::of(Symbol::Coordinate(coordinate.0));
                        if unit.is_si() && unit.dimension.is_none() {
                            self.agreement(provenance);
                        } else {
                            unread = true;
                            let message = "the parts of a quaternion are plain numbers";
                            let error = Diagnostic::new(codes::DIMENSION, argument.span, message)
                                .help("declare the coordinate with the unit 1");
                            let off = Dimension::none().over(&unit.dimension);
                            self.contradiction(error, provenance, off, message.to_owned());
                        }
                    }
                    coordinates.push(coordinate);
                }
                None => {
                    if !self.expression(argument).is_poison() {
                        let message = "a quaternion is made of coordinates";
                        let error = Diagnostic::new(codes::QUATERNION, argument.span, message)
                            .help("declare four coordinates for it, with the unit 1");
                        self.report(error);
                    }
                    // the others are of the same mistake
                    return None;
                }
            }
        }
        if unread {
            self.unread_quaternions.extend(coordinates.iter().map(|coordinate| coordinate.0));
            return None;
        }
        let coordinates: [_; 4] = coordinates.try_into().ok()?;
        Some((Orientation::Quaternion(coordinates), Traits { moves: true, ..Traits::default() }))
    }

    /// The angular velocity of frame `i`.
    pub(super) fn angular_velocity(&mut self, i: usize) {
        let Some(index) = i.checked_sub(1) else { return };
        let source = &self.tree.frames[index];
        let per_second = Dimension::of(0, 0, -1);
        let spin = match &source.value.kind {
            ExprKind::Method(_, operation, arguments) if operation.text == "spin" => arguments.first(),
            _ => None,
        };
        let parent = self.out.frames[i].parent;
        let parents = parent.map_or(Traits::default(), |p| self.frames[p.0].angular_velocity);
        if let Some(spin) = spin {
            let (vector, traits) = self.velocity_like(spin, per_second, "an angular velocity");
            if let Some(vector) = vector {
                self.out.frames[i].orientation = Orientation::Spin(vector);
            }
            self.frames[i].angular_velocity = parents.plus(traits);
        } else {
            let turning = self.frames[i].orientation.derivative(source.name.span);
            self.frames[i].angular_velocity = parents.plus(turning);
        }
        let stated = self.stated.angular_velocities.get(source.name.text.as_str()).copied();
        let Some(stated) = stated else {
            // it may be stated under a name that could not be read, or that is misspelled
            let unread = || {
                self.tree.incomplete
                    || self.tree.broken.iter().any(|name| name.text == source.name.text)
                    || self.tree.angular_velocities.iter().any(|a| self.names.get(&a.frame.text).is_none())
            };
            if let (Orientation::Quaternion(_), Some(_)) = (&self.out.frames[i].orientation, parent)
                && !unread()
            {
                let message = format!("the angular velocity of `{}` must be stated", source.name.text);
                let error = Diagnostic::new(codes::QUATERNION, source.name.span, message).help(format!(
                    "the rates of a quaternion follow from it: add `angular_velocities {{ {0} = u1*{0}.x + u2*{0}.y + u3*{0}.z; }}`",
                    source.name.text
                ));
                self.report(error);
            }
            return;
        };
        if spin.is_some() {
            let message =
                format!("the angular velocity of `{}` is stated by `spin` already", source.name.text);
            let error = Diagnostic::new(codes::MOTION_TWICE, stated.frame.span, message)
                .related(source.value.span, "here")
                .help("remove one of the two");
            self.report(error);
            return;
        }
        let within = match &stated.within {
            Some(name) => self.frame_named(name),
            None => Some(FrameId::N),
        };
        let (vector, traits) = self.velocity_like(&stated.value, per_second, "an angular velocity");
        let Some(within) = within else { return };
        if within.0 == i {
            let error = Diagnostic::new(codes::FRAME, stated.frame.span, "a frame does not turn in itself");
            self.report(error);
            return;
        }
        self.frames[i].angular_velocity = traits.plus(self.frames[within.0].angular_velocity);
        if let Some(vector) = vector {
            self.out.frames[i].angular_velocity = Some((within, vector));
        }
    }
}

/// `ZYX`, `321` and `"zyx"` as others write `zyx`.
fn sequence_meant(expr: &Expr) -> Option<String> {
    let (ExprKind::Name(text) | ExprKind::Number(text)) = &expr.kind else { return None };
    let axis = |c: char| match c {
        'x' | 'X' | '1' => Some('x'),
        'y' | 'Y' | '2' => Some('y'),
        'z' | 'Z' | '3' => Some('z'),
        _ => None,
    };
    let meant: String = text.chars().map(axis).collect::<Option<_>>()?;
    (meant.len() == 3).then_some(meant)
}
