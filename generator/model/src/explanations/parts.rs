//! Explanations of E090 to E100: parts and imports.

use super::Explanation;
use crate::diagnostics::codes::*;

/// A chain of rods, to the place where it is used.
macro_rules! chain {
    ($($rest:literal),* $(,)?) => {
        Some(concat!(
            "mechanism Chain;\n",
            "part Link(hinge: point) {\n",
            "    parameters { shared m: kg, shared l: m }\n",
            "    coordinates { q: rad }\n",
            "    speeds { u: rad/s }\n",
            "    frames { B = N.rotate(z, q); }\n",
            "    points { tip = hinge - l*B.y; }\n",
            "    particles { Bob { point: tip, mass: m } }\n",
            "}\n",
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }\n",
            "loads { gravity: -g*N.y; }\n",
            $($rest),*
        ))
    };
}

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: IMPORT,
        text: "`import \"leg.mech\";` reads the parts of another file. Its path is relative to the file that \
            imports it (in a `mechanism!` of a Rust source, to Cargo.toml). The file must be there, and it \
            holds parts and imports only, no mechanism. A text that comes from no file imports none.",
        wrong: chain!("import \"leg.mech\";\n", "use Link as link(hinge: O);\n"),
        right: chain!("use Link as link(hinge: O);\n"),
    },
    Explanation {
        code: IMPORT_CYCLE,
        text: "A file imports itself, directly or through the files that it imports. Move the parts that two \
            files need of each other to one of them, or to a third.",
        wrong: None,
        right: None,
    },
    Explanation {
        code: PART_UNKNOWN,
        text: "`use` names a part that is neither declared in this file nor in one that it imports. What an \
            imported file imports for itself is not seen: import it here, too.",
        wrong: chain!("use Lnk as link(hinge: O);\n"),
        right: chain!("use Link as link(hinge: O);\n"),
    },
    Explanation {
        code: PART_CYCLE,
        text: "A part uses itself, directly or through the parts that it uses, which has no end. What is \
            repeated is stated by `for`.",
        wrong: Some(
            "mechanism Chain;\n\
            part Link(hinge: point) {\n    \
                coordinates { q: rad }\n    \
                speeds { u: rad/s }\n    \
                frames { B = N.rotate(z, q); }\n    \
                points { tip = hinge - 1*B.y; }\n    \
                use Link as next(hinge: tip);\n\
            }\n\
            use Link as link(hinge: O);\n",
        ),
        right: chain!(
            "use Link as link[1](hinge: O);\n",
            "for i in 2..3 { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
    },
    Explanation {
        code: ARGUMENT_UNKNOWN,
        text: "A use gives something that its part does not take, or gives it twice. A part takes the \
            arguments in its brackets, and values for the parameters, inputs, coordinates and speeds that it \
            declares and does not share.",
        wrong: chain!("use Link as link(hinge: O, lenght: 0.4);\n"),
        right: chain!("use Link as link(hinge: O, q: 0.4);\n"),
    },
    Explanation {
        code: ARGUMENT_MISSING,
        text: "A use must give every argument of its part that has no value of its own, as `n: count = 3` has.",
        wrong: chain!("use Link as link();\n"),
        right: chain!("use Link as link(hinge: O);\n"),
    },
    Explanation {
        code: ARGUMENT_KIND,
        text: "What is given is not what the argument stands for: a body for a point, say. An argument \
            `hip: point of Body` takes a point and what it belongs to, `hip: H1 of Trunk`.",
        wrong: chain!("use Link as link(hinge: N);\n"),
        right: chain!("use Link as link(hinge: O);\n"),
    },
    Explanation {
        code: INDEX,
        text: "A name with an index that was not declared: the first link of a chain has none before it. Use \
            it before the `for`, with what it hangs from. A name that is declared with indices is always \
            written with one.",
        wrong: chain!("for i in 1..3 { use Link as link[i](hinge: link[i-1].tip); }\n"),
        right: chain!(
            "use Link as link[1](hinge: O);\n",
            "for i in 2..3 { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
    },
    Explanation {
        code: COUNT,
        text: "Indices, the ends of ranges and arguments of the kind `count` are whole numbers that are known \
            when the model is read: numbers, counts (`count n = 5;`), the indices of repetitions, and what \
            `+`, `-`, `*` and `/` make of them. Parameters are not: their values come later.",
        wrong: chain!(
            "use Link as link[1](hinge: O);\n",
            "for i in 2..l { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
        right: chain!(
            "count n = 3;\n",
            "use Link as link[1](hinge: O);\n",
            "for i in 2..n { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
    },
    Explanation {
        code: REPETITION,
        text: "A mechanism has at most 10000 instances of parts and turns of repetitions, 200 imported files, \
            and 500000 words and signs when its parts are written out. Parts that use others twice double \
            with each level.",
        wrong: chain!(
            "use Link as link[0](hinge: O);\n",
            "for i in 1..1000000 { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
        right: chain!(
            "use Link as link[0](hinge: O);\n",
            "for i in 1..2 { use Link as link[i](hinge: link[i-1].tip); }\n"
        ),
    },
    Explanation {
        code: OUTER_NAME,
        text: "A part sees what it declares, what it is given, and `N`, `O`, `time` and `pi`; it does not see \
            the names of the mechanism, so that it means the same wherever it is used. Parameters and inputs \
            of the mechanism are declared in the part as `shared g: m/s^2`, other things are arguments. \
            Outside of its part a name is written with that of the instance, `leg.knee`, and not as it is \
            called in generated code, `leg_knee`.",
        wrong: chain!(
            "use Link as link(hinge: O);\n",
            "contacts { wall { point: link_tip, normal: N.x, gap: l } }\n"
        ),
        right: chain!(
            "use Link as link(hinge: O);\n",
            "contacts { wall { point: link.tip, normal: N.x, gap: dot(position(link.tip), N.x) } }\n"
        ),
    },
];
