//! Explanations of E085 and E086: shapes, and contacts between them.

use super::Explanation;
use crate::diagnostics::codes::*;

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: SHAPE,
        text: "A shape is one of sphere, capsule, cylinder, cone, disc, torus, ellipsoid, box, rectangle, \
            polytope, plane, half_space, surface, curve and implicit, with its dimensions: lengths that are positive and \
            depend on parameters only. It moves with the body or frame after `of`, without which it is fixed in N; its \
            place `at`, its vertices and its axis must move with that too. Round shapes have an `axis`, which is \
            a unit vector. A body that takes its mass from a shape needs one with volume and `density`.",
        wrong: Some(
            "shapes { Knob { of: Rod, at: P, sphere: -l/10 }, Wall { at: O + l*N.x, plane: -N.x } }\n\
            contacts { tip { Knob on Wall } }",
        ),
        right: Some(
            "shapes { Knob { of: Rod, at: P, sphere: l/10 }, Wall { at: O + l*N.x, plane: -N.x } }\n\
            contacts { tip { Knob on Wall } }",
        ),
    },
    Explanation {
        code: PAIR,
        text: "Contacts are compiled between these pairs of shapes: everything convex on a plane, a sphere on (or in) a sphere, \
            capsule, cylinder or box, and on a disc, torus, cone, ellipsoid or polytope, a sphere, disc, torus or ellipsoid on a surface, curve or implicit surface, a capsule on a capsule, a box or a \
            polytope, boxes and polytopes on each other, an ellipsoid on an ellipsoid, the vertices of a box or polytope on such a surface, and, in a mechanism that moves in a plane, a capsule or a rectangle on a rectangle. What strikes stands first. The faces of a \
            polytope are those of the convex hull of its points, at the values that the model gives: each point must be a vertex, not all may be in \
            one plane, and a pair may have 256 contacts at most. Other pairs whose edges and faces end are not compiled: place spheres at the \
            corners that meet, or state points, normals and gaps.",
        wrong: Some(
            "shapes { Bar { of: Rod, cylinder: [l/20, l], axis: B.y }, Post { at: O + l*N.x, box: [l/4, l, l] } }\n\
            contacts { tip { Bar on Post } }",
        ),
        right: Some(
            "shapes { Knob { of: Rod, at: P, sphere: l/20 }, Post { at: O + l*N.x, box: [l/4, l, l] } }\n\
            contacts { tip { Knob on Post } }",
        ),
    },
];
