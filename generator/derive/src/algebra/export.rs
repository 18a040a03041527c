//! Writes expressions of the algebra engine as nodes of the graph of a derivation.

use std::collections::HashMap;

use super::expr::{Expr, SymbolId, View};
use super::intermediates::{Intermediates, Meaning};
use hodograph_program::program::graph::{Graph, Node};

/// Writes expressions as nodes of a graph, each symbol once.
#[derive(Default)]
pub struct Export {
    done: HashMap<SymbolId, Node>,
}

impl Export {
    /// The node of an expression.
    pub fn node(&mut self, intermediates: &Intermediates, graph: &mut Graph, expr: &Expr) -> Node {
        match expr.view() {
            View::Number(number) => graph.number(number),
            View::Symbol(symbol) => {
                if let Some(&node) = self.done.get(&symbol) {
                    return node;
                }
                let node = match intermediates.meaning(symbol) {
                    Meaning::Input(input) => graph.input(*input),
                    Meaning::Pi => graph.pi(),
                    Meaning::Unknown => unreachable!("unknowns are defined before export"),
                    Meaning::Named(value) => self.node(intermediates, graph, value),
                    Meaning::Call(function, arguments) => {
                        let arguments =
                            arguments.iter().map(|a| self.node(intermediates, graph, a)).collect();
                        graph.call(*function, arguments)
                    }
                };
                self.done.insert(symbol, node);
                node
            }
            View::Sum(terms) => {
                let terms: Vec<_> = terms.iter().map(|t| self.node(intermediates, graph, t)).collect();
                graph.sum(terms)
            }
            View::Product(factors) => {
                let factors: Vec<_> = factors.iter().map(|f| self.node(intermediates, graph, f)).collect();
                graph.product(factors)
            }
            View::Power(base, n) => {
                let base = self.node(intermediates, graph, &base);
                graph.power(base, n)
            }
        }
    }
}
