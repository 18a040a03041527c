//! Counts the operations of a program: per routine, per stage, and after each pass.

use std::fmt;
use std::ops::AddAssign;

use super::derivation::Derived;
use super::lower::lower;
use super::operation::{Operation, Stage};
use super::passes;
use super::quantity::Quantity;
use super::straight_line::Program;

/// Numbers of operations. A fused multiply-add counts as a multiplication and an addition. A negation counts
/// as nothing if it is an operand of a sum, else as an addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// multiplications
    pub multiplications: usize,
    /// additions, subtractions and remaining negations
    pub additions: usize,
    /// divisions and reciprocals
    pub divisions: usize,
    /// sines and cosines; a pair of one angle counts once
    pub trigonometric: usize,
    /// other functions
    pub functions: usize,
    /// pairs of a multiplication and an addition that are a single instruction on targets with fused
    /// multiply-add
    pub fused: usize,
}

impl Count {
    /// All operations; a sine-cosine pair is one.
    pub fn total(&self) -> usize {
        self.multiplications + self.additions + self.divisions + self.trigonometric + self.functions
    }

    fn of(operation: Operation) -> Self {
        use hodograph_model::arithmetic::Function;
        let mut count = Count::default();
        match operation {
            Operation::Constant(_) | Operation::Input(_) | Operation::Sine(_) | Operation::Cosine(_) => {}
            Operation::Neg(_) | Operation::Add(..) | Operation::Sub(..) => count.additions = 1,
            Operation::Mul(..) => count.multiplications = 1,
            Operation::Div(..) | Operation::Recip(_) => count.divisions = 1,
            Operation::MulAdd(..) | Operation::MulSub(..) | Operation::NegMulAdd(..) => {
                (count.multiplications, count.additions, count.fused) = (1, 1, 1);
            }
            Operation::SinCos(_) | Operation::Call(Function::Sin | Function::Cos, _) => {
                count.trigonometric = 1
            }
            Operation::Call(..) | Operation::Call2(..) => count.functions = 1,
        }
        count
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Count) {
        self.multiplications += other.multiplications;
        self.additions += other.additions;
        self.divisions += other.divisions;
        self.trigonometric += other.trigonometric;
        self.functions += other.functions;
        self.fused += other.fused;
    }
}

impl fmt::Display for Count {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "{} mul, {} add, {} div, {} sin/cos, {} other ({} fused)",
            self.multiplications,
            self.additions,
            self.divisions,
            self.trigonometric,
            self.functions,
            self.fused
        )
    }
}

/// Numbers of operations per stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// once, at construction
    pub parameter: Count,
    /// depending on coordinates and time
    pub configuration: Count,
    /// depending on speeds, inputs or accelerations
    pub velocity: Count,
}

impl Cost {
    /// The operations of an evaluation: all but those at construction.
    pub fn evaluation(&self) -> Count {
        let mut count = self.configuration;
        count += self.velocity;
        count
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Cost) {
        self.parameter += other.parameter;
        self.configuration += other.configuration;
        self.velocity += other.velocity;
    }
}

/// The state of a program after a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// name of the pass
    pub pass: &'static str,
    /// operations of all quantities together
    pub cost: Cost,
}

impl Program {
    /// The operations of a routine for some quantities.
    pub fn cost(&self, quantities: &[Quantity]) -> Cost {
        let stages = self.stages();
        let mut cost = Cost::default();
        for value in self.slice(quantities).order {
            let count = Count::of(self.operation(value));
            match stages[value.index()] {
                Stage::Constant => {}
                Stage::Parameter => cost.parameter += count,
                Stage::Configuration => cost.configuration += count,
                Stage::Velocity => cost.velocity += count,
            }
        }
        cost
    }

    /// All quantities that the program computes.
    pub fn quantities(&self) -> Vec<Quantity> {
        self.outputs.iter().map(|output| output.quantity).collect()
    }
}

/// The program after each pass, in order; the first step is the derivation before all passes.
pub fn trace(derived: &Derived) -> Vec<Step> {
    let step = |pass, program: &Program| Step { pass, cost: program.cost(&program.quantities()) };
    let mut steps = vec![step("none", &lower(derived))];
    passes::run(derived, |pass, program| steps.push(step(pass, &program())));
    for apart in &derived.apart {
        for (step, more) in steps.iter_mut().zip(trace(apart)) {
            step.cost += more.cost;
        }
    }
    steps
}
