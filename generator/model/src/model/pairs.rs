//! The pairs of shapes between which contacts are compiled, and into how many contacts each goes.

use super::mechanism::Kind;
use crate::syntax::tree::{ExprKind, Field, Name, Record, Tree};

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

/// What a record says that its shape is, and how many vertices it lists.
pub fn kind(shape: &Record) -> Option<(Kind, usize)> {
    let (kind, field) =
        shape.fields.iter().find_map(|field| Some((Kind::of_word(&field.name.text)?, field)))?;
    let vertices = match &field.value.kind {
        ExprKind::List(vertices) if kind == Kind::Polytope => vertices.len(),
        _ => 0,
    };
    Some((kind, vertices))
}

/// The number of contacts between a shape of a kind, with so many vertices, and another; `None`: none is
/// compiled.
pub fn contacts((striking, vertices): (Kind, usize), inside: bool, struck: Kind) -> Option<usize> {
    use Kind::*;
    match (striking, struck, inside) {
        (Sphere | Disc | Torus | Ellipsoid, Plane | HalfSpace, false) => Some(1),
        (Capsule | Cylinder | Cone, Plane | HalfSpace, false) => Some(2),
        (Box, Plane | HalfSpace | Surface | Curve, false) => Some(8),
        (Rectangle, Plane | HalfSpace | Curve, false) => Some(4),
        // the vertices of both
        (Rectangle, Rectangle, false) => Some(8),
        // the vertices of both, and edges
        (Box, Box, false) => Some(8 + 8 + 9 * 4),
        (Polytope, Plane | HalfSpace | Surface | Curve, false) => Some(vertices),
        (Capsule, Capsule, false) => Some(1),
        // its ends, and places between them at edges and vertices
        (Capsule, Box, false) => Some(2 + 12 + 8),
        (Capsule, Rectangle, false) => Some(2 + 4),
        (Sphere, Sphere | Capsule | Cylinder | Box | Rectangle | Disc | Torus, false) => Some(1),
        (Sphere, Sphere | Capsule | Cylinder, true) => Some(1),
        (Sphere, Box, true) => Some(6),
        _ => None,
    }
}

/// What a shape of this kind can be on, or in, for messages.
pub fn possible(striking: Kind) -> Vec<String> {
    let mut out = Vec::new();
    for (word, inside) in [("on", false), ("in", true)] {
        let struck =
            Kind::ALL.into_iter().filter(|struck| contacts((striking, 1), inside, *struck).is_some());
        let list: Vec<String> = struck.map(Kind::with_article).collect();
        if !list.is_empty() {
            out.push(format!("{word} {}", list.join(", ")));
        }
    }
    out
}

/// The names of all contacts, each with the number of its record: of a pair that gives several, `foot_floor`
/// becomes `foot_floor_1`, `foot_floor_2` and so on.
pub fn names(tree: &Tree) -> Vec<(Name, usize)> {
    let kind_of = |name: &str| kind(tree.shapes.iter().find(|shape| shape.name.text == name)?);
    let mut out = Vec::new();
    for (i, contact) in tree.contacts.iter().enumerate() {
        let count = pair(contact).and_then(|pair| {
            let (struck, _) = kind_of(&pair.struck.text)?;
            contacts(kind_of(pair.striking)?, pair.inside(), struck)
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
