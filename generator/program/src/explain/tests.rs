//! Tests of the equations of a pendulum in all formats, and of their values.

use super::*;
use crate::program::graph::{Graph, Input, Node};
use crate::program::{Derived, Output};
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::Mechanism;

fn rod() -> Mechanism {
    let text = "//! A rod.\nmechanism Rod;\nparameters { /// its mass\n m: kg = 1, l: m = 1, g: m/s^2 = 9.81 }\ninputs { tau: \
                N*m }\ncoordinates { q1: rad }\nspeeds { u1: rad/s }\nframes { B = N.rotate(z, q1); }\npoints { G = O - \
                l/2*B.y; }\nbodies { R { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }\nloads { gravity: \
                -g*N.y; torque on B: tau*N.z; }\n";
    let source = hodograph_model::source::Source::file("rod.mech", text);
    let checked = hodograph_model::check::check(&source);
    checked.mechanism.unwrap_or_else(|| panic!("{:?}", checked.diagnostics))
}

/// M = [m l^2 / 3], F = [-m g l sin q1 / 2 + tau], K = (m l^2 / 6) u1^2
fn pendulum() -> (Mechanism, Program) {
    let mut graph = Graph::new();
    let [m, l, g] = [0, 1, 2].map(|index| graph.input(Input::Parameter(index)));
    let [q, u, tau] =
        [Input::Coordinate(0), Input::Speed(0), Input::Input(0)].map(|input| graph.input(input));
    let square = graph.power(l, 2);
    let third = graph.number(hodograph_model::number::Number::ratio(1, 3));
    let mass = graph.product([third, m, square]);
    let sine = graph.call(Function::Sin, vec![q]);
    let half = graph.number(hodograph_model::number::Number::ratio(-1, 2));
    let weight = graph.product([half, m, g, l, sine]);
    let force = graph.sum([weight, tau]);
    let speed = graph.power(u, 2);
    let half = graph.number(hodograph_model::number::Number::ratio(1, 2));
    let energy = graph.product([half, mass, speed]);
    let one = |quantity, node| Output { quantity, rows: 1, columns: 1, values: vec![node] };
    let outputs = vec![
        one(Quantity::CoordinateRates, u),
        one(Quantity::MassMatrix, mass),
        one(Quantity::Forcing, force),
        one(Quantity::KineticEnergy, energy),
    ];
    let derived = Derived {
        graph,
        outputs,
        guards: Vec::new(),
        structures: Vec::new(),
        samples: Vec::new(),
        apart: Vec::new(),
        solve: None,
    };
    (rod(), Program::new(&derived))
}

#[test]
fn text_names_everything() {
    let (mechanism, program) = pendulum();
    let text = explain(&mechanism, &program, &usual(&program), Format::Text);
    for part in [
        "Rod\n===",
        "m [kg] (1 in the model): its mass",
        "g [m/s²] (9.81 in the model)",
        "tau [N·m]",
        "d(q1)/dt = u1",
        "M = ",
        "F = ",
        "sin(q1)",
        "K = ",
        "1/3·m·l^2",
    ] {
        assert!(text.contains(part), "{part} not in\n{text}");
    }
    assert!(!text.contains("NaN") && !text.contains("0.333"), "{text}");
}

#[test]
fn latex_is_balanced() {
    let (mechanism, program) = pendulum();
    let latex = explain(&mechanism, &program, &usual(&program), Format::Latex);
    assert_eq!(latex.matches('{').count(), latex.matches('}').count(), "{latex}");
    for part in [
        "\\sin q_{1}",
        "\\dot{q}_{1} &= u_{1}",
        "\\tfrac{1}{3}",
        "\\item[$\\tau{}$] {[}N\\textperiodcentered{}m{]}",
    ] {
        assert!(latex.contains(part), "{part} not in\n{latex}");
    }
}

