//! The pairs of shapes between which contacts are compiled, and into how many contacts each goes.

use super::hulls::{Hull, Hulls};
use super::mechanism::Kind;
use crate::syntax::tree::{ExprKind, Field, Name, Record, Tree};

/// Most contacts of one pair: more would take minutes to derive and to compile.
pub const MOST_CONTACTS: usize = 256;

/// Two shapes of a contact: `Foot on Floor` or `Ball in Bowl`.
#[derive(Clone, Copy)]
pub struct Pair<'t> {
    /// what strikes
    pub striking: &'t str,
    /// `on` or `in`
    pub word: &'t Name,
    /// what is struck
    pub struck: &'t Name,
    /// the whole
    pub field: &'t Field,
}

impl Pair<'_> {
    /// Whether the first is within the second.
    pub fn inside(&self) -> bool {
        self.word.text == "in"
    }
}

/// The pair of a contact, if it is one of shapes.
pub fn pair(contact: &Record) -> Option<Pair<'_>> {
    contact.fields.iter().find_map(|field| {
        let ExprKind::Name(striking) = &field.value.kind else { return None };
        let note = field.notes.first()?;
        let is_pair = ["on", "in"].contains(&field.name.text.as_str()) && note.word == field.name;
        is_pair.then_some(())?;
        Some(Pair { striking, word: &note.word, struck: note.name.as_ref()?, field })
    })
}

/// What of a shape tells how many contacts it has with another.
#[derive(Clone, Copy)]
pub struct Outline {
    /// what it is
    pub kind: Kind,
    /// how many vertices it has; shapes without vertices have none
    pub vertices: usize,
    /// how many edges, where that is known
    pub edges: Option<usize>,
}

impl Outline {
    /// That of a shape of a kind; of a polytope with so many vertices, and a hull.
    pub fn of(kind: Kind, vertices: usize, hull: Option<&Hull>) -> Outline {
        match kind {
            Kind::Box => Outline { kind, vertices: 8, edges: Some(12) },
            Kind::Polytope => Outline { kind, vertices, edges: hull.map(|hull| hull.edges.len()) },
            _ => Outline { kind, vertices: 0, edges: None },
        }
    }
}

/// What a record says that its shape is.
fn outline(shape: &Record, hulls: &Hulls) -> Option<Outline> {
    let (kind, field) =
        shape.fields.iter().find_map(|field| Some((Kind::of_word(&field.name.text)?, field)))?;
    let vertices = match &field.value.kind {
        ExprKind::List(vertices) if kind == Kind::Polytope => vertices.len(),
        _ => 0,
    };
    let hull = hulls.get(&shape.name.text).and_then(|hull| hull.as_ref().ok());
    Some(Outline::of(kind, vertices, hull))
}

/// Whether the contacts of a pair follow from the edges of a polytope.
fn needs_hulls(striking: Kind, inside: bool, struck: Kind) -> bool {
    use Kind::*;
    !inside && matches!((striking, struck), (Polytope | Box | Sphere | Capsule, Polytope) | (Polytope, Box))
}

