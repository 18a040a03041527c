//! Writes the table of results.

use std::collections::BTreeMap;

use hodograph_generator::program::Program;
use hodograph_generator::program::cost::Count;
use hodograph_generator::program::{ContactQuantity, Quantity};

use crate::count::{CONSTRUCTION, Counts};
use crate::derive::Derivation;
use crate::harness::{DERIVATIVES, ROUTINES};
use crate::peers::Peers;

/// A measured mechanism.
pub struct Row<'a> {
    /// its derivation
    pub derivation: &'a Derivation<'a>,
    /// seconds of compiling
    pub compile_seconds: f64,
    /// instructions per evaluation
    pub counts: Counts,
    /// bytes of machine code
    pub sizes: BTreeMap<&'static str, u64>,
    /// the largest difference of the derivatives from a peer's, as a part of the largest entry of a matrix
    pub slopes: Option<f64>,
}

/// The quantities of a routine.
fn quantities(routine: &str) -> Vec<Quantity> {
    match routine {
        "FD" => vec![Quantity::Accelerations],
        "ID" => vec![Quantity::InverseDynamics],
        "CM" => [ContactQuantity::PartialVelocities, ContactQuantity::Reduced]
            .map(|quantity| Quantity::Contact(0, quantity))
            .to_vec(),
        "dFD" => vec![Quantity::AccelerationsDerivatives],
        "dID" => vec![Quantity::InverseDynamicsDerivatives],
        "A, B" => vec![Quantity::RatesDerivatives, Quantity::AccelerationsDerivatives],
        _ => vec![Quantity::MassMatrix],
    }
}

/// Operations of a routine as the program has them: multiplications, additions, divisions, pairs of sine and
/// cosine, and how many of the multiplications are fused with an addition.
fn operations(program: &Program, routine: &str) -> String {
    let count = program.cost(&quantities(routine)).evaluation();
    let Count { multiplications, additions, divisions, trigonometric, fused, .. } = count;
    format!("{multiplications}/{additions}/{divisions}/{trigonometric} ({fused})")
}

/// Prints the table as Markdown.
pub fn print(rows: &[Row<'_>], peers: &Peers) {
    println!(
        "| mechanism | routine | run-time | ratio | fixed | ratio | best peer | operations | code (bytes) |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | --- | ---: | ---: |");
    for pair in rows.chunks_exact(2) {
        let [run_time, fixed] = pair else { continue };
        for (routine, _) in ROUTINES.into_iter().chain(DERIVATIVES) {
            let of = |row: &Row<'_>| row.counts.get(routine).copied();
            let (Some(slow), Some(fast)) = (of(run_time), of(fixed)) else { continue };
            let case = run_time.derivation.case;
            let best = peers.best(&case.name, routine);
            let ratio = |count: f64| {
                best.as_ref().map_or(String::new(), |best| format!("{:.2}", count / best.instructions))
            };
            let peer =
                best.as_ref().map_or(String::new(), |best| format!("{} ({})", best.instructions, best.name));
            println!(
                "| {} | {routine} | {slow:.0} | {} | {fast:.0} | {} | {peer} | {} | {} |",
                case.title,
                ratio(slow),
                ratio(fast),
                operations(&fixed.derivation.program, routine),
                fixed.sizes.get(routine).copied().unwrap_or(0),
            );
        }
    }
    println!(
        "\nOperations (parameters fixed): multiplications/additions/divisions/pairs of sine and cosine (of them fused).\n"
    );
    println!(
        "| mechanism | parameters | derivation (CPU s) | memory (MB) | compiling (CPU s) | construction (instructions) |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: |");
    for row in rows {
        let derivation = row.derivation;
        println!(
            "| {} | {} | {:.2} | {} | {:.1} | {} |",
            derivation.case.title,
            if derivation.fixed { "fixed" } else { "run-time" },
            derivation.seconds,
            derivation.kilobytes.map_or("-".to_owned(), |kilobytes| format!("{}", kilobytes / 1024)),
            row.compile_seconds,
            row.counts.get(CONSTRUCTION).map_or(String::new(), |count| format!("{count:.0}"))
        );
    }
    println!(
        "\nDerivatives beside Pinocchio's at the same states: the largest difference, as a part of the largest entry of its matrix.\n"
    );
    println!("| mechanism | run-time | fixed |");
    println!("| --- | ---: | ---: |");
    for pair in rows.chunks_exact(2) {
        let [run_time, fixed] = pair else { continue };
        if let (Some(slow), Some(fast)) = (run_time.slopes, fixed.slopes) {
            println!("| {} | {slow:.1e} | {fast:.1e} |", run_time.derivation.case.title);
        }
    }
}
