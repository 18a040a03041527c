//! Lowers what a shape is made of: lengths, vertices, functions of the place and density.

use super::super::super::mechanism::{Anchor, Height, Kind, OfPlace, Scalar};
use super::super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Field};

impl Lowering<'_> {
    /// The lengths of a shape, each with its place.
    pub(super) fn sizes(&mut self, kind: Kind, field: &Field) -> Option<(Vec<Scalar>, Vec<Span>)> {
        let names = kind.sizes();
        if names.is_empty() {
            return Some((Vec::new(), Vec::new()));
        }
        let items: &[Expr] = match &field.value.kind {
            ExprKind::Error => return None,
            ExprKind::List(items) => items,
            _ => std::slice::from_ref(&field.value),
        };
        if items.len() != names.len() {
            let numbers = if names.len() == 1 { "one dimension" } else { "dimensions" };
            let message = format!(
                "{} has {} {numbers}, but {} {} given",
                kind.with_article(),
                if names.len() == 1 { String::new() } else { names.len().to_string() },
                items.len(),
                if items.len() == 1 { "is" } else { "are" }
            )
            .replace("  ", " ");
            let help = match names {
                [only] => format!("write `{}: r`, its {only}", kind.word()),
                _ => format!("write `{}: [{}]`", kind.word(), names.join(", ")),
            };
            self.report(Diagnostic::new(codes::SHAPE, field.value.span, message).help(help));
            return None;
        }
        let read: Vec<Option<(Scalar, Span)>> =
            items.iter().zip(names).map(|(item, name)| self.size(kind, name, item)).collect();
        read.into_iter().collect::<Option<Vec<_>>>().map(|read| read.into_iter().unzip())
    }

    fn size(&mut self, kind: Kind, name: &str, item: &Expr) -> Option<(Scalar, Span)> {
        let what = format!("the {name} of {}", kind.with_article());
        let (scalar, typed) = self.scalar_like(item, Dimension::of(1, 0, 0), &what)?;
        self.need_free_of_speeds(&typed, &what);
        if typed.traits.moves || typed.traits.time || typed.traits.input.is_some() {
            let error = Diagnostic::new(codes::SHAPE, typed.span, format!("{what} must be constant"));
            self.report(error.help("it may depend on parameters only"));
            return None;
        }
        if typed.constant.is_some_and(|value| value <= 0.0) {
            self.error(codes::SHAPE, typed.span, format!("{what} must be positive"));
            return None;
        }
        Some((scalar, item.span))
    }

    /// The vertices of a polytope; other shapes have none.
    pub(super) fn vertices(&mut self, kind: Kind, field: &Field) -> Option<Vec<Anchor>> {
        if kind != Kind::Polytope {
            return Some(Vec::new());
        }
        let ExprKind::List(items) = &field.value.kind else {
            if !matches!(field.value.kind, ExprKind::Error) {
                let message = "a polytope is a list of its vertices";
                let error = Diagnostic::new(codes::SHAPE, field.value.span, message);
                self.report(error.help("write `polytope: [P, Q, G + a*B.x]`, points that move with it"));
            }
            return None;
        };
        if items.is_empty() {
            let error = Diagnostic::new(codes::SHAPE, field.value.span, "a polytope has vertices");
            self.report(error.help("write `polytope: [P, Q, G + a*B.x]`"));
            return None;
        }
        let read: Vec<Option<Anchor>> = items.iter().map(|item| self.anchor(item)).collect();
        let read: Vec<Anchor> = read.into_iter().collect::<Option<_>>()?;
        read.iter().all(|vertex| !self.points[vertex.point.0].broken).then_some(read)
    }

    /// The height of a surface or curve; other shapes have none.
    pub(super) fn height(&mut self, kind: Kind, field: &Field) -> Option<Option<Height>> {
        if !matches!(kind, Kind::Surface | Kind::Curve) {
            return Some(None);
        }
        if field.fields.is_some() {
            let message = "friction belongs to a contact; the surface of a shape is a height";
            let error = Diagnostic::new(codes::SHAPE, field.value.span, message);
            self.report(error.help("write `surface: h*sin(k*x)*cos(k*y)`"));
            return None;
        }
        let height = self.of_place(field, kind.places(), Some(Dimension::of(1, 0, 0)), "a height")?;
        let height = Height::of(height, field.value.span);
        if height.is_none() {
            self.without_slope("this height", field.value.span);
        }
        height.map(Some)
    }

    /// The function of an implicit surface; other shapes have none.
    pub(super) fn function(&mut self, kind: Kind, field: &Field) -> Option<Option<OfPlace<3>>> {
        if kind != Kind::Implicit {
            return Some(None);
        }
        let value = self.of_place(field, kind.places(), None, "the function of an implicit surface")?;
        let Some(function) = OfPlace::of(value, field.value.span) else {
            self.without_slope("this function", field.value.span);
            return None;
        };
        if !function.value.has_a_place() {
            let message = "the function of an implicit surface depends on the place x, y, z";
            let error = Diagnostic::new(codes::SHAPE, field.value.span, message);
            self.report(error.help("it vanishes on the surface and is positive outside: `x^2 + y^2 - r^2`"));
            return None;
        }
        Some(Some(function))
    }

    /// A function of the place along the first axes of a frame, and of parameters.
    fn of_place(
        &mut self,
        field: &Field,
        places: usize,
        dimension: Option<Dimension>,
        what: &str,
    ) -> Option<Scalar> {
        self.along_surface = places;
        let typed = self.expression(&field.value);
        self.along_surface = 0;
        let scalar = self.need_scalar(&typed, what)?;
        if let Some(dimension) = dimension {
            self.demand(&typed, dimension, what);
        }
        self.need_free_of_speeds(&typed, what);
        if typed.traits.moves || typed.traits.time || typed.traits.input.is_some() {
            let message = format!("{what} depends on its place and on parameters only");
            let error = Diagnostic::new(codes::SHAPE, typed.span, message);
            self.report(error.help("a ground that moves is a surface of a frame that moves: `of: Table`"));
            return None;
        }
        Some(scalar)
    }

    fn without_slope(&mut self, what: &str, span: Span) {
        let message = format!("{what} has no slope everywhere, so that the surface has no normal");
        let error = Diagnostic::new(codes::SHAPE, span, message);
        self.report(error.help("abs, sign, min, max and powers that depend on the place make edges"));
    }

    /// The density of a shape.
    pub(super) fn density(&mut self, field: &Field) -> Option<Scalar> {
        let what = "a density";
        let (scalar, typed) = self.scalar_like(&field.value, Dimension::of(-3, 1, 0), what)?;
        self.need_free_of_speeds(&typed, what);
        if typed.traits.moves || typed.traits.time || typed.traits.input.is_some() {
            let error = Diagnostic::new(codes::SHAPE, typed.span, "a density must be constant");
            self.report(error.help("it may depend on parameters only"));
            return None;
        }
        if typed.constant.is_some_and(|value| value <= 0.0) {
            self.error(codes::SHAPE, typed.span, "a density must be positive");
            return None;
        }
        Some(scalar)
    }
}