/// MathML elements that must have a fixed number of children.
const ARITIES: [(&str, usize); 6] =
    [("mfrac", 2), ("msub", 2), ("msup", 2), ("mover", 2), ("msubsup", 3), ("msqrt", 1)];

/// The content of a MathML element in a line; panics if the element is malformed.
fn line_of(node: roxmltree::Node<'_, '_>) -> String {
    let name = node.tag_name().name();
    let children: Vec<_> = node.children().filter(|child| child.is_element()).collect();
    if let Some((_, arity)) = ARITIES.iter().find(|(known, _)| *known == name) {
        assert_eq!(children.len(), *arity, "{name} in {:?}", node.range());
    }
    let factor = |child: &roxmltree::Node<'_, '_>| !child.has_tag_name("mo") && !child.has_tag_name("mspace");
    if matches!(name, "math" | "mrow" | "mtd" | "msqrt") {
        // Two factors side by side without a sign between them would be read as one name.
        for pair in children.windows(2) {
            assert!(
                !pair.iter().all(factor),
                "a bare product: {:?}",
                pair.iter().map(|node| line_of(*node)).collect::<Vec<_>>()
            );
        }
    }
    let all = || children.iter().map(|child| line_of(*child)).collect::<String>();
    match name {
        "mn" => {
            let text = node.text().unwrap_or("");
            assert!(!text.contains(['e', 'E', '-']) && text.parse::<f64>().is_ok(), "the number {text}");
            text.to_owned()
        }
        "mi" | "mo" => node.text().unwrap_or("").to_owned(),
        "mfrac" => format!("({})/({})", line_of(children[0]), line_of(children[1])),
        "msub" => format!("{}_{}", line_of(children[0]), line_of(children[1])),
        "msubsup" => format!("{}_{}^{}", line_of(children[0]), line_of(children[1]), line_of(children[2])),
        "msup" => format!("{}^{}", line_of(children[0]), line_of(children[1])),
        "mover" => format!("dot {}", line_of(children[0])),
        "msqrt" => format!("sqrt({})", all()),
        "math" | "mrow" | "mtable" | "mtr" | "mtd" => all(),
        other => panic!("MathML of browsers has no {other}"),
    }
}

/// The equations of a page, each as one line.
fn rows(html: &str) -> Vec<String> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let page = roxmltree::Document::parse_with_options(html, options)
        .unwrap_or_else(|error| panic!("{error}\n{html}"));
    page.descendants().filter(|node| node.has_tag_name("math")).for_each(|node| drop(line_of(node)));
    let rows = page.descendants().filter(|node| node.attribute("class") == Some("equation"));
    let row = |row: roxmltree::Node<'_, '_>| {
        let columns: Vec<_> = row.children().filter(|child| child.is_element()).collect();
        assert_eq!(
            columns.iter().filter_map(|node| node.attribute("class")).collect::<Vec<_>>(),
            ["left", "sign", "right"]
        );
        let maths = row.descendants().filter(|node| node.has_tag_name("math"));
        maths.map(line_of).collect::<String>()
    };
    rows.map(row).collect()
}

#[test]
fn pages_have_a_row_for_each_equation() {
    let (mechanism, program) = pendulum();
    let html = explain(&mechanism, &program, &usual(&program), Format::Html);
    let rows = rows(&html);
    let text = explain(&mechanism, &program, &usual(&program), Format::Text);
    assert_eq!(
        rows.len(),
        text.lines().filter(|line| line.starts_with("  ") && line.contains(" = ")).count(),
        "{rows:?}\n{text}"
    );
    assert!(rows.contains(&"dot q_1=u_1".to_owned()), "{rows:?}");
    assert!(rows.iter().any(|row| row.contains("(1)/(3)⋅m⋅l^2")), "{rows:?}");
    assert!(rows.iter().any(|row| row.contains("sin\u{2061}q_1")), "{rows:?}");
    for part in [
        "<html lang=\"en\">",
        "<title>Rod: equations</title>",
        "<h1>Rod</h1>",
        "<nav aria-label=\"Contents\">",
        "its mass",
        "kg",
    ] {
        assert!(html.contains(part), "{part} not in\n{html}");
    }
    for network in ["http:", "https:", "src=", "url(", "@import", "<link", "<script"] {
        assert!(!html.contains(network), "{network}");
    }
}

