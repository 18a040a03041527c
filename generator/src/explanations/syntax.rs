//! Explanations of E001 to E015: syntax.

use super::Explanation;
use crate::diagnostics::codes::*;

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: UNREADABLE,
        text: "The file is not there, may not be read, is not UTF-8, or its lines end with carriage returns alone, so that the first comment takes all that follows. The message says which. Models are plain text; save them as UTF-8, with line feeds.",
        wrong: None,
        right: None,
    },
    Explanation {
        code: TOO_LARGE,
        text: "Models have at most 4 MiB. A model of ten thousand parameters has a tenth of that: is it a model?",
        wrong: None,
        right: None,
    },
    Explanation {
        code: BAD_TOKEN,
        text: "A character or a quoted text that means nothing in a model. Models are sequences of Rust tokens: there is no degree sign, no superscript, no quoted text. Letters of another script that look like Latin ones make another name: a Cyrillic `а` among Latin letters is told.",
        wrong: Some("coordinates { q1: rad = 30° }"),
        right: Some("coordinates { q1: deg = 30 }"),
    },
    Explanation {
        code: BAD_NUMBER,
        text: "Numbers are plain decimals: `3`, `0.5`, `1e-3`. They carry no suffix and no `_`, and products are written with `*`.",
        wrong: Some("points { G = O - 0.5l*B.y; P = O - l*B.y; }"),
        right: Some("points { G = O - 0.5*l*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: UNBALANCED,
        text: "A bracket or a comment that is opened and not closed, or closed and not opened. Until brackets match nothing can be said of what is between them, so this comes alone.",
        wrong: Some("frames { B = N.rotate(z, q1; }"),
        right: Some("frames { B = N.rotate(z, q1); }"),
    },
    Explanation {
        code: EXPECTED,
        text: "Something else belongs here. Declarations are separated by commas, statements end with semicolons, each quantity has a unit after a colon.",
        wrong: Some("parameters { m: kg = 1 l: m = 0.5, g: m/s^2 = 9.81 }"),
        right: Some("parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }"),
    },
    Explanation {
        code: SECTION_UNKNOWN,
        text: "A model consists of sections; `docs/language.md` lists them.",
        wrong: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoint { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECTION_ORDER,
        text: "Sections stand in one order, so that every reader knows where to look. Names may be used before the line that declares them; only the sections are fixed. However many sections must move, it is said once, with the right order; everything else in the model is checked as if they stood right.",
        wrong: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\nspeeds { u1: m/s }\ncoordinates { q1: m }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECTION_TWICE,
        text: "Each section stands at most once; put all its entries together.",
        wrong: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\nparameters { a: m = 2 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + (q1 + a)*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\nparameters { m: kg = 1, a: m = 2 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + (q1 + a)*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: STRAY_DOCS,
        text: "`//!` documents the mechanism and stands at the top; `///` documents the entry that follows. Both become documentation of the generated module. Anything else is a plain comment, `//`.",
        wrong: Some("speeds { u1: rad/s /// its rate\n}"),
        right: Some("speeds {\n    /// its rate\n    u1: rad/s,\n}"),
    },
    Explanation {
        code: TOO_DEEP,
        text: "Brackets, signs and exponents are nested at most 64 deep, and names rest on names in chains of at most 300. Name parts of an expression under `definitions`.",
        wrong: Some(
            "points { G = O - ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((l))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))/2*B.y; P = O - l*B.y; }",
        ),
        right: Some("points { G = O - l/2*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: BAD_EXPRESSION,
        text: "This is no expression of the language: powers are written `^`, time derivatives `d(q1)/dt`, and a vector by its components names its frame.",
        wrong: Some("loads { gravity: [0, -g, 0]; }"),
        right: Some("loads { gravity: N.vec(0, -g, 0); }"),
    },
    Explanation {
        code: FIELD,
        text: "A field in braces is unknown, given twice, or needed and not there.",
        wrong: Some("contacts { tip { point: P of Rod, normals: -N.x } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: EMPTY,
        text: "A mechanism has at least one body or particle, and at least one independent speed.",
        wrong: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nloads { gravity: 0; force on P: 0; }\ncontacts { wall { point: P, normal: -N.x } }",
        ),
        right: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECOND_MECHANISM,
        text: "A model is one mechanism. Give each a file, or in Rust a `mechanism!`, of its own; what belongs to one system (two bodies that collide) is one mechanism.",
        wrong: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }\n\nmechanism Another;\nparameters { m: kg = 2 }",
        ),
        right: Some(
            "mechanism Cart;\nparameters { m: kg = 1 }\ncoordinates { q1: m }\nspeeds { u1: m/s }\npoints { P = O + q1*N.x; }\nparticles { Cart { point: P, mass: m } }",
        ),
    },
];
