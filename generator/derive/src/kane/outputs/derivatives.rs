//! Derivatives of the dynamics with respect to coordinates, speeds and named inputs; each is written together
//! with its value as a separate derivation.
//!
//! With the inverse dynamics r(q, u, a, w) = M a - forcing, the accelerations a(q, u, w) satisfy r = 0, so
//! that da/dx = -M^-1 dr/dx, where dr/dx is taken at constant a. So only r is differentiated, with any
//! constraints, and one factorisation of M serves all columns.

use std::collections::HashMap;

use super::Writer;
use hodograph_program::program::graph::{Graph, Input, Node};
use hodograph_program::program::jacobian::{Direction, Jacobian, ORDERS, jacobian};
use hodograph_program::program::ldl::factorise;
use hodograph_program::program::passes::simplified;
use hodograph_program::program::solve::Solve;
use hodograph_program::program::{ContactQuantity, Derived, Guard, Inputs, Output, Program, Quantity};

/// Up to this work every order of elimination goes through the passes, and the one with the fewest operations
/// after them is taken.
const COMPARED: usize = 2000;
/// Solves that take more operations are no straight line any more: a dense mass matrix of 25 speeds with all
/// columns.
const LONGEST: usize = 50_000;
/// Derivatives of a contact whose elimination takes more operations in all orders are left out.
const LONGEST_OF_CONTACT: usize = 50_000;

/// What is differentiated, as nodes of a graph that is simplified already.
struct Pieces {
    graph: Graph,
    guards: Vec<Guard<Node>>,
    rates: Vec<Node>,
    inverse: Vec<Node>,
    forcing: Vec<Node>,
    matrix: Vec<Vec<Node>>,
    largest: Vec<Node>,
    directions: Vec<Direction>,
}

impl Writer<'_, '_> {
    /// Accelerations, inverse dynamics and rates of the coordinates with their derivatives.
    pub(super) fn derivatives(&mut self, samples: &[Inputs]) -> Vec<Derived> {
        let Some(pieces) = self.pieces() else { return Vec::new() };
        let derived = |graph: Graph, guards: &[Guard<Node>], quantity, rows: Vec<Vec<Node>>| {
            let columns = rows.first().map_or(0, Vec::len);
            let output = Output { quantity, rows: rows.len(), columns, values: rows.concat() };
            let (guards, samples) = (guards.to_vec(), samples.to_vec());
            Derived {
                graph,
                outputs: vec![output],
                guards,
                structures: vec![],
                samples,
                apart: vec![],
                solve: None,
            }
        };
        let mut all = Vec::new();
        if !pieces.rates.is_empty() {
            let (graph, rows) = pieces.best(&pieces.rates);
            all.push(derived(graph, &pieces.guards, Quantity::RatesDerivatives, rows));
        }
        let (graph, rows) = pieces.best(&pieces.inverse);
        let with_value = beside(&pieces.inverse, &rows);
        all.push(derived(graph.clone(), &pieces.guards, Quantity::InverseDynamicsDerivatives, with_value));
        if let Some((graph, pivots, rows, solve)) = self.accelerations_derivatives(&pieces, graph, &rows) {
            let guards = [&pieces.guards[..], &pivots].concat();
            let system = derived(graph, &guards, Quantity::AccelerationsDerivatives, rows);
            all.push(Derived { solve: Some(solve), ..system });
        }
        all.extend(self.contact_derivatives(samples));
        all
    }

