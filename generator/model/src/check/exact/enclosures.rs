//! Configuration equations that no coordinates satisfy, with the values of the model: bounds of their residuals
//! over all coordinates and all times, by interval arithmetic, do not hold 0.
//!
//! What is found so is certain: `y^2 = -l^2`, or a link too short for what it joins. Bounds of sums of terms that
//! depend on each other are wider than need be, so not all that has no solution is found.

use super::nodes::Nodes;
use crate::arithmetic::Function;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::{Graph, Input, Node, NodeKind};
use crate::model::mechanism::Mechanism;

/// Bounds within which 0 may be missed for rounding, beside the greater bound.
const ROUNDING: f64 = 1e-9;

/// Least and greatest value.
type Bounds = [f64; 2];
const ANY: Bounds = [f64::NEG_INFINITY, f64::INFINITY];

/// The first configuration equation that has no solution whatever the coordinates are.
pub fn unsolvable(m: &Mechanism) -> Option<Diagnostic> {
    for equation in &m.configuration {
        let mut nodes = Nodes::new(m);
        let Some(residuals) = nodes.residual(equation) else { continue };
        let bounds = all_bounds(&nodes.graph, m);
        let misses = |node: &Node| {
            let [low, high] = bounds[node.0 as usize];
            let least = if low > 0.0 { low } else { -high };
            let finite = [low, high].into_iter().filter(|bound| bound.is_finite());
            least > 0.0 && least > ROUNDING * finite.fold(0.0_f64, |size, bound| size.max(bound.abs()))
        };
        if !residuals.iter().any(misses) {
            continue;
        }
        let message = "no values of the coordinates satisfy this equation, with the parameters of the model";
        let help = "check signs and lengths: something is asked to be longer than it can be, or a square to be negative";
        return Some(Diagnostic::new(codes::NO_CONFIGURATION, equation.span, message).help(help));
    }
    None
}

fn all_bounds(graph: &Graph, m: &Mechanism) -> Vec<Bounds> {
    let mut all: Vec<Bounds> = Vec::with_capacity(graph.kinds().len());
    for kind in graph.kinds() {
        let of = |node: &Node| all[node.0 as usize];
        let bounds = match kind {
            NodeKind::Number(number) => [number.to_f64(); 2],
            NodeKind::Pi => [std::f64::consts::PI; 2],
            NodeKind::Input(Input::Parameter(i)) => {
                m.parameters.get(*i as usize).and_then(|parameter| parameter.value).map_or(ANY, |v| [v; 2])
            }
            NodeKind::Input(_) => ANY,
            NodeKind::Sum(terms) => {
                terms.iter().map(of).fold([0.0; 2], |[a, b], [low, high]| [a + low, b + high])
            }
            NodeKind::Product(factors) => factors.iter().map(of).fold([1.0; 2], product),
            NodeKind::Power(base, exponent) => power(of(base), *exponent),
            NodeKind::Call(function, arguments) => match arguments.first() {
                Some(argument) => call(*function, of(argument)),
                None => ANY,
            },
        };
        all.push(if bounds.iter().any(|bound| bound.is_nan()) { ANY } else { bounds });
    }
    all
}

fn product([a, b]: Bounds, [c, d]: Bounds) -> Bounds {
    // 0 times a value without bound is 0: no value is infinite.
    let times = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    let ends = [times(a, c), times(a, d), times(b, c), times(b, d)];
    [ends.into_iter().fold(f64::INFINITY, f64::min), ends.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

fn power([low, high]: Bounds, exponent: i32) -> Bounds {
    if exponent < 0 {
        // What divides is not 0, but may be near it.
        return match power([low, high], exponent.saturating_neg()) {
            [a, b] if a > 0.0 => [1.0 / b, 1.0 / a],
            [0.0, _] => [0.0, f64::INFINITY],
            _ => ANY,
        };
    }
    let ends = [low.powi(exponent), high.powi(exponent)];
    if exponent % 2 == 1 {
        return ends;
    }
    let greatest = ends[0].max(ends[1]);
    if low <= 0.0 && high >= 0.0 { [0.0, greatest] } else { [ends[0].min(ends[1]), greatest] }
}

fn call(function: Function, [low, high]: Bounds) -> Bounds {
    use Function::*;
    match function {
        Sin | Cos | Tanh => [-1.0, 1.0],
        Sqrt if high < 0.0 => ANY,
        Sqrt => [low.max(0.0).sqrt(), high.sqrt()],
        Exp => [low.exp(), high.exp()],
        Abs if low >= 0.0 => [low, high],
        Abs if high <= 0.0 => [-high, -low],
        Abs => [0.0, high.max(-low)],
        Sign => [-1.0, 1.0],
        Frozen => [low, high],
        Cosh => [1.0, f64::INFINITY],
        Asin | Atan => [-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2],
        Acos => [0.0, std::f64::consts::PI],
        Atan2 => [-std::f64::consts::PI, std::f64::consts::PI],
        Tan | Log | Sinh | Min | Max => ANY,
    }
}
