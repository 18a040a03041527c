//! Equations of a pendulum, and what they mean.

use super::*;
use crate::arithmetic::Function;
use crate::model::mechanism::Mechanism;
use crate::program::graph::{Graph, Input, Node};
use crate::program::{Derived, Output};

fn rod() -> Mechanism {
    let text = "//! A rod.\nmechanism Rod;\nparameters { /// its mass\n m: kg = 1, l: m = 1, g: m/s^2 = 9.81 }\ninputs { tau: \
                N*m }\ncoordinates { q1: rad }\nspeeds { u1: rad/s }\nframes { B = N.rotate(z, q1); }\npoints { G = O - \
                l/2*B.y; }\nbodies { R { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }\nloads { gravity: \
                -g*N.y; torque on B: tau*N.z; }\n";
    let source = crate::source::Source::file("rod.mech", text);
    let checked = crate::check::check(&source);
    checked.mechanism.unwrap_or_else(|| panic!("{:?}", checked.diagnostics))
}

/// M = [m l^2 / 3], F = [-m g l sin q1 / 2 + tau], K = (m l^2 / 6) u1^2
fn pendulum() -> (Mechanism, Program) {
    let mut graph = Graph::new();
    let [m, l, g] = [0, 1, 2].map(|index| graph.input(Input::Parameter(index)));
    let [q, u, tau] =
        [Input::Coordinate(0), Input::Speed(0), Input::Input(0)].map(|input| graph.input(input));
    let square = graph.power(l, 2);
    let third = graph.number(crate::number::Number::ratio(1, 3));
    let mass = graph.product([third, m, square]);
    let sine = graph.call(Function::Sin, vec![q]);
    let half = graph.number(crate::number::Number::ratio(-1, 2));
    let weight = graph.product([half, m, g, l, sine]);
    let force = graph.sum([weight, tau]);
    let speed = graph.power(u, 2);
    let half = graph.number(crate::number::Number::ratio(1, 2));
    let energy = graph.product([half, mass, speed]);
    let one = |quantity, node| Output { quantity, rows: 1, columns: 1, values: vec![node] };
    let outputs = vec![
        one(Quantity::CoordinateRates, u),
        one(Quantity::MassMatrix, mass),
        one(Quantity::Forcing, force),
        one(Quantity::KineticEnergy, energy),
    ];
    let derived = Derived { graph, outputs, guards: Vec::new(), structures: Vec::new(), samples: Vec::new() };
    (rod(), Program::new(&derived))
}

#[test]
fn text_names_everything() {
    let (mechanism, program) = pendulum();
    let text = explain(&mechanism, &program, &usual(&program), Format::Text);
    for part in ["Rod\n===", "m [kg]: its mass", "d(q1)/dt = u1", "M = ", "F = ", "sin(q1)", "K = "] {
        assert!(text.contains(part), "{part} not in\n{text}");
    }
    assert!(!text.contains("NaN"), "{text}");
}

#[test]
fn latex_and_html_are_balanced() {
    let (mechanism, program) = pendulum();
    let latex = explain(&mechanism, &program, &usual(&program), Format::Latex);
    assert_eq!(latex.matches('{').count(), latex.matches('}').count(), "{latex}");
    assert!(latex.contains("\\sin q_{\\mathrm{1}}"), "{latex}");
    let html = explain(&mechanism, &program, &usual(&program), Format::Html);
    for tag in ["math", "mrow", "mfrac", "msub", "mi", "mn", "mo", "table", "tr", "td"] {
        let (open, close) =
            (html.matches(&format!("<{tag}>")).count(), html.matches(&format!("</{tag}>")).count());
        assert_eq!(open, close, "{tag} in\n{html}");
    }
}

#[test]
fn what_mends_the_rounding_of_angles_is_left_out() {
    let explained = |form: fn(&mut Graph, [Node; 4]) -> Node| {
        let mut graph = Graph::new();
        let nodes = [Input::Coordinate(0), Input::Speed(0), Input::Input(0), Input::Time]
            .map(|input| graph.input(input));
        let angle = form(&mut graph, nodes);
        let nodes = [Function::Sin, Function::Cos].map(|function| graph.call(function, vec![angle])).to_vec();
        let outputs = vec![Output { quantity: Quantity::Forcing, rows: 2, columns: 1, values: nodes }];
        let derived = Derived { graph, outputs, guards: vec![], structures: vec![], samples: vec![] };
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
    assert_eq!(turned, sines("u1*time + q1"));
}
