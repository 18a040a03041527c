//! Mass, mass centre and inertia of polytopes of uniform density (section 16.8 of docs/theory.md): sums over tetrahedra
//! between the mean of the vertices and the triangles of the faces.

use super::algebra::*;
use super::masses::MassProperties;
use super::shared::Shared;
use super::solids::{Components, difference, inner, keep, outer, vector, vertices_of};
use crate::model::hulls::Hull;
use crate::model::mechanism::{Definition, Scalar, Shape};
use crate::span::Span;

/// The mass properties of a polytope with this hull and density, along the axes of its frame.
pub fn mass_properties(
    shape: &Shape,
    hull: &Hull,
    density: &Scalar,
    definitions: &mut Vec<Definition>,
    at: Span,
) -> MassProperties {
    let shared = &mut Shared::one(shape, definitions, at);
    let vertices = vertices_of(shape, hull, shared);
    let count = i64::try_from(vertices.len()).unwrap_or(1);
    let middle: Components = std::array::from_fn(|i| {
        product([ratio(1, count), all(vertices.iter().map(|vertex| vertex[i].clone()))])
    });
    let middle = keep(middle, "mean of the vertices", shared);
    let from_middle: Vec<Components> =
        vertices.iter().map(|v| keep(difference(v, &middle), "vertex from the mean", shared)).collect();
    // sums over tetrahedra of six times the volume: alone, times the sum of its corners, and times the sum of the
    // products of these with each other
    let mut volumes: Vec<Scalar> = Vec::new();
    let mut firsts: [Vec<Scalar>; 3] = Default::default();
    let mut seconds: [Vec<Scalar>; 6] = Default::default();
    for face in &hull.faces {
        for i in 1..face.len().saturating_sub(1) {
            let [a, b, c] = [0, i, i + 1].map(|corner| &from_middle[face[corner]]);
            let volume = shared.scalar(inner(a, &outer(b, c)), "volume of a tetrahedron");
            let sum: Components = std::array::from_fn(|k| all([a, b, c].map(|corner| corner[k].clone())));
            let sum = keep(sum, "sum of corners", shared);
            for (k, first) in firsts.iter_mut().enumerate() {
                first.push(product([volume.clone(), sum[k].clone()]));
            }
            for (second, [k, l]) in seconds.iter_mut().zip(PRODUCTS) {
                let corners = [a, b, c, &sum].map(|corner| product([corner[k].clone(), corner[l].clone()]));
                second.push(product([volume.clone(), all(corners)]));
            }
            volumes.push(volume);
        }
    }
    let volume = shared.scalar(all(volumes), "volume");
    // the mass centre from the mean of the vertices, and second moments about the mass centre
    let centre = firsts.map(|sum| quotient(all(sum), product([integer(4), volume.clone()]), at));
    let centre = keep(centre, "mass centre", shared);
    let mass = shared.scalar(product([ratio(1, 6), density.clone(), volume]), "mass");
    let mut moments = seconds.into_iter().zip(PRODUCTS).map(|(sum, [k, l])| {
        let about_mean = product([ratio(1, 120), density.clone(), all(sum)]);
        less(about_mean, product([mass.clone(), centre[k].clone(), centre[l].clone()]))
    });
    let moments: [Scalar; 6] = std::array::from_fn(|_| moments.next().unwrap_or_else(|| integer(0)));
    let [xx, yy, zz, xy, yz, zx] = moments.map(|moment| shared.scalar(moment, "second moment"));
    let place: Components = std::array::from_fn(|i| all([middle[i].clone(), centre[i].clone()]));
    MassProperties {
        mass,
        inertia: [all([yy.clone(), zz.clone()]), all([zz, xx.clone()]), all([xx, yy])],
        products: [xy, yz, zx].map(opposite_of),
        frame: shape.frame,
        centre: vector(shape.frame, place),
    }
}

/// Which components the second moments xx, yy, zz, xy, yz and zx are of.
const PRODUCTS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];
