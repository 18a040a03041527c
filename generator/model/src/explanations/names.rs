//! Explanations of E020 to E025: names.

use super::Explanation;
use crate::diagnostics::codes::*;

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: UNKNOWN_NAME,
        text: "The name is declared nowhere. It is reported once, where it is used first; mistakes that \
            follow from it are not reported.",
        wrong: Some("points { G = O - l/2*B.y; P = O - ll*B.y; }"),
        right: Some("points { G = O - l/2*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: DUPLICATE_NAME,
        text: "All names of a model share one name space: a point and a parameter cannot have the same name, nor the \
            index of a `for` and a coordinate.",
        wrong: Some("coordinates { q1: rad, l: m }"),
        right: Some("coordinates { q1: rad }"),
    },
    Explanation {
        code: RESERVED_NAME,
        text: "`N`, `O`, `time` and `pi` are predefined, in parts, as counts and as indices too, and keywords of Rust \
            cannot name anything in the generated code.",
        wrong: Some("frames { self = N.rotate(z, q1); B = self; }"),
        right: Some("frames { A = N.rotate(z, q1); B = A; }"),
    },
    Explanation {
        code: COLLISION,
        text: "Routines of the generated module are named in snake case: `TipWall` and `tip_wall` would \
            both be `collide_tip_wall`.",
        wrong: Some(
            "contacts {\n    tip_wall { point: P of Rod, normal: -N.x },\n    TipWall { point: P of Rod, \
            normal: N.x },\n\
            }",
        ),
        right: Some(
            "contacts {\n    tip_wall { point: P of Rod, normal: -N.x },\n    tip_other_wall { point: P of \
            Rod, normal: N.x },\n\
            }",
        ),
    },
    Explanation {
        code: CYCLE,
        text: "Definitions, frames and points may refer to each other in any order of lines, but not in a \
            circle.",
        wrong: Some("points { G = P + l/2*B.y; P = G - l/2*B.y; }"),
        right: Some("points { G = O - l/2*B.y; P = G - l/2*B.y; }"),
    },
    Explanation {
        code: WRONG_KIND,
        text: "The name exists, but names something of another kind: `centre` needs a point, `of` in a \
            contact a body, an expression a scalar or a vector.",
        wrong: Some("loads { gravity: -g*N; }"),
        right: Some("loads { gravity: -g*N.y; }"),
    },
];
