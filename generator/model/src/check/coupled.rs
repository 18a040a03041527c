//! Splits linear systems into the smallest blocks that can be solved one after another, and refuses models
//! whose blocks are larger than the derivation solves.

use super::states::Seen;
use super::vector_constraints::turned;
use crate::diagnostics::{Diagnostic, codes};
use crate::model::mechanism::{EquationSides, Mechanism};
use crate::numeric;

/// Largest block that is solved in closed form.
pub const LARGEST_BLOCK: usize = 8;
/// What is nothing beside the other coefficients of an equation.
const NOISE: f64 = 1e-12;

/// Says so where more dependent speeds must be solved for at once than the derivation can. Which components a
/// vector equation has depends on the axes: it is said where it holds along the axes of every frame.
pub fn too_many_at_once(m: &Mechanism, seen: &[Seen<'_>]) -> Option<Diagnostic> {
    let dependent: Vec<usize> = (0..m.speeds.len()).filter(|&i| m.speeds[i].dependent).collect();
    if dependent.len() <= LARGEST_BLOCK {
        return None;
    }
    let at: Vec<Vec<Vec<f64>>> =
        seen.iter().filter_map(|seen| numeric::determining_coefficients(m, seen.state).ok()).collect();
    if at.len() < seen.len() || at.is_empty() {
        return None;
    }
    let along = |frame: usize| -> Option<Vec<usize>> {
        let mut columns = Vec::new();
        let mut first = 0;
        for equation in m.constraints_of_dependent_speeds() {
            let count = if matches!(equation.sides, EquationSides::Vector(..)) { 3 } else { 1 };
            let mut found = vec![Vec::new(); count];
            for (rows, seen) in at.iter().zip(seen) {
                let rows: Vec<Vec<f64>> = rows.iter().skip(first).take(count).cloned().collect();
                let rows = match count {
                    3 => turned(&rows, &seen.at.orientations.get(frame).copied().flatten()?),
                    _ => rows,
                };
                let size = rows.iter().flatten().fold(0.0_f64, |size, c| size.max(c.abs()));
                for (row, found) in rows.iter().zip(&mut found) {
                    let there = |&place: &usize| row[dependent[place]].abs() > NOISE * size;
                    let new: Vec<usize> = (0..dependent.len()).filter(there).collect();
                    found.extend(new.into_iter().filter(|place| !found.contains(place)).collect::<Vec<_>>());
                }
            }
            columns.extend(found.into_iter().filter(|row| !row.is_empty()));
            first += count;
        }
        let matched = matching(&columns, dependent.len()).ok()?;
        blocks(&matched, &columns).into_iter().max_by_key(Vec::len)
    };
    let largest: Vec<Vec<usize>> = (0..m.frames.len()).filter_map(along).collect();
    let least = largest.into_iter().min_by_key(Vec::len).filter(|block| block.len() > LARGEST_BLOCK)?;
    let speed = &m.speeds[dependent[least[0]]];
    let names: Vec<String> =
        least.iter().map(|&place| format!("`{}`", m.speeds[dependent[place]].name)).collect();
    let message = format!(
        "{} dependent speeds hang together, {LARGEST_BLOCK} at most are solved for at once",
        least.len()
    );
    let help = format!(
        "none of {} can be had without the others: make speeds dependent that one constraint determines from others, or state constraints \
         in which fewer speeds occur (of a part of the loop, with a speed of its own)",
        names.join(", ")
    );
    Some(Diagnostic::new(codes::TOO_LARGE, speed.span, message).help(help))
}

/// An equation for each unknown in which it occurs, earlier ones first; else an unknown for which none is
/// left. `columns` are the unknowns of each equation.
///
/// # Errors
///
/// The unknown.
pub fn matching(columns: &[Vec<usize>], unknowns: usize) -> Result<Vec<usize>, usize> {
    let mut matched = vec![usize::MAX; unknowns];
    for equation in 0..columns.len() {
        augment(equation, columns, &mut matched, &mut vec![false; unknowns]);
    }
    match matched.iter().position(|&equation| equation == usize::MAX) {
        Some(free) => Err(free),
        None => Ok(matched),
    }
}

fn augment(equation: usize, columns: &[Vec<usize>], matched: &mut [usize], seen: &mut [bool]) -> bool {
    for &unknown in &columns[equation] {
        if std::mem::replace(&mut seen[unknown], true) {
            continue;
        }
        if matched[unknown] == usize::MAX || augment(matched[unknown], columns, matched, seen) {
            matched[unknown] = equation;
            return true;
        }
    }
    false
}

/// Strongly connected sets of unknowns, each after those it needs: what must be solved at once. `matched` is
/// the equation of each unknown.
pub fn blocks(matched: &[usize], columns: &[Vec<usize>]) -> Vec<Vec<usize>> {
    struct Search<'a> {
        matched: &'a [usize],
        columns: &'a [Vec<usize>],
        index: Vec<Option<usize>>,
        low: Vec<usize>,
        stack: Vec<usize>,
        on_stack: Vec<bool>,
        count: usize,
        found: Vec<Vec<usize>>,
    }
    impl Search<'_> {
        fn visit(&mut self, v: usize) {
            self.index[v] = Some(self.count);
            self.low[v] = self.count;
            self.count += 1;
            self.stack.push(v);
            self.on_stack[v] = true;
            for &w in &self.columns[self.matched[v]] {
                match self.index[w] {
                    None => {
                        self.visit(w);
                        self.low[v] = self.low[v].min(self.low[w]);
                    }
                    Some(index) if self.on_stack[w] => self.low[v] = self.low[v].min(index),
                    _ => {}
                }
            }
            if Some(self.low[v]) == self.index[v] {
                let mut block = Vec::new();
                while let Some(w) = self.stack.pop() {
                    self.on_stack[w] = false;
                    block.push(w);
                    if w == v {
                        break;
                    }
                }
                block.sort_unstable();
                self.found.push(block);
            }
        }
    }
    let n = matched.len();
    let mut search = Search {
        matched,
        columns,
        index: vec![None; n],
        low: vec![0; n],
        stack: Vec::new(),
        on_stack: vec![false; n],
        count: 0,
        found: Vec::new(),
    };
    for v in 0..n {
        if search.index[v].is_none() {
            search.visit(v);
        }
    }
    search.found
}
