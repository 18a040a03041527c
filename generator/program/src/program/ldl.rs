//! LDL^T factorisation and solution of symmetric positive definite systems as straight-line programs that
//! skip structural zeros.

use super::graph::{Graph, Node};

/// M = P' L D L' P, in an order P that keeps L sparse.
#[derive(Clone, Debug)]
pub struct Factor {
    /// row of M that each step eliminates
    order: Vec<usize>,
    /// rows of L below the diagonal, by step; `None`: structurally 0
    lower: Vec<Vec<Option<Node>>>,
    /// 1 / D by step
    inverse: Vec<Node>,
    /// pivots D, each with the diagonal entry of M from which it is computed and its row of M, by step
    pub pivots: Vec<(Node, Node, usize)>,
}

/// Factorises a symmetric matrix.
pub fn factorise(graph: &mut Graph, matrix: &[Vec<Node>]) -> Factor {
    let n = matrix.len();
    let order = sparse_order(graph, matrix);
    let mut lower: Vec<Vec<Option<Node>>> = vec![vec![None; n]; n];
    let mut inverse = Vec::new();
    let mut pivots = Vec::new();
    // working copy: a[i][j], j <= i, in elimination order
    let mut a: Vec<Vec<Node>> =
        (0..n).map(|i| (0..=i).map(|j| matrix[order[i]][order[j]]).collect()).collect();
    for step in 0..n {
        let pivot = a[step][step];
        pivots.push((pivot, matrix[order[step]][order[step]], order[step]));
        let reciprocal = graph.power(pivot, -1);
        inverse.push(reciprocal);
        let column: Vec<Option<Node>> =
            (step + 1..n).map(|i| Some(a[i][step]).filter(|&entry| !graph.is_zero(entry))).collect();
        for (offset, entry) in column.iter().enumerate() {
            let Some(entry) = *entry else { continue };
            let i = step + 1 + offset;
            let factor = graph.product([entry, reciprocal]);
            lower[i][step] = Some(factor);
            for (other, second) in column[..=offset].iter().enumerate() {
                let Some(second) = *second else { continue };
                let j = step + 1 + other;
                let product = graph.product([factor, second]);
                a[i][j] = graph.sub(a[i][j], product);
            }
        }
    }
    Factor { order, lower, inverse, pivots }
}

/// The order of elimination by minimum degree; among equals later rows come first (the leaves of a chain).
fn sparse_order(graph: &Graph, matrix: &[Vec<Node>]) -> Vec<usize> {
    let n = matrix.len();
    let mut coupled: Vec<Vec<bool>> =
        matrix.iter().map(|row| row.iter().map(|&entry| !graph.is_zero(entry)).collect()).collect();
    let mut left: Vec<usize> = (0..n).collect();
    let mut order = Vec::new();
    while !left.is_empty() {
        let degree = |i: usize| left.iter().filter(|&&j| j != i && coupled[i][j]).count();
        let best = left.iter().copied().min_by_key(|&i| (degree(i), n - i)).unwrap_or(0);
        left.retain(|&i| i != best);
        let neighbours: Vec<usize> = left.iter().copied().filter(|&j| coupled[best][j]).collect();
        for &i in &neighbours {
            for &j in &neighbours {
                coupled[i][j] = true;
            }
        }
        order.push(best);
    }
    order
}

impl Factor {
    /// Number of entries of L below the diagonal that are not structurally 0.
    pub fn entries(&self) -> usize {
        self.lower.iter().flatten().flatten().count()
    }

    /// L^-1 P b, in elimination order.
    pub fn half_solve(&self, graph: &mut Graph, b: &[Node]) -> Vec<Node> {
        let mut y: Vec<Node> = self.order.iter().map(|&row| b[row]).collect();
        for i in 0..y.len() {
            let mut terms = vec![y[i]];
            for (factor, &known) in self.lower[i].iter().zip(&y[..i]) {
                if let Some(factor) = factor.filter(|_| !graph.is_zero(known)) {
                    let product = graph.product([factor, known]);
                    terms.push(graph.neg(product));
                }
            }
            y[i] = graph.sum(terms);
        }
        y
    }

    /// The order of elimination, and a square block in this order: L below the diagonal, -1 / D on the
    /// diagonal.
    pub fn block(&self, graph: &mut Graph) -> (Vec<usize>, Vec<Vec<Node>>) {
        let zero = graph.integer(0);
        let n = self.order.len();
        let entry = |graph: &mut Graph, row: usize, column: usize| match row == column {
            true => graph.neg(self.inverse[row]),
            false => self.lower[row][column].unwrap_or(zero),
        };
        let rows = (0..n).map(|row| (0..n).map(|column| entry(graph, row, column)).collect()).collect();
        (self.order.clone(), rows)
    }

    /// y' D^-1 z of two half-solved vectors.
    pub fn product(&self, graph: &mut Graph, y: &[Node], z: &[Node]) -> Node {
        let terms: Vec<Node> = (0..y.len())
            .filter(|&i| !graph.is_zero(y[i]) && !graph.is_zero(z[i]))
            .collect::<Vec<_>>()
            .into_iter()
            .map(|i| {
                let scaled = graph.product([z[i], self.inverse[i]]);
                graph.product([y[i], scaled])
            })
            .collect();
        graph.sum(terms)
    }

    /// M^-1 b, from the half-solved vector.
    pub fn finish(&self, graph: &mut Graph, y: &[Node]) -> Vec<Node> {
        let n = y.len();
        let mut x: Vec<Node> = (0..n).map(|i| graph.product([y[i], self.inverse[i]])).collect();
        for i in (0..n).rev() {
            let mut terms = vec![x[i]];
            for (row, &known) in self.lower.iter().zip(&x).skip(i + 1) {
                if let Some(factor) = row[i].filter(|_| !graph.is_zero(known)) {
                    let product = graph.product([factor, known]);
                    terms.push(graph.neg(product));
                }
            }
            x[i] = graph.sum(terms);
        }
        let mut result = vec![x[0]; n];
        for (step, &row) in self.order.iter().enumerate() {
            result[row] = x[step];
        }
        result
    }
}