    /// What a collision is made of, of every contact that has a derivative along a direction, with its
    /// derivatives.
    fn contact_derivatives(&mut self, samples: &[Inputs]) -> Vec<Derived> {
        let directions = self.directions();
        let slopes: Vec<Node> = directions.iter().flatten().map(|&(_, slope)| slope).collect();
        let mut all = Vec::new();
        for number in 0..self.k.mechanism.contacts.len() as u32 {
            let of = |quantity| {
                let quantity = Quantity::Contact(number, quantity);
                self.outputs
                    .iter()
                    .find(|output| output.quantity == quantity)
                    .map(|output| output.values.clone())
            };
            if of(ContactQuantity::Tangent).is_none() {
                continue;
            }
            let parts = [
                ContactQuantity::Velocity,
                ContactQuantity::Reduced,
                ContactQuantity::Response,
                ContactQuantity::Gap,
            ];
            let nodes = parts.map(|quantity| of(quantity).unwrap_or_default()).concat();
            let (graph, guards, [nodes, slopes]) = self.simplified_parts([nodes, slopes.clone()]);
            let mut slopes = slopes.into_iter();
            let directions = directions.iter().map(|direction| {
                direction.iter().zip(&mut slopes).map(|(&(input, _), slope)| (input, slope)).collect()
            });
            let directions: Vec<Direction> = directions.collect();
            let Some((graph, rows)) = best(&graph, &nodes, &directions, LONGEST_OF_CONTACT) else { continue };
            let rows = beside(&nodes, &rows);
            let quantity = Quantity::Contact(number, ContactQuantity::Derivatives);
            let columns = 1 + directions.len();
            let output = Output { quantity, rows: rows.len(), columns, values: rows.concat() };
            all.push(Derived {
                graph,
                outputs: vec![output],
                guards,
                structures: vec![],
                samples: samples.to_vec(),
                apart: vec![],
                solve: None,
            });
        }
        all
    }

    /// Lists of nodes after the passes on the graph, which they go through together.
    fn simplified_parts<const N: usize>(
        &self,
        parts: [Vec<Node>; N],
    ) -> (Graph, Vec<Guard<Node>>, [Vec<Node>; N]) {
        // The name does not matter: it is never a program.
        let output = |values: Vec<Node>| Output {
            quantity: Quantity::Forcing,
            rows: values.len(),
            columns: 1,
            values,
        };
        let derived = simplified(&Derived {
            graph: self.graph.clone(),
            outputs: parts.map(output).to_vec(),
            guards: self.guards.clone(),
            structures: Vec::new(),
            samples: Vec::new(),
            apart: Vec::new(),
            solve: None,
        });
        let mut parts = derived.outputs.into_iter().map(|output| output.values);
        (derived.graph, derived.guards, std::array::from_fn(|_| parts.next().unwrap_or_default()))
    }

    /// Everything that is needed, sent through the passes on the graph together; `None` where a mechanism has
    /// no dynamics.
    fn pieces(&mut self) -> Option<Pieces> {
        let directions = self.directions();
        let of = |quantity| self.outputs.iter().find(|output| output.quantity == quantity);
        let rates = of(Quantity::CoordinateRates)?.values.iter().zip(&self.k.mechanism.coordinates);
        let rates = rates.filter(|(_, coordinate)| !coordinate.dependent).map(|(&node, _)| node).collect();
        let slopes = directions.iter().flatten().map(|&(_, slope)| slope).collect();
        let parts: [Vec<Node>; 6] = [
            rates,
            of(Quantity::InverseDynamics)?.values.clone(),
            of(Quantity::Forcing)?.values.clone(),
            of(Quantity::MassMatrix)?.values.clone(),
            self.largest.clone(),
            slopes,
        ];
        let (graph, guards, [rates, inverse, forcing, matrix, largest, slopes]) =
            self.simplified_parts(parts);
        let mut slopes = slopes.into_iter();
        let renamed = |direction: Direction| {
            direction.into_iter().zip(&mut slopes).map(|((input, _), slope)| (input, slope)).collect()
        };
        Some(Pieces {
            graph,
            guards,
            rates,
            matrix: matrix.chunks(inverse.len()).map(<[Node]>::to_vec).collect(),
            inverse,
            forcing,
            largest,
            directions: directions.into_iter().map(renamed).collect(),
        })
    }

