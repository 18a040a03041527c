//! The expressions of a tree, whatever they belong to.

use super::tree::{Expr, Field, Tree};

/// An expression that stands by itself.
#[derive(Clone, Copy, Debug)]
pub struct Root<'t> {
    /// the expression
    pub value: &'t Expr,
    /// the other side of its equation
    pub beside: Option<&'t Expr>,
    /// the unit that is stated for it
    pub unit: Option<&'t Expr>,
}

/// All expressions of a tree that are not parts of others, but for units.
pub fn roots(tree: &Tree) -> Vec<Root<'_>> {
    let mut out = Vec::new();
    let alone = |value| Root { value, beside: None, unit: None };
    let lists = [&tree.parameters, &tree.inputs, &tree.coordinates, &tree.speeds, &tree.dependent];
    for quantity in lists.into_iter().flatten() {
        out.extend(quantity.value.as_ref().map(|value| Root { unit: Some(&quantity.unit), ..alone(value) }));
    }
    for definition in &tree.definitions {
        out.push(Root { unit: definition.unit.as_ref(), ..alone(&definition.value) });
    }
    out.extend(tree.frames.iter().map(|frame| alone(&frame.value)));
    out.extend(tree.angular_velocities.iter().map(|stated| alone(&stated.value)));
    out.extend(tree.points.iter().map(|point| alone(&point.value)));
    out.extend(tree.velocities.iter().map(|stated| alone(&stated.value)));
    for record in tree.bodies.iter().chain(&tree.particles).chain(&tree.shapes).chain(&tree.contacts) {
        fields(&record.fields, &mut out);
    }
    for load in &tree.loads {
        out.extend(load.about.iter().chain(&load.value).map(alone));
        fields(&load.fields, &mut out);
    }
    for equation in tree.kinematics.iter().chain(&tree.constraints).chain(&tree.configuration) {
        out.push(Root { beside: Some(&equation.right), ..alone(&equation.left) });
        out.push(Root { beside: Some(&equation.left), ..alone(&equation.right) });
    }
    out
}

fn fields<'t>(list: &'t [Field], out: &mut Vec<Root<'t>>) {
    for field in list {
        match &field.fields {
            Some(inner) => fields(inner, out),
            None => out.push(Root { value: &field.value, beside: None, unit: None }),
        }
    }
}
