//! Lowers positions and velocities of points.

use super::super::mechanism::{Place, PointId, Vector};
use super::super::names::Symbol;
use super::super::typed::{Traits, Typed};
use super::Lowering;
use super::sums::negated;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Name};

impl Lowering<'_> {
    /// The place of point `i`.
    pub(super) fn position(&mut self, i: usize) {
        if i > 0 {
            self.points[i].broken = self.read_position(i).is_none();
        }
    }

    fn read_position(&mut self, i: usize) -> Option<()> {
        let index = i.checked_sub(1)?;
        let source = &self.tree.points[index];
        self.points[i].root = 0;
        let frame = source.of.as_ref().map(|of| self.frame_named(of));
        if source.by_velocity {
            self.points[i].root = i;
            if let Some(of) = &source.of {
                let error = Diagnostic::new(
                    codes::POINT,
                    of.span,
                    "a point given by its velocity is not placed on a body",
                )
                .help("remove `of ..`, or state a position with `=`");
                self.report(error);
            }
            return Some(());
        }
        let (from, by, traits) = self.offset(&source.value)?;
        let origin = self.points[from.0].clone();
        self.points[i].root = origin.root;
        self.points[i].position = origin.position.plus(traits);
        self.out.points[i].place = match frame {
            None => Place::Offset { from, by },
            Some(Some(frame)) => Place::Material { frame, from, by },
            Some(None) => return None,
        };
        (!origin.broken).then_some(())
    }

    /// `Q + vector`: the point and the vector.
    pub(super) fn offset(&mut self, value: &Expr) -> Option<(PointId, Vector, Traits)> {
        let single = [(false, value.clone())];
        let terms: &[(bool, Expr)] = match &value.kind {
            ExprKind::Sum(terms) => terms,
            _ => &single,
        };
        let mut origins: Vec<(PointId, Span)> = Vec::new();
        let mut rest = Vec::new();
        for (negative, term) in terms {
            if let ExprKind::Name(text) = &term.kind
                && let Some(symbol @ Symbol::Point(p)) = self.names.get(text)
            {
                self.places.uses(symbol, term.span);
                if *negative {
                    let error = Diagnostic::new(codes::POINT, term.span, "a point cannot be subtracted")
                        .help("the vector from Q to P is `position(P, Q)`");
                    self.report(error);
                    return None;
                }
                origins.push((PointId(p), term.span));
                continue;
            }
            let typed = self.expression(term);
            rest.push(if *negative { negated(typed) } else { typed });
        }
        let poisoned = rest.iter().any(Typed::is_poison);
        match origins[..] {
            [] if poisoned => None,
            [] => {
                let error =
                    Diagnostic::new(codes::POINT, value.span, "a position is stated from another point")
                        .help("write `P = O + ..;`, where O is fixed in N");
                self.report(error);
                None
            }
            [(_, first), (_, second), ..] => {
                let error = Diagnostic::new(codes::POINT, second, "points cannot be added")
                    .related(first, "this is the point from which the position is stated")
                    .help("the vector from Q to P is `position(P, Q)`");
                self.report(error);
                None
            }
            [(from, _)] => {
                let by = match rest.len() {
                    0 => Typed::vector(Vector::Zero, None, Traits::default(), value.span),
                    1 => rest.remove(0),
                    _ => self.add(rest, value.span),
                };
                let vector = self.need_vector(&by, "the vector from one point to another")?;
                self.demand(&by, Dimension::of(1, 0, 0), "the vector from one point to another");
                self.need_free_of_speeds(&by, "a position");
                self.need_rate(&by, "a position");
                Some((from, vector, by.traits.given()))
            }
        }
    }

    /// The velocity of point `i`.
    pub(super) fn velocity(&mut self, i: usize) {
        let Some(index) = i.checked_sub(1) else { return };
        let source = &self.tree.points[index];
        let per_second = Dimension::of(1, 0, -1);
        if source.by_velocity {
            let (vector, traits) = self.velocity_like(&source.value, per_second, "a velocity");
            self.points[i].velocity = traits;
            if let Some(vector) = vector {
                self.out.points[i].place = Place::Velocity(vector);
            }
        } else {
            self.points[i].velocity = match &self.out.points[i].place {
                Place::Material { frame, from, .. } => {
                    self.points[from.0].velocity.plus(self.frames[frame.0].angular_velocity)
                }
                Place::Offset { from, .. } => {
                    let position = self.points[i].position;
                    self.points[from.0].velocity.plus(position.derivative(source.name.span))
                }
                _ => Traits::default(),
            };
        }
        let Some(stated) = self.stated.velocities.get(source.name.text.as_str()).copied() else {
            return;
        };
        if source.by_velocity {
            let message = format!("the velocity of `{}` is stated under `points` already", source.name.text);
            let error = Diagnostic::new(codes::MOTION_TWICE, stated.point.span, message)
                .related(source.value.span, "here")
                .help("remove one of the two");
            self.report(error);
            return;
        }
        let (vector, traits) = self.velocity_like(&stated.value, per_second, "a velocity");
        self.points[i].velocity = traits;
        self.out.points[i].velocity = vector;
    }

    /// The body of this name.
    pub(super) fn body_named(&mut self, name: &Name) -> Option<super::super::mechanism::BodyId> {
        // that there is none at all is said already
        if self.out.bodies.is_empty() && self.names.get(&name.text).is_none() {
            return None;
        }
        match self.resolve(name, |s| matches!(s, Symbol::Body(_)))? {
            Symbol::Body(b) => Some(super::super::mechanism::BodyId(b)),
            other => {
                self.wrong_kind(name, "a body", &format!("`{}` is {}", name.text, other.kind()));
                None
            }
        }
    }
}
