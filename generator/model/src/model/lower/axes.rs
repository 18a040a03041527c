//! Lowers what is written with a dot: axes of a frame, `A.vec(a, b, c)` and other methods.

use super::super::mechanism::{Axis, FrameId, Scalar, Vector};
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed};
use super::Lowering;
use super::calls::is_function;
use super::dimensions::model_of;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Name};
use crate::unicode;

impl Lowering<'_> {
    /// The frame before `.`, which must have axes.
    fn frame_with_axes(&mut self, base: &Expr) -> Option<FrameId> {
        let ExprKind::Name(text) = &base.kind else {
            if self.expression(base).is_poison() {
                return None;
            }
            let error = Diagnostic::new(codes::WRONG_KIND, base.span, "only a frame can stand before `.`")
                .help("write `dot(v, A.x)` for a component");
            self.report(error);
            return None;
        };
        let name = Name { text: text.clone(), span: base.span };
        let frame = match self.resolve(&name, |s| matches!(s, Symbol::Frame(_)))? {
            Symbol::Frame(f) => FrameId(f),
            symbol => {
                let mut error = Diagnostic::new(
                    codes::WRONG_KIND,
                    name.span,
                    format!("only a frame has axes, but `{}` is {}", name.text, symbol.kind()),
                );
                if let Symbol::Body(b) = symbol
                    && let Some(frame) = super::super::dependency_order::body_frame(self.tree, b)
                {
                    error = error.help(format!("its frame is `{}`", frame.text));
                } else if let Symbol::Point(_) = symbol {
                    error = error
                        .help(format!("a component of its position is `dot(position({}), N.x)`", name.text));
                }
                self.report(error);
                return None;
            }
        };
        self.need_axes(frame, base.span)
    }

    /// A frame made by `spin` has no axes.
    pub(super) fn need_axes(&mut self, frame: FrameId, at: Span) -> Option<FrameId> {
        if self.frames[frame.0].broken {
            return None;
        }
        if !self.frames[frame.0].no_axes {
            return Some(frame);
        }
        let (name, place) = (self.out.frames[frame.0].name.clone(), self.out.frames[frame.0].span);
        let error =
            Diagnostic::new(codes::NO_AXES, at, format!("`{name}` has an angular velocity but no axes"))
                .related(place, "it is made by `spin`: its angle is not known")
                .help("use the axes of the frame that it spins in");
        self.report(error);
        None
    }

    /// `A.x`
    pub(super) fn field(&mut self, base: &Expr, field: &Name, span: Span) -> Typed {
        if self.constant_only {
            self.error(codes::CONSTANT, span, "a value is a number, not a vector");
            return Typed::poison(span);
        }
        let frame = self.frame_with_axes(base);
        let Some(axis) = axis_named(&field.text) else {
            // what is no frame has no axes either
            if frame.is_none() {
                return Typed::poison(span);
            }
            let error = Diagnostic::new(
                codes::UNKNOWN_NAME,
                field.span,
                format!("a frame has no axis `{}`", field.text),
            );
            let methods = ["vec", "rotate", "euler", "space", "quaternion", "spin"];
            let error = if let Some(found) = unicode::lookalike(&field.text) {
                error.help(found.advice())
            } else if methods.contains(&field.text.as_str()) {
                error.help(format!("`{}` needs arguments in parentheses", field.text))
            } else {
                error.help("the axes are `x`, `y` and `z`")
            };
            self.report(error);
            return Typed::poison(span);
        };
        let Some(frame) = frame else { return Typed::poison(span) };
        let traits = self.frames[frame.0].orientation.seen_from(span);
        let mut components = [0, 0, 0].map(|n| Scalar::Number(crate::number::Number::integer(n)));
        components[axis as usize] = Scalar::Number(crate::number::Number::integer(1));
        Typed::vector(Vector::Components(frame, Box::new(components)), Some(Dimension::none()), traits, span)
    }

    /// `A.vec(a, b, c)`; the other operations make frames and stand under `frames` only.
    pub(super) fn method(&mut self, base: &Expr, method: &Name, arguments: &[Expr], span: Span) -> Typed {
        if self.constant_only {
            self.error(codes::CONSTANT, span, "a value is a number, not a vector");
            return Typed::poison(span);
        }
        let making = ["rotate", "euler", "space", "quaternion", "spin"];
        if method.text != "vec" {
            let text = &method.text;
            let error =
                Diagnostic::new(codes::WRONG_KIND, method.span, format!("`{text}` does not make a vector"));
            let error = if is_function(text) {
                error.help(format!("a function stands alone: `{text}(..)`"))
            } else if making.contains(&text.as_str()) {
                error.help("it makes a frame and stands under `frames` only")
            } else if ["x", "y", "z"].contains(&text.as_str()) {
                error.help("an axis takes no arguments: `A.x`; put `*` before the parenthesis for a product")
            } else {
                error.help("the operations of a frame are `vec(a, b, c)` and, under `frames`, rotate, euler, space, quaternion, spin")
            };
            self.report(error);
            return Typed::poison(span);
        }
        let frame = self.frame_with_axes(base);
        let typed: Vec<Typed> = arguments.iter().map(|argument| self.expression(argument)).collect();
        if typed.len() != 3 {
            self.wrong_count(method, "three arguments, the components along x, y and z", typed.len(), span);
            return Typed::poison(span);
        }
        let scalars: Vec<Option<Scalar>> = typed.iter().map(|c| self.need_scalar(c, "a component")).collect();
        let model = model_of(typed.iter().filter(|component| !component.is_vector()));
        let mut fit = true;
        for component in typed.iter().filter(|component| !component.is_vector()) {
            if let Some(model) = model {
                fit &= self.same(model, component, |a, b| {
                    format!("the components differ in dimension: {a} and {b}")
                });
            }
        }
        let traits = typed.iter().fold(Traits::default(), |sum, c| sum.plus(c.traits));
        let components: Option<[Scalar; 3]> =
            scalars.into_iter().collect::<Option<Vec<_>>>().and_then(|list| list.try_into().ok());
        let (Some(frame), Some(components), true) = (frame, components, fit) else {
            return Typed { traits, ..Typed::poison(span) };
        };
        let traits = traits.times(self.frames[frame.0].orientation);
        let dimension = model.and_then(|model| model.dimension);
        let provenance = model.map_or(Provenance::none(), |model| model.provenance.clone());
        Typed::vector(Vector::Components(frame, Box::new(components)), dimension, traits, span)
            .from(provenance)
    }
}

/// The axis of this name.
pub(super) fn axis_named(name: &str) -> Option<Axis> {
    match name {
        "x" => Some(Axis::X),
        "y" => Some(Axis::Y),
        "z" => Some(Axis::Z),
        _ => None,
    }
}
