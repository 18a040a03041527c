//! Decides by exact arithmetic whether the rate of each configuration equation follows from the velocity
//! constraints and the kinematical equations.
//!
//! The configuration equations are closed symbolically: each is solved for a quantity in which it is linear,
//! a coordinate or, where parameters are free, a parameter (the lengths of a linkage). What is left are
//! functions of arbitrary arguments, which are evaluated modulo primes ([`crate::graph::modular`]).
//! There a rate follows if its row of coefficients lies in the span of the rows of the motion. Sizes do not
//! matter: a factor that is wrong by one part in 10^30 is as visible as a wrong sign.
//!
//! Theory: docs/theory.md, section 16.6.

pub mod constants;
pub mod divisors;
pub mod enclosures;
pub mod nodes;
mod values;

use std::collections::HashMap;

use crate::arithmetic::Function;
use crate::graph::differentiate::differentiate;
use crate::graph::modular::Residues;
use crate::graph::{Graph, Input, Node, NodeKind};
use crate::model::mechanism::Mechanism;
use crate::number::Number;
use crate::numeric::State;
use nodes::Nodes;
use num_rational::BigRational;
use values::{substituted, value};

/// A coefficient by which a quantity is solved for may not be less than this part of what it is at open
/// loops: it vanishes then where loops are closed.
const PIVOT: f64 = 1e-6;
/// Equations of more components are not solved.
const MOST: usize = 60;

/// Whether parameters have the values of the model, or are arbitrary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameters {
    /// arbitrary
    Free,
    /// those of the model
    Values,
}

/// For each configuration equation whether the motion keeps it; `None` where exact arithmetic does not tell.
/// `closed` is a state at which the loops are closed, `open` one at which they are not.
pub fn kept(m: &Mechanism, parameters: Parameters, closed: &State, open: &State) -> Vec<Option<bool>> {
    let none = || vec![None; m.configuration.len()];
    decide(m, parameters, [closed, open]).unwrap_or_else(none)
}

fn decide(m: &Mechanism, parameters: Parameters, at: [&State; 2]) -> Option<Vec<Option<bool>>> {
    let mut nodes = Nodes::new(m);
    let mut configuration = Vec::new();
    let mut owners = Vec::new();
    for (i, equation) in m.configuration.iter().enumerate() {
        let residual = nodes.residual(equation)?;
        owners.extend(residual.iter().map(|_| i));
        configuration.extend(residual);
    }
    let motion = nodes.motion()?;
    let (mut graph, ones) = (nodes.graph, nodes.ones);
    let unknowns = Unknowns::of(m);
    if configuration.len() > MOST || motion.len() > 20 * MOST {
        return None;
    }
    let rows = unknowns.rows(&mut graph, &motion);
    let rates = unknowns.rates(&mut graph, m, &configuration);
    let width = unknowns.all.len() + 1;
    // all that is evaluated: conditions, rows of the motion, rows of the rates
    let mut wanted: Vec<Node> = ones.clone();
    wanted.extend(rows.iter().chain(&rates).flatten());
    let mut close = Closing { m, graph, configuration, wanted, parameters, at };
    if parameters == Parameters::Values {
        close.set_values()?;
    }
    close.close()?;
    let Closing { graph, wanted, .. } = close;
    let certain = !hides_identities(&graph, &wanted);
    let residues = graph.residues();
    let found: Option<Vec<Residues>> = wanted.iter().map(|node| residues[node.0 as usize]).collect();
    let found = found?;
    let (lengths, found) = found.split_at(ones.len());
    if lengths.iter().any(|length| length.multiple_of(1, 1) != Some(1)) {
        return None;
    }
    let mut found = found.chunks(width).map(<[Residues]>::to_vec);
    let motion = reduced(found.by_ref().take(rows.len()).collect(), unknowns.dependent)?;
    let mut kept = vec![Some(true); m.configuration.len()];
    for (owner, rate) in owners.into_iter().zip(found) {
        if !follows(&motion, rate) {
            kept[owner] = certain.then_some(false);
        }
    }
    Some(kept)
}

/// Rates of coordinates and dependent speeds, which the motion determines, then independent speeds.
struct Unknowns {
    all: Vec<Input>,
    /// how many the motion determines
    dependent: usize,
}

impl Unknowns {
    fn of(m: &Mechanism) -> Self {
        let speed = |i: usize| Input::Speed(i as u32);
        let (dependent, independent): (Vec<usize>, Vec<usize>) =
            (0..m.speeds.len()).partition(|&i| m.speeds[i].dependent);
        let mut all: Vec<Input> = (0..m.coordinates.len()).map(|i| Input::Tangent(i as u32)).collect();
        all.extend(dependent.into_iter().map(speed));
        let determined = all.len();
        all.extend(independent.into_iter().map(speed));
        Unknowns { all, dependent: determined }
    }