/// A force F on a mass K: the symbols F and K of the equations must differ from those names.
#[test]
fn quantities_do_not_look_like_names_of_the_model() {
    let source = "mechanism T; parameters { K: kg = 1, l: m = 1 } inputs { F: N*m } coordinates { q1: rad } speeds { u1: rad/s } \
                  frames { B = N.rotate(z, q1); } points { G = O - l/2*B.y; } bodies { R { frame: B, centre: G, mass: K, \
                  inertia: [K*l^2/12, 0, K*l^2/12] } } loads { torque on B: F*N.z; }";
    let checked = hodograph_model::check::check(&hodograph_model::source::Source::file("t.mech", source));
    let mechanism = checked.mechanism.unwrap_or_else(|| panic!("{:?}", checked.diagnostics));
    let mut graph = Graph::new();
    let [mass, force] = [Input::Parameter(0), Input::Input(0)].map(|input| graph.input(input));
    let one = |quantity, node| Output { quantity, rows: 1, columns: 1, values: vec![node] };
    let outputs = vec![one(Quantity::Forcing, force), one(Quantity::KineticEnergy, mass)];
    let derived = Derived {
        graph,
        outputs,
        guards: vec![],
        structures: vec![],
        samples: vec![],
        apart: vec![],
        solve: None,
    };
    let program = Program::new(&derived);
    let [text, latex, html] = [Format::Text, Format::Latex, Format::Html]
        .map(|format| explain(&mechanism, &program, &[Quantity::Forcing, Quantity::KineticEnergy], format));
    assert!(text.contains("  F' = F\n") && text.contains("  K' = K\n"), "{text}");
    assert!(latex.contains("F' &= F\n") && latex.contains("K' &= K\n"), "{latex}");
    assert_eq!(rows(&html), ["F\u{2032}=F", "K\u{2032}=K"]);
}

