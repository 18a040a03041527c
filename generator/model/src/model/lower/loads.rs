//! Lowers loads.

use super::super::constancy::has_constant_coefficients;
use super::super::mechanism::{FrameId, Load, LoadKind, Scalar};
use super::super::typed::Typed;
use super::{Lowering, QuantityFacts};
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::number::Number;
use crate::span::Span;
use crate::syntax::tree::{self, Expr, ExprKind, Field, Name};
use crate::{suggest, vocabulary, words};

impl Lowering<'_> {
    pub(super) fn loads(&mut self) {
        let tree = self.tree;
        let mut gravity = None;
        for load in &tree.loads {
            if load.word.text == "gravity" {
                if let Some(first) = gravity {
                    let error = Diagnostic::new(codes::LOAD, load.word.span, "gravity is stated twice")
                        .related(first, "first here")
                        .help("it acts on everything that has mass: leave one of them out");
                    self.report(error);
                }
                gravity = Some(load.word.span);
            }
            let kind = match load.word.text.as_str() {
                "gravity" => self.gravity(load),
                "force" => self.force(load),
                "torque" => self.torque(load),
                "spring" => self.spring(load),
                "torsion" => self.torsion(load),
                other => {
                    let error =
                        Diagnostic::new(codes::LOAD, load.word.span, format!("there is no load `{other}`"));
                    let near =
                        vocabulary::load(other).or_else(|| suggest::nearest(other, words::LOADS.into_iter()));
                    self.report(match near {
                        Some("spring") if other.contains("damper") || other == "dashpot" => error
                            .help("a damper is a spring with `damping`: `spring P to H: { damping: c };`"),
                        Some(near) => error.did_you_mean(near),
                        None => error.help("loads are gravity, force, torque, spring and torsion"),
                    });
                    None
                }
            };
            if let Some(kind) = kind {
                let end =
                    |word: &&str| load.ends.iter().find(|(w, _)| w.as_ref().map_or("", |w| &w.text) == *word);
                let ends =
                    ["on", "", "from", "to"].iter().filter_map(end).map(|(_, name)| name.span).collect();
                let potential = has_constant_coefficients(&self.out, &kind);
                self.out.loads.push(Load { kind, potential, ends, span: load.span });
            }
        }
    }

    /// The names after these words (the empty word: no word); reports others.
    fn ends<'l, const N: usize>(
        &mut self,
        load: &'l tree::Load,
        words: [&str; N],
        needed: usize,
        form: &str,
    ) -> Option<[Option<&'l Name>; N]> {
        let mut found: [Option<&Name>; N] = [None; N];
        let mut wrong = None;
        for (word, name) in &load.ends {
            let text = word.as_ref().map_or("", |word| word.text.as_str());
            match words.iter().position(|w| *w == text) {
                Some(i) if found[i].is_none() => found[i] = Some(name),
                _ => wrong = wrong.or(Some(word.as_ref().unwrap_or(name).span)),
            }
        }
        if wrong.is_some() || found.iter().take(needed).any(Option::is_none) {
            let message = format!("this {} is not stated correctly", load.word.text);
            let error = Diagnostic::new(codes::LOAD, wrong.unwrap_or(load.word.span), message);
            let error = if wrong.is_some() { error.label("this does not belong here") } else { error };
            self.report(error.help(format!("write `{form}`")));
            return None;
        }
        Some(found)
    }

    fn value<'l>(&mut self, load: &'l tree::Load, form: &str) -> Option<&'l Expr> {
        if load.value.is_none() || load.about.is_some() {
            let message = format!("a {} is one vector", load.word.text);
            self.report(Diagnostic::new(codes::LOAD, load.span, message).help(format!("write `{form}`")));
            return None;
        }
        load.value.as_ref()
    }

    /// A load and its opposite on the same thing do nothing.
    fn on_itself(&mut self, load: &tree::Load, what: &str, form: &str) {
        let places: Vec<Span> = load.ends.iter().map(|(_, name)| name.span).collect();
        let (Some(first), Some(last)) = (places.first(), places.last()) else { return };
        let error = Diagnostic::new(codes::LOAD, *last, format!("{what} does nothing"))
            .related(*first, "it acts here")
            .help(format!("name two different ones: `{form}`; without `from` there is no opposite"));
        self.report(error);
    }

    fn vector_load(
        &mut self,
        expr: &Expr,
        dimension: Dimension,
        what: &str,
    ) -> Option<super::super::mechanism::Vector> {
        let typed = self.expression(expr);
        let vector = self.need_vector(&typed, what)?;
        self.demand(&typed, dimension, what);
        Some(vector)
    }

    fn gravity(&mut self, load: &tree::Load) -> Option<LoadKind> {
        let form = "gravity: -g*N.z;";
        self.ends(load, [], 0, form)?;
        let value = self.value(load, form)?;
        let typed = self.expression(value);
        let vector = self.need_vector(&typed, "the acceleration of gravity")?;
        self.demand(&typed, Dimension::of(1, 0, -2), "the acceleration of gravity");
        self.need_free_of_speeds(&typed, "the acceleration of gravity");
        Some(LoadKind::Gravity(vector))
    }

    fn force(&mut self, load: &tree::Load) -> Option<LoadKind> {
        let form = "force on P: F*N.x;` or `force on P from Q: F*N.x;";
        let [on, from] = self.ends(load, ["on", "from"], 1, form)?;
        let on = on.and_then(|name| self.point_named(name));
        let from = from.map(|name| self.point_named(name));
        let value = self.value(load, form)?;
        let force = self.vector_load(value, Dimension::of(1, 1, -2), "a force");
        let from = match from {
            None => None,
            Some(point) => Some(point?),
        };
        if on.is_some() && from == on {
            self.on_itself(load, "a force on a point from itself", "force on P from Q: F*N.x;");
        }
        Some(LoadKind::Force { on: on?, from, force: force? })
    }

    fn torque(&mut self, load: &tree::Load) -> Option<LoadKind> {
        let form = "torque on B: tau*N.z;` or `torque on B from A: tau*N.z;";
        let [on, from] = self.ends(load, ["on", "from"], 1, form)?;
        let on = on.and_then(|name| self.frame_named(name));
        let from = from.map(|name| self.frame_named(name));
        let value = self.value(load, form)?;
        let torque = self.vector_load(value, Dimension::of(2, 1, -2), "a torque");
        let from = match from {
            None => None,
            Some(frame) => Some(frame?),
        };
        if on.is_some() && from == on {
            self.on_itself(load, "a torque on a body from itself", "torque on B from A: tau*N.z;");
        }
        Some(LoadKind::Torque { on: on?, from, torque: torque? })
    }

    fn spring_value(&mut self, field: Option<&Field>, dimension: Dimension, what: &str) -> Option<Scalar> {
        let Some(field) = field else { return Some(Scalar::Number(Number::integer(0))) };
        self.notes(field, &[]);
        let (scalar, typed) = self.scalar_like(&field.value, dimension, what)?;
        self.need_free_of_speeds(&typed, what);
        Some(scalar)
    }

    fn owner(load: &tree::Load) -> Name {
        Name { text: load.word.text.clone(), span: load.word.span }
    }

    fn spring(&mut self, load: &tree::Load) -> Option<LoadKind> {
        let form = "spring P to H: { stiffness: k, length: l0, damping: c };";
        let [a, b] = self.ends(load, ["", "to"], 2, form)?;
        let ends = [a, b].map(|name| name.and_then(|name| self.point_named(name)));
        if load.value.is_some() || load.about.is_some() {
            let error = Diagnostic::new(codes::LOAD, load.span, "a spring has fields")
                .help(format!("write `{form}`"));
            self.report(error);
            return None;
        }
        let known = words::SPRING;
        let [stiffness, length, damping] =
            self.record("a spring", &Self::owner(load), &load.fields, known, &[]);
        let stiffness = self.spring_value(stiffness, Dimension::of(0, 1, -2), "a stiffness");
        let length = self.spring_value(length, Dimension::of(1, 0, 0), "a length");
        let damping = self.spring_value(damping, Dimension::of(0, 1, -1), "a damping");
        let [a, b] = ends;
        let (a, b) = (a?, b?);
        if a == b {
            let error = Diagnostic::new(codes::LOAD, load.span, "a spring between a point and itself");
            self.report(error.help("name two points"));
            return None;
        }
        self.same_root(a, b, load);
        Some(LoadKind::Spring { a, b, stiffness: stiffness?, length: length?, damping: damping? })
    }

    /// The distance of two points is known only if their positions are known from the same point.
    fn same_root(
        &mut self,
        a: super::super::mechanism::PointId,
        b: super::super::mechanism::PointId,
        load: &tree::Load,
    ) {
        let (ra, rb) = (self.points[a.0].root, self.points[b.0].root);
        if ra == rb {
            return;
        }
        let unknown = if ra != 0 { ra } else { rb };
        let (name, place) = (self.out.points[unknown].name.clone(), self.out.points[unknown].span);
        let error =
            Diagnostic::new(codes::NO_POSITION, load.span, "the distance of these points is not known")
                .related(place, format!("`{name}` is given by its velocity only"));
        self.report(error);
    }

    /// The coordinate by which a frame is turned; else the first that is an angle.
    fn angle_of(&self, frame: FrameId) -> Option<String> {
        let turned = frame.0.checked_sub(1).and_then(|i| match &self.tree.frames.get(i)?.value.kind {
            ExprKind::Method(_, _, arguments) => match &arguments.last()?.kind {
                ExprKind::Name(angle) => Some(angle.clone()),
                _ => None,
            },
            _ => None,
        });
        let angle = |facts: &QuantityFacts| facts.unit.as_ref().is_some_and(|unit| unit.dimension.is_none());
        let mut coordinates = self.tree.coordinates.iter().zip(&self.coordinates);
        turned.or_else(|| Some(coordinates.find(|(_, facts)| angle(facts))?.0.name.text.clone()))
    }

    fn torsion(&mut self, load: &tree::Load) -> Option<LoadKind> {
        let form = "torsion B from A about A.y: { angle: q3, rest: t0, stiffness: kt, damping: ct };";
        let [on, from] = self.ends(load, ["", "from"], 1, form)?;
        let on = on.and_then(|name| self.frame_named(name));
        let from = from.map(|name| self.frame_named(name));
        let (Some(about), None) = (&load.about, &load.value) else {
            let error = Diagnostic::new(codes::LOAD, load.span, "a torsion spring has an axis and fields");
            self.report(error.help(format!("write `{form}`")));
            return None;
        };
        let axis: Typed = self.expression(about);
        let vector = self.need_vector(&axis, "the axis of a torsion spring");
        self.demand(&axis, Dimension::none(), "the axis of a torsion spring");
        self.need_free_of_speeds(&axis, "the axis of a torsion spring");
        let known = words::TORSION;
        let owner = Self::owner(load);
        let [angle, rest, stiffness, damping] =
            self.record("a torsion spring", &owner, &load.fields, known, &["angle"]);
        if angle.is_none()
            && let Some(coordinate) = on.and_then(|frame| self.angle_of(frame))
            && let Some(error) = self.diagnostics.last_mut()
            && (error.code, error.primary.span) == (codes::FIELD, owner.span)
        {
            error.help = Some(format!("add `angle: {coordinate}`"));
        }
        let angle_span = angle.map(|field| field.value.span);
        let angle = match angle {
            None => None,
            Some(field) => {
                self.notes(field, &[]);
                let read = self.scalar_like(&field.value, Dimension::none(), "an angle");
                read.map(|(scalar, typed)| {
                    self.need_free_of_speeds(&typed, "an angle");
                    self.need_rate(&typed, "an angle");
                    scalar
                })
            }
        };
        let rest = self.spring_value(rest, Dimension::none(), "an angle");
        let stiffness = self.spring_value(stiffness, Dimension::of(2, 1, -2), "a torsional stiffness");
        let damping = self.spring_value(damping, Dimension::of(2, 1, -1), "a torsional damping");
        let from = match from {
            None => None,
            Some(frame) => Some(frame?),
        };
        if on.is_some() && from == on {
            self.on_itself(load, "a torsion spring from a body to itself", form);
        }
        let angle_span = angle_span.unwrap_or(load.span);
        Some(LoadKind::Torsion {
            on: on?,
            from,
            axis: vector?,
            angle: angle?,
            angle_span,
            rest: rest?,
            stiffness: stiffness?,
            damping: damping?,
        })
    }
}