    /// Coefficients of residuals that are linear in the unknowns, the constant last.
    fn rows(&self, graph: &mut Graph, residuals: &[Node]) -> Vec<Vec<Node>> {
        let (zero, one) = (graph.integer(0), graph.integer(1));
        let mut rows = vec![Vec::new(); residuals.len()];
        for &unknown in &self.all {
            let slopes = differentiate(graph, residuals, &HashMap::from([(unknown, one)]));
            rows.iter_mut().zip(slopes).for_each(|(row, slope)| row.push(slope));
        }
        let constants =
            self.all.iter().fold(residuals.to_vec(), |left, &input| substituted(graph, &left, input, zero));
        rows.iter_mut().zip(constants).for_each(|(row, constant)| row.push(constant));
        rows
    }

    /// The rates of configuration equations, in the same form.
    fn rates(&self, graph: &mut Graph, m: &Mechanism, configuration: &[Node]) -> Vec<Vec<Node>> {
        let (zero, one) = (graph.integer(0), graph.integer(1));
        let mut rows = vec![Vec::new(); configuration.len()];
        for i in 0..m.coordinates.len() as u32 {
            let slopes = differentiate(graph, configuration, &HashMap::from([(Input::Coordinate(i), one)]));
            rows.iter_mut().zip(slopes).for_each(|(row, slope)| row.push(slope));
        }
        let in_time = differentiate(graph, configuration, &HashMap::from([(Input::Time, one)]));
        for (row, slope) in rows.iter_mut().zip(in_time) {
            row.resize(self.all.len(), zero);
            row.push(slope);
        }
        rows
    }
}

/// The configuration equations, while they are solved, and what is evaluated where they hold.
struct Closing<'m> {
    m: &'m Mechanism,
    graph: Graph,
    configuration: Vec<Node>,
    wanted: Vec<Node>,
    parameters: Parameters,
    /// a closed state and an open one
    at: [&'m State; 2],
}

impl Closing<'_> {
    /// Gives parameters their values, as the shortest decimals that are the doubles.
    fn set_values(&mut self) -> Option<()> {
        for (i, parameter) in self.m.parameters.iter().enumerate() {
            if let Some(value) = parameter.value.filter(|_| !parameter.fixed) {
                let number = self.graph.number(decimal(value)?);
                self.replace(Input::Parameter(i as u32), number);
            }
        }
        Some(())
    }

    /// Solves the configuration equations; `None` where one is not linear in anything.
    fn close(&mut self) -> Option<()> {
        for at in 0..self.configuration.len() {
            let residual = self.configuration[at];
            if self.vanishes(&[residual])?[0] {
                continue;
            }
            let (input, solution) = self.candidates().into_iter().find_map(|q| self.solve(residual, q))?;
            self.replace(input, solution);
        }
        Some(())
    }

    fn replace(&mut self, input: Input, by: Node) {
        let all: Vec<Node> = self.configuration.iter().chain(&self.wanted).copied().collect();
        let mut all = substituted(&mut self.graph, &all, input, by);
        self.wanted = all.split_off(self.configuration.len());
        self.configuration = all;
    }

    /// Quantities to solve for: dependent coordinates, others, and parameters where these are free.
    fn candidates(&self) -> Vec<Input> {
        let coordinates = |dependent: bool| {
            let all = self.m.coordinates.iter().enumerate();
            all.filter(move |(_, q)| q.dependent == dependent).map(|(i, _)| Input::Coordinate(i as u32))
        };
        let is_free = |value: Option<f64>| self.parameters == Parameters::Free || value.is_none();
        let parameters = self.m.parameters.iter().enumerate();
        let parameters = parameters.filter(|(_, p)| !p.fixed && is_free(p.value));
        let parameters = parameters.map(|(i, _)| Input::Parameter(i as u32));
        coordinates(true).chain(coordinates(false)).chain(parameters).collect()
    }

    /// Solves an equation for a quantity in which it is linear.
    fn solve(&mut self, residual: Node, input: Input) -> Option<(Input, Node)> {
        let (zero, one) = (self.graph.integer(0), self.graph.integer(1));
        let along = HashMap::from([(input, one)]);
        let slope = differentiate(&mut self.graph, &[residual], &along)[0];
        if self.graph.is_zero(slope) {
            return None;
        }
        let bend = differentiate(&mut self.graph, &[slope], &along)[0];
        let vanish = self.vanishes(&[slope, bend])?;
        if vanish[0] || !vanish[1] || !self.is_pivot(slope) {
            return None;
        }
        // linear: neither the slope nor what is left depends on it
        let nodes = substituted(&mut self.graph, &[slope, residual], input, zero);
        if self.graph.is_zero(nodes[0]) {
            return None;
        }
        let (minus, divisor) = (self.graph.integer(-1), self.graph.power(nodes[0], -1));
        let solution = nodes::times(&mut self.graph, nodes[1], divisor);
        Some((input, nodes::times(&mut self.graph, minus, solution)))
    }

    /// Whether a coefficient vanishes neither everywhere nor where the loops are closed.
    fn is_pivot(&self, slope: Node) -> bool {
        let at = |state: &State| {
            let list = |list: &[f64], i: u32| list.get(i as usize).copied().unwrap_or(0.0);
            let inputs = |input: Input| match input {
                Input::Parameter(i) => list(&state.parameters, i),
                Input::Time => state.time,
                Input::Coordinate(i) => list(&state.coordinates, i),
                Input::Input(i) => list(&state.inputs, i),
                _ => 0.0,
            };
            value(&self.graph, slope, &inputs).abs()
        };
        let [closed, open] = self.at.map(at);
        closed.is_finite() && open.is_finite() && closed > PIVOT * open
    }

    /// Which nodes are identically 0; `None` where residues do not tell.
    fn vanishes(&self, nodes: &[Node]) -> Option<Vec<bool>> {
        let residues = self.graph.residues();
        nodes.iter().map(|node| residues[node.0 as usize].map(Residues::is_zero)).collect()
    }
}

