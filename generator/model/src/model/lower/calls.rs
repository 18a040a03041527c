//! Lowers calls of functions, `position`, `velocity` and `angular_velocity` among them.

use super::super::mechanism::{FrameId, PointId, Scalar, Vector};
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed, TypedValue};
use super::Lowering;
use crate::arithmetic::Function;
use crate::arithmetic::reproducible;
use crate::diagnostics::{Diagnostic, Place, codes};
use crate::dimension::{Dimension, Exponent};
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Name};
use crate::{suggest, vocabulary, words};

const SCALAR_FUNCTIONS: &[(&str, Function)] = &[
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("atan2", Function::Atan2),
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("abs", Function::Abs),
    ("sign", Function::Sign),
    ("min", Function::Min),
    ("max", Function::Max),
];

/// A tangent above this is one of a right angle that was rounded.
const POLE: f64 = 1e15;

/// Whether this is the name of a function.
pub(super) fn is_function(name: &str) -> bool {
    words::look(words::FUNCTIONS, name).is_some()
}

impl Lowering<'_> {
    /// `function(arguments)`
    pub(super) fn call(&mut self, name: &Name, arguments: &[Expr], span: Span) -> Typed {
        if let Some((_, function)) = SCALAR_FUNCTIONS.iter().find(|(text, _)| *text == name.text) {
            return self.scalar_function(*function, name, arguments, span);
        }
        let count = |wanted: std::ops::RangeInclusive<usize>| wanted.contains(&arguments.len());
        let (wanted, fits) = match name.text.as_str() {
            "pow" | "dot" | "cross" => ("two arguments", count(2..=2)),
            "norm" | "unit" | "d" => ("one argument", count(1..=1)),
            "position" | "velocity" | "angular_velocity" => ("one or two arguments", count(1..=2)),
            _ => return self.unknown_function(name, arguments, span),
        };
        if self.constant_only && name.text != "pow" {
            let error = Diagnostic::new(
                codes::CONSTANT,
                span,
                format!("a value is a constant, not `{}(..)`", name.text),
            );
            self.report(error);
            return Typed::poison(span);
        }
        if !fits {
            self.wrong_count(name, wanted, arguments.len(), span);
            return Typed::poison(span);
        }
        match name.text.as_str() {
            "position" | "velocity" => return self.of_points(name, arguments, span),
            "angular_velocity" => return self.of_frames(arguments, span),
            _ => {}
        }
        let typed: Vec<Typed> = arguments.iter().map(|argument| self.expression(argument)).collect();
        match (name.text.as_str(), &typed[..]) {
            ("pow", [base, exponent]) => self.power(base.clone(), exponent.clone(), span),
            ("dot", [a, b]) => {
                let vectors = (
                    self.need_vector(a, "an argument of `dot`"),
                    self.need_vector(b, "an argument of `dot`"),
                );
                let (Some(v), Some(w)) = vectors else { return Typed::poison(span) };
                let dimension = both(a.dimension, b.dimension);
                let value = Scalar::Dot(Box::new(v), Box::new(w));
                Typed::scalar(value, dimension, a.traits.times(b.traits), span)
                    .from(a.provenance.times(&b.provenance))
            }
            ("cross", [a, b]) => {
                let what = "an argument of `cross`";
                let vectors = (self.need_vector(a, what), self.need_vector(b, what));
                let (Some(v), Some(w)) = vectors else { return Typed::poison(span) };
                let dimension = both(a.dimension, b.dimension);
                let value = Vector::Cross(Box::new(v), Box::new(w));
                Typed::vector(value, dimension, a.traits.times(b.traits), span)
                    .from(a.provenance.times(&b.provenance))
            }
            ("norm", [v]) => match self.need_vector(v, "the argument of `norm`") {
                Some(vector) => {
                    Typed::scalar(Scalar::Norm(Box::new(vector)), v.dimension, v.traits.bent(), span)
                        .from(v.provenance.clone())
                }
                None => Typed::poison(span),
            },
            ("unit", [v]) => {
                if v.is_zero() {
                    let error =
                        Diagnostic::new(codes::ZERO_DIVISOR, v.span, "the zero vector has no direction");
                    self.report(error);
                    return Typed::poison(span);
                }
                match self.need_vector(v, "the argument of `unit`") {
                    Some(vector) => {
                        let value = Vector::Unit(Box::new(vector), span);
                        Typed::vector(value, Some(Dimension::none()), v.traits.bent(), span)
                    }
                    None => Typed::poison(span),
                }
            }
            _ => {
                let error = Diagnostic::new(codes::BAD_EXPRESSION, span, "`d(..)` must be followed by `/dt`")
                    .help("a time derivative is written `d(q1)/dt`");
                self.report(error);
                Typed::poison(span)
            }
        }
    }

    fn unknown_function(&mut self, name: &Name, arguments: &[Expr], span: Span) -> Typed {
        if let ([inner] | [inner, _], true) = (arguments, vocabulary::differentiates(&name.text)) {
            self.expression(inner);
            let error =
                Diagnostic::new(codes::FUNCTION, name.span, format!("there is no function `{}`", name.text));
            let example = match &inner.kind {
                ExprKind::Name(text) => text.as_str(),
                _ => "q1",
            };
            self.report(error.help(format!("a time derivative is written `d({example})/dt`")));
            return Typed::poison(span);
        }
        for argument in arguments {
            // the function that is meant may take it
            let named = match &argument.kind {
                ExprKind::Name(text) => self.names.get(text),
                _ => None,
            };
            match named {
                Some(symbol @ (Symbol::Point(_) | Symbol::Frame(_) | Symbol::Body(_))) => {
                    self.places.uses(symbol, argument.span);
                }
                _ => drop(self.expression(argument)),
            }
        }
        let all = words::FUNCTIONS.iter().map(|word| word.text);
        let error = match self.names.get(&name.text) {
            Some(symbol) => {
                let message = format!("`{}` is {}, not a function", name.text, symbol.kind());
                Diagnostic::new(codes::FUNCTION, name.span, message).help("write `*` for a product")
            }
            None => {
                let error = Diagnostic::new(
                    codes::FUNCTION,
                    name.span,
                    format!("there is no function `{}`", name.text),
                );
                match (vocabulary::function(&name.text), suggest::nearest(&name.text, all.clone())) {
                    (Some(advice), _) => match vocabulary::word_meant(advice) {
                        Some(word) => error.fix(Place::Replace(name.span), word).help(advice),
                        None => error.help(advice),
                    },
                    (None, Some(near)) => error.did_you_mean(near),
                    (None, None) => {
                        error.help(format!("the functions are {}", all.collect::<Vec<_>>().join(", ")))
                    }
                }
            }
        };
        self.report(error);
        Typed::poison(span)
    }

    pub(super) fn wrong_count(&mut self, name: &Name, wanted: &str, found: usize, span: Span) {
        let message = format!("`{}` takes {wanted}, not {found}", name.text);
        self.report(Diagnostic::new(codes::FUNCTION, span, message));
    }

    fn scalar_function(&mut self, function: Function, name: &Name, arguments: &[Expr], span: Span) -> Typed {
        let typed: Vec<Typed> = arguments.iter().map(|argument| self.expression(argument)).collect();
        let binary = matches!(function, Function::Atan2 | Function::Min | Function::Max);
        if typed.len() != 1 + usize::from(binary) {
            self.wrong_count(name, if binary { "two arguments" } else { "one argument" }, typed.len(), span);
            return Typed::poison(span);
        }
        let what = format!("the argument of `{}`", name.text);
        let scalars: Vec<Option<Scalar>> =
            typed.iter().map(|argument| self.need_scalar(argument, &what)).collect();
        let Some(scalars) = scalars.into_iter().collect::<Option<Vec<Scalar>>>() else {
            return Typed::poison(span);
        };
        let traits = typed.iter().fold(Traits::default(), |sum, argument| sum.plus(argument.traits.bent()));
        let (first, provenance) = (typed[0].dimension, &typed[0].provenance);
        let (dimension, provenance) = match function {
            Function::Sqrt => {
                let half = Exponent::new(1, 2);
                (first.and_then(|d| d.power(half)), provenance.power(half))
            }
            Function::Abs => (first, provenance.clone()),
            Function::Sign => (Some(Dimension::none()), Provenance::none()),
            Function::Atan2 | Function::Min | Function::Max => {
                let (a, b) = (&typed[0], &typed[1]);
                let fit = self.same(a, b, |a, b| {
                    format!("the arguments of `{}` have the dimensions {a} and {b}", name.text)
                });
                match function {
                    Function::Atan2 => (Some(Dimension::none()), Provenance::none()),
                    _ if !fit => return Typed { traits, ..Typed::poison(span) },
                    _ if first.is_some() => (first, provenance.clone()),
                    _ => (b.dimension, b.provenance.clone()),
                }
            }
            _ => {
                self.demand(&typed[0], Dimension::none(), &what);
                (Some(Dimension::none()), Provenance::none())
            }
        };
        let constants: Option<Vec<f64>> = typed.iter().map(|argument| argument.constant).collect();
        let constant = constants.map(|values| match (function, &values[..]) {
            (_, [a, b]) => reproducible::call2(function, *a, *b),
            (_, [a]) => reproducible::call(function, *a),
            _ => f64::NAN,
        });
        if function == Function::Tan && constant.is_some_and(|value: f64| value.abs() > POLE) {
            let error = Diagnostic::new(codes::ZERO_DIVISOR, span, "`tan` has no value at a right angle");
            self.report(error.help("it is sin/cos, and this cosine is 0"));
            return Typed::poison(span);
        }
        if function == Function::Log && !typed[0].is_zero() && self.vanishes(&typed[0]) {
            let error = Diagnostic::new(codes::NUMBER_RANGE, span, "the logarithm of 0 is not a number");
            self.report(error.related(typed[0].span, "this is 0, but for rounding"));
            return Typed::poison(span);
        }
        let value = Scalar::Call(function, scalars);
        Typed { constant, provenance, ..Typed::scalar(value, dimension, traits, span) }
    }

    fn point_argument(&mut self, argument: &Expr, of: &str) -> Option<PointId> {
        match &argument.kind {
            ExprKind::Name(text) => self.point_named(&Name { text: text.clone(), span: argument.span }),
            ExprKind::Error => None,
            _ => {
                let message = format!("`{of}` takes the names of points");
                let help = match of {
                    "velocity" => {
                        "declare the point under `points`; behind `against:` a velocity begins with its vector, `velocity N.x*(a + b)`"
                    }
                    _ => "declare the point under `points`",
                };
                let error = Diagnostic::new(codes::WRONG_KIND, argument.span, message).help(help);
                self.report(error);
                None
            }
        }
    }

    /// `position(P, Q)` and `velocity(P, Q)`
    fn of_points(&mut self, name: &Name, arguments: &[Expr], span: Span) -> Typed {
        let points: Vec<Option<PointId>> =
            arguments.iter().map(|argument| self.point_argument(argument, &name.text)).collect();
        let Some(points) = points.into_iter().collect::<Option<Vec<PointId>>>() else {
            return Typed::poison(span);
        };
        let of = points[0];
        let from = points.get(1).copied().unwrap_or(PointId::O);
        let (a, b) = (self.points[of.0].clone(), self.points[from.0].clone());
        if a.broken || b.broken {
            return Typed::poison(span);
        }
        if name.text == "velocity" {
            let traits = a.velocity.plus(b.velocity).seen_from(span);
            let dimension = Some(Dimension::of(1, 0, -1));
            let value = match points.get(1) {
                None => Vector::Velocity(of),
                Some(_) => {
                    Vector::Add(vec![Vector::Velocity(of), Vector::Neg(Box::new(Vector::Velocity(from)))])
                }
            };
            return Typed::vector(value, dimension, traits, span);
        }
        if a.root != b.root {
            let unknown = if a.root != 0 { a.root } else { b.root };
            let point = &self.out.points[unknown];
            let (place, called) = (point.span, point.name.clone());
            let message = format!("the position of `{called}` is not known, only its velocity");
            let error = Diagnostic::new(codes::NO_POSITION, span, message)
                .related(place, format!("`{called}` is given by its velocity"))
                .help(format!("positions of points placed from `{called}` may appear in differences only: `position(P, {called})`"));
            self.report(error);
            return Typed::poison(span);
        }
        let traits = a.position.plus(b.position).seen_from(span);
        Typed::vector(Vector::Position { of, from }, Some(Dimension::of(1, 0, 0)), traits, span)
    }

    /// `angular_velocity(B, A)`
    fn of_frames(&mut self, arguments: &[Expr], span: Span) -> Typed {
        let mut frames = Vec::new();
        for argument in arguments {
            match &argument.kind {
                ExprKind::Name(text) => {
                    frames.push(self.frame_named(&Name { text: text.clone(), span: argument.span }));
                }
                ExprKind::Error => frames.push(None),
                _ => {
                    let message = "`angular_velocity` takes the names of frames or bodies";
                    let error = Diagnostic::new(codes::WRONG_KIND, argument.span, message);
                    self.report(
                        error.help("as in `angular_velocity(B)`, or `angular_velocity(B, A)` relative to A"),
                    );
                    frames.push(None);
                }
            }
        }
        let Some(frames) = frames.into_iter().collect::<Option<Vec<FrameId>>>() else {
            return Typed::poison(span);
        };
        let (of, in_frame) = (frames[0], frames.get(1).copied().unwrap_or(FrameId::N));
        if self.frames[of.0].broken || self.frames[in_frame.0].broken {
            return Typed::poison(span);
        }
        let traits = self.frames[of.0].angular_velocity.plus(self.frames[in_frame.0].angular_velocity);
        let dimension = Some(Dimension::of(0, 0, -1));
        Typed::vector(Vector::AngularVelocity { of, in_frame }, dimension, traits.seen_from(span), span)
    }

    /// Demands a vector with a dimension that enters linearly: a velocity, say.
    pub(super) fn velocity_like(
        &mut self,
        expr: &Expr,
        dimension: Dimension,
        what: &str,
    ) -> (Option<Vector>, Traits) {
        let typed = self.expression(expr);
        let vector = self.need_vector(&typed, what);
        if vector.is_some() {
            self.demand(&typed, dimension, what);
            self.need_linear(&typed, what);
        }
        // that it is not linear is said here, or it makes no sense anyway
        let traits = Traits { degree: typed.traits.degree.min(1), ..typed.traits };
        (vector, traits)
    }

    /// Demands a scalar of a dimension.
    pub(super) fn scalar_like(
        &mut self,
        expr: &Expr,
        dimension: Dimension,
        what: &str,
    ) -> Option<(Scalar, Typed)> {
        let typed = self.expression(expr);
        let scalar = self.need_scalar(&typed, what)?;
        self.demand(&typed, dimension, what);
        Some((scalar, typed))
    }
}

fn both(a: Option<Dimension>, b: Option<Dimension>) -> Option<Dimension> {
    a?.times(&b?)
}

impl Typed {
    /// Whether its value is a vector.
    pub fn is_vector(&self) -> bool {
        matches!(self.value, TypedValue::Vector(_))
    }
}
