//! Explanations of E001 to E015: syntax.

use super::Explanation;
use crate::diagnostics::codes::*;

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: UNREADABLE,
        text: "The file does not exist, may not be read, is not UTF-8, or its lines end with carriage \
            returns only, so that everything after the first comment belongs to it. The message says which. \
            Models are plain text; save them as UTF-8, with line feeds.",
        wrong: None,
        right: None,
    },
    Explanation {
        code: TOO_LARGE,
        text: "Models have at most 4 MiB; ten thousand parameters take a tenth of that. Check that the file \
            is a model. Mechanisms have a limited number of coordinates and speeds, and at most eight \
            dependent speeds (or rates of coordinates) can hang together, each known only with the others: \
            their constraints are solved in closed form. A loop of more bodies is stated in parts, each with \
            speeds of its own.",
        wrong: None,
        right: None,
    },
    Explanation {
        code: BAD_TOKEN,
        text: "A character or a quoted text that has no meaning in a model. A model consists of Rust \
            tokens: there are no degree signs, no superscripts and no quoted texts. Letters of another \
            script that look like Latin ones give a different name: a Cyrillic `а` among Latin letters is \
            reported.",
        wrong: Some("coordinates { q1: rad = 30° }"),
        right: Some("coordinates { q1: deg = 30 }"),
    },
    Explanation {
        code: BAD_NUMBER,
        text: "Numbers are plain decimals: `3`, `0.5`, `1e-3`. They carry no suffix and no `_`, and \
            products are written with `*`.",
        wrong: Some("points { G = O - 0.5l*B.y; P = O - l*B.y; }"),
        right: Some("points { G = O - 0.5*l*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: UNBALANCED,
        text: "A bracket or a comment that is opened and not closed, or closed and not opened. Until \
            brackets match, nothing between them can be checked: other mistakes are reported once they do.",
        wrong: Some("frames { B = N.rotate(z, q1; }"),
        right: Some("frames { B = N.rotate(z, q1); }"),
    },
    Explanation {
        code: EXPECTED,
        text: "The text cannot continue in this way; the message says what is expected. Declarations are \
            separated by commas, statements end with semicolons, each quantity has a unit after a colon.",
        wrong: Some("parameters { m: kg = 1 l: m = 0.5, g: m/s^2 = 9.81 }"),
        right: Some("parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }"),
    },
    Explanation {
        code: SECTION_UNKNOWN,
        text: "A model consists of sections; `docs/language.md` lists them.",
        wrong: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            point { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECTION_ORDER,
        text: "Sections have a fixed order, so that every reader knows where to look. Names may be used \
            before the line that declares them. The message gives the right order, once for all sections \
            that must move; the rest of the model is checked as if they were in order.",
        wrong: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            speeds { u1: m/s }\n\
            coordinates { q1: m }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECTION_TWICE,
        text: "Each section stands at most once; put all its entries together.",
        wrong: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            parameters { a: m = 2 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + (q1 + a)*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1, a: m = 2 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + (q1 + a)*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: STRAY_DOCS,
        text: "`//!` documents the mechanism and stands at the top; `///` documents the entry that follows. \
            Both become documentation of the generated module. For other comments use `//`.",
        wrong: Some("speeds { u1: rad/s /// its rate\n}"),
        right: Some("speeds {\n    /// its rate\n    u1: rad/s,\n}"),
    },
    Explanation {
        code: TOO_DEEP,
        text: "Brackets, signs and exponents are nested at most 64 deep, and names refer to other names in \
            chains of at most 600. Give parts of an expression a name under `definitions`.",
        wrong: Some(
            "points { G = O - \
            ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((l))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))/2*B.y; \
            P = O - l*B.y; }",
        ),
        right: Some("points { G = O - l/2*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: BAD_EXPRESSION,
        text: "This is not an expression of the language. Powers are written `^`, time derivatives \
            `d(q1)/dt`, and a vector given by its components needs a frame: `N.vec(a, b, c)`.",
        wrong: Some("loads { gravity: [0, -g, 0]; }"),
        right: Some("loads { gravity: N.vec(0, -g, 0); }"),
    },
    Explanation {
        code: FIELD,
        text: "A field in braces is unknown, given twice, or required and missing.",
        wrong: Some("contacts { tip { point: P of Rod, normals: -N.x } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: EMPTY,
        text: "A mechanism has at least one body or particle, and at least one independent speed.",
        wrong: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            loads { gravity: 0; force on P: 0; }\n\
            contacts { wall { point: P, normal: -N.x } }",
        ),
        right: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: SECOND_MECHANISM,
        text: "A model is one mechanism. Give each a file, or in Rust a `mechanism!`, of its own; what \
            belongs to one system (two bodies that collide) is one mechanism.",
        wrong: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }\n\
            \n\
            mechanism Another;\n\
            parameters { m: kg = 2 }",
        ),
        right: Some(
            "mechanism Cart;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            particles { Cart { point: P, mass: m } }",
        ),
    },
];