/// The shortest decimal that is read as this double.
fn decimal(value: f64) -> Option<Number> {
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e')?;
    let places = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let whole = BigRational::from_integer(digits.replace('.', "").parse().ok()?);
    let exponent = exponent.parse::<i32>().ok()? - i32::try_from(places).ok()?;
    let power = num_traits::pow(BigRational::from_integer(10.into()), exponent.unsigned_abs() as usize);
    Some(Number(if exponent < 0 { whole / power } else { whole * power }))
}

/// Whether nodes have parts that count as unknowns modulo primes although they obey identities: functions
/// with branches, and functions of multiples of pi.
fn hides_identities(graph: &Graph, nodes: &[Node]) -> bool {
    use Function::*;
    let needed = graph.reachable(nodes.iter().copied());
    let (mut has_pi, mut has_input) = (vec![false; needed.len()], vec![false; needed.len()]);
    for (index, kind) in graph.kinds().iter().enumerate() {
        let any = |list: &[bool]| kind.operands().iter().any(|operand| list[operand.0 as usize]);
        (has_pi[index], has_input[index]) =
            (*kind == NodeKind::Pi || any(&has_pi), matches!(kind, NodeKind::Input(_)) || any(&has_input));
    }
    let is_angle = |node: &Node| has_pi[node.0 as usize] && !has_input[node.0 as usize];
    let hides = |argument: &Node| match graph.kind(*argument) {
        NodeKind::Sum(terms) => terms.iter().any(is_angle),
        _ => is_angle(argument),
    };
    graph.kinds().iter().enumerate().filter(|(index, _)| needed[*index]).any(|(_, kind)| match kind {
        NodeKind::Call(Sin | Cos | Tan | Exp | Sinh | Cosh | Tanh, arguments) => arguments.iter().any(hides),
        NodeKind::Call(..) => true,
        _ => false,
    })
}

/// A row for each of the first `determined` columns, with 1 there and 0 in the others of these columns.
/// `None` where the rows determine more or less than these.
fn reduced(mut rows: Vec<Vec<Residues>>, determined: usize) -> Option<Vec<Vec<Residues>>> {
    let mut done: Vec<Vec<Residues>> = Vec::new();
    for column in 0..determined {
        let at = rows.iter().position(|row| !row[column].is_zero())?;
        let mut row = rows.swap_remove(at);
        let scale = row[column].reciprocal()?;
        row.iter_mut().for_each(|entry| *entry = entry.times(scale));
        for other in rows.iter_mut().chain(&mut done) {
            eliminate(other, &row, column);
        }
        done.push(row);
    }
    // what is left would bind the independent speeds
    rows.iter().flatten().all(|entry| entry.is_zero()).then_some(done)
}

fn eliminate(row: &mut [Residues], by: &[Residues], column: usize) {
    let factor = row[column].opposite();
    if !factor.is_zero() {
        row.iter_mut().zip(by).for_each(|(entry, other)| *entry = entry.plus(factor.times(*other)));
    }
}

/// Whether a row is a combination of reduced rows.
fn follows(rows: &[Vec<Residues>], mut row: Vec<Residues>) -> bool {
    rows.iter().enumerate().for_each(|(column, by)| eliminate(&mut row, by, column));
    row.iter().all(|entry| entry.is_zero())
}
