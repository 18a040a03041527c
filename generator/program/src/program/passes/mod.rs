//! The passes that optimise a program, in one list. No pass changes the meaning of an output: tests compare
//! the results of the interpreter before and after each.
//!
//! The first passes work on the graph of a derivation; one lowers the graph to operations; the last ones work
//! on operations.

mod adjoint;
mod collect;
mod common_subexpressions;
pub(crate) mod contract;
mod dead_code;
mod equal;
mod factor;
mod flat_sums;
mod fold;
mod frequent_pairs;
mod identities;
pub mod modular;
mod prune;
mod reassociate;
mod rewrite;
mod terms;
#[cfg(test)]
pub mod testing;
mod vanishing;

use super::derivation::Derived;
use super::inputs::Inputs;
pub(crate) use super::lower::lower;
use super::solve::solved;
use super::straight_line::Program;

/// A pass.
#[derive(Clone, Copy)]
pub struct Pass {
    /// its name in cost tables
    pub name: &'static str,
    work: Work,
}

/// The function of a pass, by what it works on.
#[derive(Clone, Copy)]
enum Work {
    Graph(fn(&Derived) -> Derived),
    Lower(fn(&Derived) -> Program),
    Operations(fn(&Program) -> Program),
    Sampled(fn(&Program, &[Inputs]) -> Program),
}

/// The passes in their order.
pub const PASSES: [Pass; 13] = [
    Pass { name: "prune", work: Work::Graph(prune::prune) },
    Pass { name: "fold", work: Work::Graph(fold::fold) },
    Pass { name: "identities", work: Work::Graph(identities::replace) },
    Pass { name: "collect", work: Work::Graph(collect::collect) },
    Pass { name: "factor", work: Work::Graph(factor::factor) },
    Pass { name: "common subexpressions", work: Work::Graph(common_subexpressions::share) },
    Pass { name: "lower", work: Work::Lower(lower) },
    Pass { name: "contract", work: Work::Operations(contract::contract) },
    Pass { name: "dead code", work: Work::Operations(dead_code::remove) },
    Pass { name: "reassociate", work: Work::Sampled(reassociate::reassociate) },
    Pass { name: "vanishing", work: Work::Operations(vanishing::drop) },
    Pass { name: "equal values", work: Work::Sampled(equal::share) },
    Pass { name: "dead code again", work: Work::Operations(dead_code::remove) },
];

impl Program {
    /// The program of a derivation. The same derivation gives the same program.
    pub fn new(derived: &Derived) -> Self {
        let mut program = run(derived, |_, _| {});
        for apart in &derived.apart {
            program.append(&Program::new(apart));
        }
        program
    }
}

/// The derivation after the passes on the graph.
pub fn simplified(derived: &Derived) -> Derived {
    PASSES.iter().fold(derived.clone(), |derived, pass| match pass.work {
        Work::Graph(run) => run(&derived),
        _ => derived,
    })
}

/// A derivation between two passes.
enum Form {
    Graph(Derived),
    Operations(Program),
}

/// Sends a derivation through the passes, and calls `show` with the program after each.
pub fn run(derived: &Derived, mut show: impl FnMut(&'static str, &dyn Fn() -> Program)) -> Program {
    let mut form = Form::Graph(derived.clone());
    for pass in PASSES {
        form = match (pass.work, form) {
            (Work::Graph(run), Form::Graph(derived)) => Form::Graph(run(&derived)),
            (Work::Lower(run), Form::Graph(derived)) => Form::Operations(run(&derived)),
            (Work::Operations(run), Form::Operations(program)) => Form::Operations(run(&program)),
            (Work::Sampled(run), Form::Operations(program)) => {
                Form::Operations(run(&program, &derived.samples))
            }
            // The list has one lowering pass, after those on the graph; a test ensures this.
            (_, form) => form,
        };
        show(pass.name, &|| solved(form.program(), derived.solve.as_ref()));
    }
    solved(form.program(), derived.solve.as_ref())
}

impl Form {
    fn program(&self) -> Program {
        match self {
            Form::Graph(derived) => lower(derived),
            Form::Operations(program) => program.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::{agree, random};
    use super::*;

    #[test]
    fn all_passes_together_keep_the_meaning() {
        for seed in 1..150 {
            let derived = random(seed);
            agree(&lower(&derived), &run(&derived, |_, _| {}), &format!("seed {seed}"));
        }
    }

    #[test]
    fn one_pass_lowers_after_those_on_the_graph_and_before_those_on_operations() {
        let order = PASSES.map(|pass| match pass.work {
            Work::Graph(_) => 0,
            Work::Lower(_) => 1,
            Work::Operations(_) | Work::Sampled(_) => 2,
        });
        assert!(order.is_sorted() && order.iter().filter(|&&kind| kind == 1).count() == 1, "{order:?}");
    }

    #[test]
    fn show_receives_the_input_of_the_next_pass() {
        let (derived, mut shown) = (random(7), Vec::new());
        let last = run(&derived, |name, program| shown.push((name, program())));
        assert!(shown.iter().map(|(name, _)| *name).eq(PASSES.iter().map(|pass| pass.name)));
        assert_eq!(shown.last().map(|(_, program)| program), Some(&last));
        for pair in shown.windows(2) {
            agree(&pair[0].1, &pair[1].1, pair[1].0);
        }
    }
}
