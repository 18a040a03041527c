//! Appends the solution of systems of equations to a program: M X = -B for the columns of B, with the factor
//! of M.
//!
//! The columns are solved after all passes, each by the same operations in the same order. So a further
//! column takes no time in the passes, and emitted code may solve several columns at a time
//! (`emit/lanes.rs`).

use super::build::Builder;
use super::operation::{Operation, Value};
use super::output::{Guard, Output};
use super::straight_line::Program;

/// The layout of a system of equations. The only output of the program holds, row by row in the order of
/// elimination, `held` columns that stay as they are, the columns of B, and a square block: below the
/// diagonal the entries of L of M = L D L^T, on the diagonal -1 / D.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Solve {
    /// row of M that each step eliminates
    pub order: Vec<usize>,
    /// number of columns before those of B
    pub held: usize,
}

/// The program with the solution in place of its output.
pub fn solved(program: Program, solve: Option<&Solve>) -> Program {
    let (Some(solve), [output]) = (solve, &program.outputs[..]) else { return program };
    let rows = solve.order.len();
    let Some(count) = output.columns.checked_sub(rows + solve.held) else { return program };
    let mut builder = Builder::default();
    let mut renamed: Vec<Value> = Vec::with_capacity(program.operations.len());
    for operation in &program.operations {
        let value = builder.push(operation.map(|operand| renamed[operand.index()]));
        renamed.push(value);
    }
    let entry = |row: usize, column: usize| renamed[output.values[row * output.columns + column].index()];
    let factor = |row: usize, column: usize| entry(row, solve.held + count + column);
    let columns = solve.held + count;
    let single: Vec<Option<Single>> = (solve.held..columns)
        .map(|column| Single::of((0..rows).map(|row| builder.number(entry(row, column)))))
        .collect();
    let mut found: Vec<Vec<Value>> = Vec::with_capacity(columns);
    for column in 0..columns {
        let mut x: Vec<Value> = (0..rows).map(|row| entry(row, column)).collect();
        if column >= solve.held {
            let first = mirrors(&single, column - solve.held).len();
            for row in 0..rows {
                x[row] =
                    (0..row).fold(x[row], |sum, at| sub_product(&mut builder, sum, factor(row, at), x[at]));
            }
            for (row, value) in x.iter_mut().enumerate().skip(first) {
                *value = builder.mul(factor(row, row), *value);
            }
            for row in (first..rows).rev() {
                x[row] = (row + 1..rows)
                    .fold(x[row], |sum, at| sub_product(&mut builder, sum, factor(at, row), x[at]));
            }
        }
        found.push(x);
    }
    for column in solve.held..columns {
        let others = mirrors(&single, column - solve.held);
        for (row, (other, of)) in others.into_iter().enumerate() {
            found[column][row] = found[solve.held + other][of];
        }
    }
    let mut values = vec![Value(0); rows * columns];
    for (column, x) in found.iter().enumerate() {
        for (&row, &value) in solve.order.iter().zip(x) {
            values[row * columns + column] = value;
        }
    }
    let guards = program.guards.iter().map(|guard| Guard {
        value: renamed[guard.value.index()],
        scale: guard.scale.map(|scale| renamed[scale.index()]),
        message: guard.message.clone(),
    });
    let guards = guards.collect();
    let outputs = vec![Output { quantity: output.quantity, rows, columns, values }];
    Program { operations: builder.finish(), outputs, guards, structures: program.structures }
}

/// A right side with one nonzero entry: its row and its number.
#[derive(Clone, Copy, PartialEq)]
struct Single {
    row: usize,
    number: f64,
}

impl Single {
    /// `entries`: for each row its entry, `None` if it is not a constant.
    fn of(entries: impl Iterator<Item = Option<f64>>) -> Option<Self> {
        let mut found = None;
        for (row, entry) in entries.enumerate() {
            let number = entry?;
            if number != 0.0 && found.replace(Single { row, number }).is_some() {
                return None;
            }
        }
        found
    }
}

