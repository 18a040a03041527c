//! What a function of CasADi takes and gives: names, shapes, sparsity.

use std::ffi::{CStr, CString};

use crate::Int;

/// An input or an output: a matrix in columns.
#[derive(Clone, Debug)]
pub struct Block {
    name: CString,
    /// how many numbers it has
    pub size: usize,
    /// CasADi's compressed form: rows, columns, then 1 for a dense matrix, or the starts of all columns for
    /// one without entries
    sparsity: Vec<Int>,
}

impl Block {
    /// A dense matrix.
    pub fn dense(name: &str, rows: usize, columns: usize) -> Self {
        Block {
            // no name has a zero byte
            name: CString::new(name).unwrap_or_default(),
            size: rows * columns,
            sparsity: vec![rows as Int, columns as Int, 1],
        }
    }

    /// A matrix of zeros, which has no numbers: Jacobians of CasADi receive results of the function in such
    /// places and need not read them.
    pub fn absent(name: &str, rows: usize) -> Self {
        Block { size: 0, sparsity: vec![rows as Int, 1, 0, 0], ..Block::dense(name, 0, 0) }
    }

    /// Its name.
    pub fn name(&self) -> &CStr {
        &self.name
    }

    /// Its sparsity in CasADi's compressed form.
    pub fn sparsity(&self) -> &[Int] {
        &self.sparsity
    }
}

/// All inputs and outputs of a function, or why it cannot be offered.
#[derive(Clone, Debug)]
pub struct Layout {
    /// in the order of the arguments
    pub inputs: Vec<Block>,
    /// in the order of the results
    pub outputs: Vec<Block>,
    /// why CasADi cannot have the function
    pub refused: Option<String>,
}

impl Layout {
    /// A function of dense vectors: names and sizes.
    pub fn of_vectors(inputs: &[(&str, usize)], outputs: &[(&str, usize)]) -> Self {
        let blocks =
            |list: &[(&str, usize)]| list.iter().map(|&(name, size)| Block::dense(name, size, 1)).collect();
        Layout { inputs: blocks(inputs), outputs: blocks(outputs), refused: None }
    }

    /// Its Jacobian, as CasADi asks for it: results of the function follow its inputs, and there is a block
    /// for each result (slow) and input (fast).
    pub fn jacobian(&self) -> Self {
        let text = |block: &Block| block.name.to_string_lossy().into_owned();
        let results =
            self.outputs.iter().map(|block| Block::absent(&format!("out_{}", text(block)), block.size));
        let blocks = self.outputs.iter().flat_map(|output| {
            self.inputs.iter().map(move |input| {
                Block::dense(&format!("jac_{}_{}", text(output), text(input)), output.size, input.size)
            })
        });
        Layout {
            inputs: self.inputs.iter().cloned().chain(results).collect(),
            outputs: blocks.collect(),
            refused: self.refused.clone(),
        }
    }

    /// How many numbers all inputs have, and all outputs.
    pub fn sizes(&self) -> (usize, usize) {
        let sum = |blocks: &[Block]| blocks.iter().map(|block| block.size).sum();
        (sum(&self.inputs), sum(&self.outputs))
    }
}