/// The number of contacts between two shapes; `None`: none is compiled. Of polytopes whose edges are not known it is 1.
pub fn contacts(striking: Outline, inside: bool, struck: Outline) -> Option<usize> {
    use Kind::*;
    match (striking.kind, struck.kind, inside) {
        (Sphere | Disc | Torus | Ellipsoid, Plane | HalfSpace, false) => Some(1),
        (Capsule | Cylinder | Cone, Plane | HalfSpace, false) => Some(2),
        (Box, Plane | HalfSpace | Surface | Curve | Implicit, false) => Some(8),
        (Rectangle, Plane | HalfSpace | Curve | Implicit, false) => Some(4),
        // the vertices of both
        (Rectangle, Rectangle, false) => Some(8),
        // the vertices of both, and edges
        (Box, Box, false) => Some(8 + 8 + 9 * 4),
        (Polytope, Polytope | Box, false) | (Box, Polytope, false) => {
            Some(match (striking.edges, struck.edges) {
                (Some(own), Some(other)) => striking.vertices + struck.vertices + own * other,
                _ => 1,
            })
        }
        (Polytope, Plane | HalfSpace | Surface | Curve | Implicit, false) => Some(striking.vertices),
        (Capsule, Capsule, false) => Some(1),
        // its ends, and places between them at edges and vertices
        (Capsule, Box, false) => Some(2 + 12 + 8),
        (Capsule, Polytope, false) => Some(struck.edges.map_or(1, |edges| 2 + edges + struck.vertices)),
        (Capsule, Rectangle, false) => Some(2 + 4),
        (Sphere, Sphere | Capsule | Cylinder | Cone | Box | Rectangle | Disc | Torus | Polytope, false)
        | (Sphere | Disc | Torus | Ellipsoid, Surface | Curve | Implicit, false)
        | (Sphere | Ellipsoid, Ellipsoid, false) => Some(1),
        (Sphere, Sphere | Capsule | Cylinder, true) => Some(1),
        (Sphere, Box, true) => Some(6),
        _ => None,
    }
}

/// What a shape of this kind can be on, or in, for messages.
pub fn possible(striking: Kind) -> Vec<String> {
    let mut out = Vec::new();
    let outline = |kind| Outline::of(kind, 1, None);
    for (word, inside) in [("on", false), ("in", true)] {
        let fits = |struck: &Kind| contacts(outline(striking), inside, outline(*struck)).is_some();
        let list: Vec<String> = Kind::ALL.into_iter().filter(fits).map(Kind::with_article).collect();
        if !list.is_empty() {
            out.push(format!("{word} {}", list.join(", ")));
        }
    }
    out
}

/// The polytopes whose edges tell how many contacts a pair has, and those from which a body takes its mass.
pub fn need_hulls(tree: &Tree) -> Vec<&str> {
    let of_bodies = tree.bodies.iter().flat_map(|body| &body.fields);
    let of_bodies = of_bodies.filter(|field| field.name.text == "shape").filter_map(|field| {
        let ExprKind::Name(name) = &field.value.kind else { return None };
        let shape = tree.shapes.iter().find(|shape| shape.name.text == *name)?;
        (outline(shape, &Hulls::new())?.kind == Kind::Polytope).then_some(name.as_str())
    });
    let mut out: Vec<&str> = of_bodies.collect();
    for pair in tree.contacts.iter().filter_map(pair) {
        let shapes = [pair.striking, pair.struck.text.as_str()];
        let kinds = shapes.map(|name| {
            let shape = tree.shapes.iter().find(|shape| shape.name.text == name)?;
            Some(outline(shape, &Hulls::new())?.kind)
        });
        let [Some(striking), Some(struck)] = kinds else { continue };
        if needs_hulls(striking, pair.inside(), struck) {
            let polytopes = shapes.iter().zip([striking, struck]).filter(|(_, kind)| *kind == Kind::Polytope);
            out.extend(polytopes.map(|(name, _)| *name));
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// The names of all contacts, each with the number of its record: of a pair that gives several, `foot_floor`
/// becomes `foot_floor_1`, `foot_floor_2` and so on.
pub fn names(tree: &Tree, hulls: &Hulls) -> Vec<(Name, usize)> {
    let outline_of = |name: &str| outline(tree.shapes.iter().find(|shape| shape.name.text == name)?, hulls);
    let mut out = Vec::new();
    for (i, contact) in tree.contacts.iter().enumerate() {
        let count = pair(contact).and_then(|pair| {
            let count = contacts(outline_of(pair.striking)?, pair.inside(), outline_of(&pair.struck.text)?);
            count.filter(|count| *count <= MOST_CONTACTS)
        });
        match count {
            Some(count) if count > 1 => out.extend((1..=count).map(|number| {
                let text = format!("{}_{number}", contact.name.text);
                (Name { text, span: contact.name.span }, i)
            })),
            _ => out.push((contact.name.clone(), i)),
        }
    }
    out
}