/// The inverse of M is symmetric: if the right sides of two columns each have a single nonzero entry with the
/// same number, an entry of one solution equals the transposed entry of the other. For the first rows of a
/// column, as long as this holds: the other column, and the row in it. Both columns are computed from the
/// last row on.
fn mirrors(single: &[Option<Single>], column: usize) -> Vec<(usize, usize)> {
    let Some(own) = single[column] else { return Vec::new() };
    let other = |row: usize| single.iter().position(|&other| other == Some(Single { row, ..own }));
    (0..own.row).map_while(|row| Some((other(row)?, own.row))).collect()
}

/// sum - factor * value, without operations if the product is 0.
fn sub_product(builder: &mut Builder, sum: Value, factor: Value, value: Value) -> Value {
    let is_zero = |value| builder.number(value) == Some(0.0);
    match (is_zero(sum), is_zero(factor) || is_zero(value)) {
        (_, true) => sum,
        (true, false) => {
            let product = builder.mul(factor, value);
            builder.neg(product)
        }
        (false, false) if [factor, value].iter().any(|&value| builder.number(value).is_some()) => {
            let product = builder.mul(factor, value);
            builder.sub(sum, product)
        }
        (false, false) => builder.push(Operation::NegMulAdd(factor, value, sum)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::derivation::Derived;
    use super::super::graph::{Graph, Input, Node};
    use super::super::ldl::factorise;
    use super::super::{Inputs, Quantity};
    use super::*;
    use crate::interpret::Evaluator;

    /// M X = -B with a matrix of four rows whose second row is coupled to the first only; `held` is a column
    /// that stays. Three columns of B are columns of the identity matrix, so that some entries of X are
    /// equal.
    #[test]
    fn the_solution_satisfies_the_equations() {
        let m = [[5.0, 1.0, 2.0, 1.0], [1.0, 4.0, 0.0, 0.0], [2.0, 0.0, 6.0, 1.0], [1.0, 0.0, 1.0, 3.0]];
        let b = [
            [1.0, 0.0, 0.5, 0.0, 1.0],
            [2.0, 0.0, 0.0, 1.0, 0.0],
            [-3.0, 1.0, 0.0, 0.0, 0.0],
            [4.0, 0.0, 0.25, 0.0, 0.0],
        ];
        let mut graph = Graph::new();
        let mut inputs = Inputs::default();
        let mut input = |graph: &mut Graph, number: f64| -> Node {
            if number == 0.0 || number == 1.0 {
                return graph.integer(number as i64);
            }
            inputs.speeds.push(number);
            graph.input(Input::Speed(inputs.speeds.len() as u32 - 1))
        };
        let mut matrix = vec![vec![graph.integer(0); 4]; 4];
        for row in 0..4 {
            for column in 0..=row {
                let entry = input(&mut graph, m[row][column]);
                (matrix[row][column], matrix[column][row]) = (entry, entry);
            }
        }
        let right: Vec<Vec<Node>> =
            b.iter().map(|row| row.iter().map(|&number| input(&mut graph, number)).collect()).collect();
        let (order, block) = factorise(&mut graph, &matrix).block(&mut graph);
        let seven = graph.integer(7);
        let rows = order.iter().zip(block);
        let values: Vec<Node> =
            rows.flat_map(|(&row, block)| [vec![seven], right[row].clone(), block].concat()).collect();
        let quantity = Quantity::AccelerationsDerivatives;
        let derived = Derived {
            graph,
            outputs: vec![Output { quantity, rows: 4, columns: 10, values }],
            guards: vec![],
            structures: vec![],
            samples: vec![],
            apart: vec![],
            solve: Some(Solve { order, held: 1 }),
        };
        let program = Program::new(&derived);
        assert_eq!((program.outputs[0].rows, program.outputs[0].columns), (4, 6));
        let found =
            Evaluator::new(&program).evaluate(&inputs, &[quantity]).expect("regular").remove(0).values;
        for (row, (of_m, of_b)) in m.iter().zip(&b).enumerate() {
            assert_eq!(found[row * 6], 7.0);
            for column in 0..5 {
                let product: f64 = (0..4).map(|at| of_m[at] * found[at * 6 + 1 + column]).sum();
                assert!((product + of_b[column]).abs() < 1e-14, "{row} {column}: {product}");
            }
        }
        // by row of M and column of X; the second row of M is eliminated first
        let entry = |row: usize, column: usize| program.outputs[0].values[row * 6 + column];
        assert_eq!((entry(1, 2), entry(1, 5)), (entry(2, 4), entry(0, 4)));
    }
}
