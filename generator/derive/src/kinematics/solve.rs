//! Solves linear systems of equations symbolically: for the rates of coordinates, and for dependent speeds.
//!
//! Equations and unknowns are matched and split into the smallest blocks that can be solved one after
//! another. Each block is solved by its adjugate, so that the only divisor is its determinant, which is zero
//! only where the block is singular.

use std::collections::BTreeMap;

use super::equations::vanishes;
use super::linear_forms::LinearScalar;
use crate::algebra::{Expr, Intermediates, Sample};
use hodograph_model::check::coupled::{LARGEST_BLOCK, blocks, matching};

/// A block of equations that is solved at once.
#[derive(Clone, Debug)]
struct Block {
    unknowns: Vec<usize>,
    equations: Vec<usize>,
    inverse: Vec<Vec<Expr>>,
}

/// Equations solved for unknowns.
#[derive(Clone, Debug)]
pub struct Solver {
    blocks: Vec<Block>,
    /// determinants that must not vanish
    pub determinants: Vec<Expr>,
}

/// Why a system cannot be solved.
#[derive(Clone, Debug)]
pub enum SolveError {
    /// no equation is left for this unknown
    Undetermined(usize),
    /// the determinant of the block of these unknowns is identically 0
    Dependent(Vec<usize>),
    /// the block of these unknowns is too large
    TooLarge(Vec<usize>),
}

impl Solver {
    /// Prepares to solve `equations` (each = 0) for the `unknowns`. Equations that are not needed are left
    /// alone; of several that would do, earlier ones are taken. `samples` show what is constant without
    /// looking so.
    pub fn new(
        z: &mut Intermediates,
        samples: &mut [Sample],
        equations: &[LinearScalar],
        unknowns: &[usize],
    ) -> Result<Self, SolveError> {
        let position: BTreeMap<usize, usize> = unknowns.iter().enumerate().map(|(i, &u)| (u, i)).collect();
        let columns: Vec<Vec<usize>> = equations
            .iter()
            .map(|equation| equation.terms.keys().filter_map(|slot| position.get(slot).copied()).collect())
            .collect();
        let matched =
            matching(&columns, unknowns.len()).map_err(|free| SolveError::Undetermined(unknowns[free]))?;
        let mut solver = Solver { blocks: Vec::new(), determinants: Vec::new() };
        for block in blocks(&matched, &columns) {
            let slots: Vec<usize> = block.iter().map(|&i| unknowns[i]).collect();
            if block.len() > LARGEST_BLOCK {
                return Err(SolveError::TooLarge(slots));
            }
            let rows: Vec<usize> = block.iter().map(|&i| matched[i]).collect();
            let matrix: Vec<Vec<Expr>> = rows
                .iter()
                .map(|&row| slots.iter().map(|&slot| equations[row].coefficient(slot)).collect())
                .collect();
            let (inverse, determinant) = invert(z, samples, &matrix);
            if determinant.is_zero() {
                return Err(SolveError::Dependent(slots));
            }
            if !determinant.is_number() {
                solver.determinants.push(determinant);
            }
            solver.blocks.push(Block { unknowns: slots, equations: rows, inverse });
        }
        Ok(solver)
    }

    /// The unknowns that solve the equations (which may differ from those given to `new` in all but the
    /// coefficients of the unknowns), as forms in what else occurs; `tidy` shortens every coefficient.
    pub fn solve(
        &self,
        equations: &[LinearScalar],
        mut tidy: impl FnMut(Expr) -> Expr,
    ) -> BTreeMap<usize, LinearScalar> {
        let mut solved: BTreeMap<usize, LinearScalar> = BTreeMap::new();
        for block in &self.blocks {
            let right: Vec<LinearScalar> = block
                .equations
                .iter()
                .map(|&row| {
                    let mut known = equations[row].clone();
                    known.terms.retain(|slot, _| !block.unknowns.contains(slot));
                    known
                        .substitute(|slot| solved.get(&slot).cloned())
                        .scale(&Expr::integer(-1))
                        .map(|c| tidy(c.clone()))
                })
                .collect();
            for (i, &unknown) in block.unknowns.iter().enumerate() {
                let sum = right
                    .iter()
                    .zip(&block.inverse[i])
                    .fold(LinearScalar::constant(Expr::zero()), |sum, (r, k)| sum.add(&r.scale(k)));
                solved.insert(unknown, sum.map(|c| tidy(c.clone())));
            }
        }
        solved
    }
}

/// Inverse and determinant, by cofactors with shared minors.
fn invert(z: &mut Intermediates, samples: &mut [Sample], matrix: &[Vec<Expr>]) -> (Vec<Vec<Expr>>, Expr) {
    let n = matrix.len();
    let mut minors: BTreeMap<(u32, u32), Expr> = BTreeMap::new();
    let all = (1u32 << n) - 1;
    let determinant = minor(z, matrix, all, all, &mut minors);
    let determinant = constant(z, samples, determinant);
    let reciprocal = if determinant.is_zero() { Expr::zero() } else { determinant.pow(-1) };
    let inverse = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| {
                    let cofactor = minor(z, matrix, all & !(1 << j), all & !(1 << i), &mut minors);
                    let cofactor = if (i + j) % 2 == 1 { cofactor.neg() } else { cofactor };
                    cofactor.mul(&reciprocal)
                })
                .collect()
        })
        .collect();
    (inverse, determinant)
}

/// The determinant, or the number that it is: 1 or -1 where the matrix is a rotation, 0 where its rows depend
/// on each other.
fn constant(z: &Intermediates, samples: &mut [Sample], determinant: Expr) -> Expr {
    let is = |n: i64, samples: &mut [Sample]| vanishes(z, samples, &determinant.sub(&Expr::integer(n)));
    match [0, 1, -1].into_iter().find(|&n| !determinant.is_number() && is(n, samples)) {
        Some(n) => Expr::integer(n),
        None => determinant,
    }
}

fn minor(
    z: &mut Intermediates,
    matrix: &[Vec<Expr>],
    rows: u32,
    columns: u32,
    known: &mut BTreeMap<(u32, u32), Expr>,
) -> Expr {
    if rows == 0 {
        return Expr::one();
    }
    if let Some(value) = known.get(&(rows, columns)) {
        return value.clone();
    }
    let row = rows.trailing_zeros() as usize;
    let mut sum = Expr::zero();
    let mut sign = 1;
    for (column, entry) in matrix[row].iter().enumerate() {
        if columns & (1 << column) == 0 {
            continue;
        }
        if !entry.is_zero() {
            let rest = minor(z, matrix, rows & !(1 << row), columns & !(1 << column), known);
            sum = sum.add(&entry.mul(&rest).mul(&Expr::integer(sign)));
        }
        sign = -sign;
    }
    let sum = z.simplify(&sum);
    // Large minors get a name; small ones stay open so that what divides out does.
    let sum = if crate::algebra::size(&sum) > 24 { z.name(sum) } else { sum };
    known.insert((rows, columns), sum.clone());
    sum
}
