//! Every example of `docs/language.md` is a correct model, and every construct has an example.

use std::path::Path;

use hodograph_generator::artifact::model_hash;
use hodograph_generator::diagnostics::codes;
use hodograph_generator::expand::Inline;
use hodograph_generator::explanations::within;
use hodograph_generator::rendering::render;
use hodograph_generator::{check::check, source::Source};

/// An example and the sections that complete it, which stand in a comment above it.
struct Example {
    line: usize,
    context: String,
    text: String,
}

fn examples() -> Vec<Example> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    let page = std::fs::read_to_string(path).expect("docs/language.md");
    let mut examples = Vec::new();
    let (mut context, mut text): (Option<String>, Option<String>) = (None, None);
    let mut last_context = String::new();
    for (number, line) in page.lines().enumerate() {
        match (line, context.as_mut(), text.as_mut()) {
            ("<!-- context", ..) => context = Some("mechanism Example;\n".to_owned()),
            ("-->", Some(_), _) => last_context = context.take().unwrap_or_default(),
            (_, Some(context), _) => *context = format!("{context}{line}\n"),
            ("```text", ..) => text = Some(String::new()),
            ("```", _, Some(_)) => examples.push(Example {
                line: number + 1,
                context: std::mem::take(&mut last_context),
                text: text.take().unwrap_or_default(),
            }),
            (_, _, Some(text)) => *text = format!("{text}{line}\n"),
            _ => {}
        }
    }
    examples
}

#[test]
fn examples_are_correct_models() {
    let mut wrong = String::new();
    for example in examples() {
        let source = Source::file(format!("line {}", example.line), within(&example.context, &example.text));
        let mut found = check(&source).diagnostics;
        // not every example is for simulation
        found.retain(|d| d.code != codes::NO_GAP);
        if !found.is_empty() {
            wrong.push_str(&render(&found, &source));
        }
        // the same model as the input of a macro
        let stream = source.text().unwrap_or_default().parse().expect("Rust tokens");
        let inline = Inline::new("here", stream).source;
        assert_eq!(model_hash(&inline), model_hash(&source), "line {}", example.line);
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_construct_has_an_example() {
    let all: String = examples().into_iter().map(|example| example.text).collect();
    let constructs = [
        "mechanism ",
        "//!",
        "///",
        "parameters {",
        "inputs      {",
        "coordinates {",
        "speeds {",
        "dependent   {",
        "definitions {",
        "frames {",
        "angular_velocities {",
        "points {",
        "velocities {",
        "bodies {",
        "particles {",
        "loads {",
        "kinematics {",
        "constraints {",
        "configuration {",
        "contacts {",
        "shapes {",
        "shape: Hull",
        " on Floor",
        "sphere:",
        "capsule:",
        "cylinder:",
        "cone:",
        "disc:",
        "torus:",
        "ellipsoid:",
        "box:",
        "polytope:",
        "rectangle:",
        "plane:",
        "half_space:",
        "surface: h*",
        "curve:",
        "implicit:",
        "density:",
        "colour:",
        "axis:",
        "axes:",
        "at:",
        "of:",
        "fixed ",
        "dependent q4",
        "= N;",
        ".rotate(z,",
        ".rotate(x,",
        ".rotate(-y,",
        ".rotate(-x,",
        ".rotate([",
        ".euler(",
        ".space(",
        ".quaternion(",
        ".spin(",
        " in Abar =",
        " of R = ",
        ": velocity ",
        "frame:",
        "centre:",
        "mass:",
        "inertia:",
        " in L",
        " about H",
        " in L about C0",
        "point:",
        "gravity:",
        "force on P:",
        "force on P from Q:",
        "torque on B:",
        "torque on B from A:",
        "spring P to H:",
        "stiffness:",
        "length:",
        "damping:",
        "torsion B from A about A.y:",
        "angle:",
        "rest:",
        "d(q3)/dt",
        "against: Ac of SledA",
        "against: SledA",
        "against: velocity ",
        "against: T,",
        "against: T about H",
        "normal:",
        "gap:",
        "touching(floor, 60)",
        "= l*sin(pi/6) - r",
        "surface: {",
        "mu:",
        " e:",
        "law: stronge",
        ".vec(",
        "dot(",
        "cross(",
        "norm(",
        "unit(",
        "position(",
        "velocity(P, Q)",
        "angular_velocity(A, N)",
        "sin(",
        "cos(",
        "tan(",
        "asin(",
        "acos(",
        "atan(",
        "atan2(",
        "sqrt(",
        "exp(",
        "log(",
        "sinh(",
        "cosh(",
        "tanh(",
        "abs(",
        "sign(",
        "min(",
        "max(",
        "pow(",
        "pi",
        "time",
        "^",
        ": mm ",
        "g/cm^3",
        "kPa",
        "N/mm",
        "kJ",
        ": W ",
        ": Hz ",
        "rev/min",
        ": deg ",
        ": 1 ",
        ": ms ",
        ": min ",
        ": h ",
    ];
    let missing: Vec<&str> = constructs.into_iter().filter(|c| !all.contains(c)).collect();
    assert!(missing.is_empty(), "no example shows {missing:?}");
}