/// Every kind of term, in every place where it could need brackets.
#[test]
fn terms_are_bracketed_and_numbers_are_powers_of_ten() {
    let [a, b, c] = ["a", "b", "c"].map(|name| Term::Name(name.to_owned()));
    let sum = Term::Sum(vec![a.clone(), Term::Neg(Box::new(b.clone()))]);
    let small = Term::Number(2e-10);
    let cases = [
        (
            Term::Product(vec![small.clone(), a.clone()]),
            "2⋅10^\u{2212}10⋅a",
            "2·10^-10·a",
            "2 \\cdot 10^{-10} \\, a",
        ),
        (
            Term::Power(Box::new(small), 2),
            "(2⋅10^\u{2212}10)^2",
            "(2·10^-10)^2",
            "\\left(2 \\cdot 10^{-10}\\right)^{2}",
        ),
        (
            Term::Product(vec![sum.clone(), c.clone()]),
            "(a\u{2212}b)⋅c",
            "(a - b)·c",
            "\\left(a-b\\right) \\, c",
        ),
        (Term::Power(Box::new(sum.clone()), 3), "(a\u{2212}b)^3", "(a - b)^3", "\\left(a-b\\right)^{3}"),
        (
            Term::Power(Box::new(Term::Quotient(Box::new(a.clone()), Box::new(b.clone()))), 2),
            "((a)/(b))^2",
            "(a/b)^2",
            "\\left(\\frac{a}{b}\\right)^{2}",
        ),
        (
            Term::Quotient(Box::new(sum.clone()), Box::new(c.clone())),
            "(a\u{2212}b)/(c)",
            "(a - b)/c",
            "\\frac{a-b}{c}",
        ),
        (Term::Neg(Box::new(sum.clone())), "\u{2212}(a\u{2212}b)", "-(a - b)", "-\\left(a-b\\right)"),
        (
            Term::Power(Box::new(Term::Call("sin", vec![sum.clone()])), 2),
            "sin^2\u{2061}(a\u{2212}b)",
            "sin(a - b)^2",
            "\\sin^{2} \\left(a-b\\right)",
        ),
        (
            Term::Call("atan2", vec![a.clone(), c.clone()]),
            "atan2\u{2061}(a,c)",
            "atan2(a, c)",
            "\\operatorname{atan2}\\left(a, c\\right)",
        ),
        (
            Term::Sum(vec![Term::Product(vec![Term::Number(-0.5), a.clone()]), Term::Number(-1.0 / 3.0)]),
            "\u{2212}0.5⋅a\u{2212}(1)/(3)",
            "-0.5·a - 1/3",
            "-0.5 \\, a-\\tfrac{1}{3}",
        ),
        (Term::Call("sqrt", vec![sum.clone()]), "sqrt(a\u{2212}b)", "sqrt(a - b)", "\\sqrt{a-b}"),
    ];
    for (right, page, text, latex) in cases {
        let equation = Equation { left: Left::Entry("F".to_owned(), vec!["1".to_owned()]), right };
        let section = Section {
            group: String::new(),
            title: "Forcing".to_owned(),
            unit: String::new(),
            symbol: Some("F".to_owned()),
            matrix: Vec::new(),
            equations: vec![equation],
        };
        let document = Document {
            title: "T".to_owned(),
            docs: String::new(),
            symbols: symbols::Symbols::new(["a", "b", "c"].into_iter()),
            names: Vec::new(),
            sections: vec![section],
        };
        assert_eq!(rows(&html::write(&document)), [format!("F_1={page}")]);
        let plain = text::write(&document);
        assert!(plain.ends_with(&format!("  F[1] = {text}\n")), "{plain}");
        let set = latex::write(&document);
        assert!(set.contains(&format!("F_{{1}} &= {latex}\n")), "{latex} not in {set}");
    }
}

#[test]
fn corrections_of_the_rounding_of_angles_are_left_out() {
    let explained = |form: fn(&mut Graph, [Node; 4]) -> Node| {
        let mut graph = Graph::new();
        let nodes = [Input::Coordinate(0), Input::Speed(0), Input::Input(0), Input::Time]
            .map(|input| graph.input(input));
        let angle = form(&mut graph, nodes);
        let nodes = [Function::Sin, Function::Cos].map(|function| graph.call(function, vec![angle])).to_vec();
        let outputs = vec![Output { quantity: Quantity::Forcing, rows: 2, columns: 1, values: nodes }];
        let derived = Derived {
            graph,
            outputs,
            guards: vec![],
            structures: vec![],
            samples: vec![],
            apart: vec![],
            solve: None,
        };
        let text = explain(&rod(), &Program::new(&derived), &[Quantity::Forcing], Format::Text);
        let equations =
            text.lines().filter_map(|line| line.strip_prefix("  ").filter(|line| line.contains(" = ")));
        equations.collect::<Vec<_>>().join("; ")
    };
    let sines = |sum: &str| format!("F[1] = sin({sum}); F[2] = cos({sum})");
    assert_eq!(explained(|g, [q, u, ..]| g.sum([q, u])), sines("q1 + u1"));
    assert_eq!(explained(|g, [q, u, ..]| g.sub(q, u)), sines("q1 - u1"));
    let three = explained(|g, [q, u, tau, _]| {
        let first = g.sub(q, u);
        g.sub(first, tau)
    });
    assert_eq!(three, sines("q1 - u1 - tau"));
    let turned = explained(|g, [q, u, _, time]| {
        let turned = g.product([u, time]);
        g.sum([q, turned])
    });
    assert_eq!(turned, sines("q1 + u1·time"));
}