    /// Independent coordinates, followed by the dependent ones; independent speeds; named inputs.
    fn directions(&mut self) -> Vec<Direction> {
        let one = self.graph.integer(1);
        let mechanism = self.k.mechanism;
        let coordinates = (0..).map(Input::Coordinate).zip(&mechanism.coordinates);
        let coordinates = coordinates.filter(|(_, coordinate)| !coordinate.dependent).map(|(input, _)| input);
        let speeds = (0..self.independent.len() as u32).map(Input::Speed);
        let inputs = (0..mechanism.inputs.len() as u32).map(Input::Input);
        let along = |leader: Input| {
            let slope = |(follower, leaders): &(Input, Vec<(Input, Node)>)| {
                leaders.iter().find(|(input, _)| *input == leader).map(|&(_, slope)| (*follower, slope))
            };
            let followers = self.followers.iter().filter_map(slope);
            std::iter::once((leader, one)).chain(followers).collect()
        };
        coordinates.chain(speeds).chain(inputs).map(along).collect()
    }

    /// u' and the systems of equations of its derivatives, from the derivatives of the inverse dynamics for
    /// given u'; with what must not vanish. `None` where that is too long for a straight line.
    #[allow(clippy::type_complexity)]
    fn accelerations_derivatives(
        &self,
        pieces: &Pieces,
        mut graph: Graph,
        rows: &[Vec<Node>],
    ) -> Option<(Graph, Vec<Guard<Node>>, Vec<Vec<Node>>, Solve)> {
        let factor = factorise(&mut graph, &pieces.matrix);
        let each = 2 * factor.entries() + rows.len();
        if each * pieces.directions.len() > LONGEST {
            return None;
        }
        let pivots = self.pivots(&graph, &factor, &pieces.largest);
        let half = factor.half_solve(&mut graph, &pieces.forcing);
        let accelerations = factor.finish(&mut graph, &half);
        let held = (0..).map(Input::Acceleration).zip(accelerations.iter().copied());
        let entries = graph.replaced(&rows.concat(), &held.collect::<HashMap<Input, Node>>());
        let (order, block) = factor.block(&mut graph);
        let count = pieces.directions.len();
        let system = order.iter().zip(block).map(|(&row, block)| {
            let columns = &entries[row * count..(row + 1) * count];
            std::iter::once(accelerations[row]).chain(columns.iter().copied()).chain(block).collect()
        });
        let system = system.collect();
        Some((graph, pivots, system, Solve { order, held: 1 }))
    }
}

impl Pieces {
    /// The Jacobian of some nodes, in its graph, by the best of the orders of elimination.
    fn best(&self, nodes: &[Node]) -> (Graph, Vec<Vec<Node>>) {
        best(&self.graph, nodes, &self.directions, usize::MAX).unwrap_or_default()
    }
}

/// The Jacobian of some nodes, in a graph that has it, by the best of the orders of elimination; `None` where
/// it takes more work than `most`.
fn best(
    graph: &Graph,
    nodes: &[Node],
    directions: &[Direction],
    most: usize,
) -> Option<(Graph, Vec<Vec<Node>>)> {
    let found = ORDERS.map(|order| {
        let mut graph = graph.clone();
        let found = jacobian(&mut graph, nodes, directions, order);
        (graph, found)
    });
    let compare = found.iter().all(|(_, found)| found.work <= COMPARED);
    let cost = |(graph, found): &(Graph, Jacobian)| if compare { cost(graph, found) } else { found.work };
    let best = found.into_iter().min_by_key(cost).filter(|(_, found)| found.work <= most);
    best.map(|(graph, found)| (graph, found.rows))
}

/// Operations per evaluation of a Jacobian after all passes; fused ones count once.
fn cost(graph: &Graph, found: &Jacobian) -> usize {
    let values = found.rows.concat();
    let output = Output { quantity: Quantity::Forcing, rows: values.len(), columns: 1, values };
    let program = Program::new(&Derived {
        graph: graph.clone(),
        outputs: vec![output],
        guards: Vec::new(),
        structures: Vec::new(),
        samples: Vec::new(),
        apart: Vec::new(),
        solve: None,
    });
    let count = program.cost(&[Quantity::Forcing]).evaluation();
    count.total() - count.fused
}

/// A column and the matrix that follows it.
fn beside(column: &[Node], rows: &[Vec<Node>]) -> Vec<Vec<Node>> {
    column
        .iter()
        .zip(rows)
        .map(|(&first, row)| std::iter::once(first).chain(row.iter().copied()).collect())
        .collect()
}
