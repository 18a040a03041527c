//! Lowers a graph of sums, products and powers to binary operations.
//!
//! * Signs are kept beside the values and become additions or subtractions, not multiplications by -1.
//! * Factors and terms are ordered by stage, so that what depends on parameters alone forms a value of its
//!   own and is hoisted.
//! * A divisor that occurs once becomes a division; one that occurs more often is inverted once.
//! * Sine and cosine of one angle are computed together. The rounding error of a sum of angles is computed
//!   too, and sine and cosine are corrected by it: absolute angles of long chains would lose digits
//!   otherwise.

use std::collections::{HashMap, HashSet};

use super::build::Builder;
use super::derivation::Derived;
use super::graph::{Graph, Node, NodeKind};
use super::operation::{Operation, Stage, Value};
use super::output::{Guard, Output};
use super::straight_line::Program;
use hodograph_model::arithmetic::Function;

/// A value with a sign.
#[derive(Clone, Copy, Debug)]
struct Signed {
    value: Value,
    negative: bool,
}

/// The program of a derivation whose graph has passed through the passes.
pub fn lower(derived: &Derived) -> Program {
    let roots = derived.outputs.iter().flat_map(|output| output.values.iter().copied());
    let reachable = derived.graph.reachable(roots);
    let mut lowering = Lowering::new(&derived.graph);
    lowering.survey(&reachable);
    lowering.nodes(&reachable);
    let outputs = derived
        .outputs
        .iter()
        .map(|output| Output {
            quantity: output.quantity,
            rows: output.rows,
            columns: output.columns,
            values: output.values.iter().map(|&node| lowering.plain(node)).collect(),
        })
        .collect();
    let mut guards = Vec::new();
    for guard in derived.guards.iter().filter(|guard| reachable[guard.value.0 as usize]) {
        // The sign of a guarded value does not matter.
        let value = lowering.signed(guard.value).value;
        let scale = guard.scale.map(|scale| {
            let needed = derived.graph.reachable([scale]);
            lowering.nodes(&needed);
            lowering.signed(scale).value
        });
        guards.push(Guard { value, scale, message: guard.message.clone() });
    }
    Program { operations: lowering.builder.finish(), outputs, guards, structures: derived.structures.clone() }
}

struct Lowering<'a> {
    graph: &'a Graph,
    builder: Builder,
    lowered: Vec<Option<Signed>>,
    /// number of products that divide by a node
    divisions: HashMap<Node, usize>,
    /// angles of which both sine and cosine are used
    angles: HashSet<Node>,
    /// rounding errors of sums of angles, where they are computed
    rounding_errors: HashMap<Value, Value>,
}

impl<'a> Lowering<'a> {
    fn new(graph: &'a Graph) -> Self {
        Lowering {
            graph,
            builder: Builder::default(),
            lowered: vec![None; graph.kinds().len()],
            divisions: HashMap::new(),
            angles: HashSet::new(),
            rounding_errors: HashMap::new(),
        }
    }

    /// Counts what determines how nodes are lowered: divisions, and uses of sines and cosines.
    fn survey(&mut self, reachable: &[bool]) {
        let mut functions: HashMap<Node, (bool, bool)> = HashMap::new();
        for (index, form) in self.graph.kinds().iter().enumerate() {
            if !reachable[index] {
                continue;
            }
            match form {
                NodeKind::Call(Function::Sin, argument) => functions.entry(argument[0]).or_default().0 = true,
                NodeKind::Call(Function::Cos, argument) => functions.entry(argument[0]).or_default().1 = true,
                NodeKind::Power(..) => {}
                _ => {
                    for &operand in form.operands() {
                        if let &NodeKind::Power(base, exponent) = self.graph.kind(operand)
                            && exponent < 0
                        {
                            *self.divisions.entry(base).or_default() += 1;
                        }
                    }
                }
            }
        }
        self.angles =
            functions.into_iter().filter(|(_, both)| *both == (true, true)).map(|(node, _)| node).collect();
    }

    fn nodes(&mut self, reachable: &[bool]) {
        for (index, form) in self.graph.kinds().iter().enumerate() {
            if reachable[index] && self.lowered[index].is_none() {
                let signed = self.form(form);
                self.lowered[index] = Some(signed);
            }
        }
    }

    /// A lowered node.
    fn signed(&self, node: Node) -> Signed {
        // Nodes refer to earlier nodes only, and all reachable nodes are lowered in order.
        self.lowered[node.0 as usize].unwrap_or(Signed { value: Value(0), negative: false })
    }

    /// A lowered node with its sign applied.
    fn plain(&mut self, node: Node) -> Value {
        let signed = self.signed(node);
        self.apply(signed)
    }

    fn apply(&mut self, signed: Signed) -> Value {
        if signed.negative { self.builder.neg(signed.value) } else { signed.value }
    }

    fn form(&mut self, form: &NodeKind) -> Signed {
        let positive = |value| Signed { value, negative: false };
        match form {
            NodeKind::Number(number) => {
                Signed { value: self.builder.constant(number.to_f64().abs()), negative: number.is_negative() }
            }
            NodeKind::Pi => positive(self.builder.constant(std::f64::consts::PI)),
            NodeKind::Input(input) => positive(self.builder.push(Operation::Input(*input))),
            NodeKind::Sum(terms) => self.sum(terms),
            NodeKind::Product(factors) => self.product(factors),
            &NodeKind::Power(base, exponent) => self.power(base, exponent),
            NodeKind::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn is_product(&self, value: Value) -> bool {
        matches!(self.builder.operation(value), Operation::Mul(..))
    }

    /// The terms of a sum in the order in which they are added.
    fn in_order(&self, terms: &[Node]) -> Vec<Signed> {
        let mut terms: Vec<Signed> = terms.iter().map(|&term| self.signed(term)).collect();
        // Products come last within a stage, so that each becomes the product of a fused multiply-add.
        terms.sort_by_key(|term| {
            (self.builder.stage(term.value), self.is_product(term.value), term.negative, term.value)
        });
        terms
    }

    fn sum(&mut self, terms: &[Node]) -> Signed {
        let mut terms = self.in_order(terms).into_iter();
        let Some(mut sum) = terms.next() else {
            return Signed { value: self.builder.constant(0.0), negative: false };
        };
        for term in terms {
            sum = match (sum.negative, term.negative) {
                (false, false) => Signed { value: self.builder.add(sum.value, term.value), negative: false },
                (false, true) => Signed { value: self.builder.sub(sum.value, term.value), negative: false },
                (true, false) => Signed { value: self.builder.sub(term.value, sum.value), negative: false },
                (true, true) => Signed { value: self.builder.add(sum.value, term.value), negative: true },
            };
        }
        self.unfold(sum)
    }

    /// Moves the sign of a negation or of a negative constant from the value to its sign.
    fn unfold(&mut self, signed: Signed) -> Signed {
        match self.builder.operation(signed.value) {
            Operation::Neg(value) => Signed { value, negative: !signed.negative },
            Operation::Constant(bits) if bits.get() < 0.0 => {
                Signed { value: self.builder.constant(-bits.get()), negative: !signed.negative }
            }
            _ => signed,
        }
    }

    fn product(&mut self, factors: &[Node]) -> Signed {
        let mut negative = false;
        let mut numerators: Vec<Value> = Vec::new();
        let mut divisors: Vec<Value> = Vec::new();
        for &factor in factors {
            let shared_divisor = match *self.graph.kind(factor) {
                NodeKind::Power(base, exponent) if exponent < 0 => {
                    let base_value = self.signed(base);
                    let once = self.divisions.get(&base).copied().unwrap_or(0) <= 1;
                    // A divisor that is known at construction is inverted there.
                    if once && self.builder.stage(base_value.value) > Stage::Parameter {
                        negative ^= base_value.negative && exponent % 2 != 0;
                        divisors.push(self.builder.power(base_value.value, exponent.unsigned_abs()));
                        continue;
                    }
                    true
                }
                _ => false,
            };
            let signed = self.signed(factor);
            debug_assert!(!shared_divisor || self.lowered[factor.0 as usize].is_some());
            negative ^= signed.negative;
            numerators.push(signed.value);
        }
        let product = self.chain(numerators);
        let divisor = self.chain(divisors);
        let value = match (product, divisor) {
            (Some(product), None) => product,
            (Some(product), Some(divisor)) => self.builder.div(product, divisor),
            (None, Some(divisor)) => self.builder.recip(divisor),
            (None, None) => self.builder.constant(1.0),
        };
        self.unfold(Signed { value, negative })
    }

    /// The product of values, those of early stages first; a constant multiplies the earliest group.
    fn chain(&mut self, mut values: Vec<Value>) -> Option<Value> {
        values.sort_by_key(|&value| (self.builder.stage(value), value));
        let constants =
            values.iter().take_while(|&&value| self.builder.stage(value) == Stage::Constant).count();
        let first_stage = values.get(constants).map(|&value| self.builder.stage(value));
        let group = values[constants..]
            .iter()
            .take_while(|&&value| Some(self.builder.stage(value)) == first_stage)
            .count();
        values[..constants + group].rotate_left(constants);
        let mut values = values.into_iter();
        let first = values.next()?;
        Some(values.fold(first, |product, value| self.builder.mul(product, value)))
    }

    fn power(&mut self, base: Node, exponent: i32) -> Signed {
        let base_value = self.signed(base);
        let negative = base_value.negative && exponent % 2 != 0;
        let value = if exponent < 0 {
            let inverse = self.builder.recip(base_value.value);
            self.builder.power(inverse, exponent.unsigned_abs())
        } else {
            self.builder.power(base_value.value, exponent.unsigned_abs())
        };
        Signed { value, negative }
    }

    /// The exact rounding error of a sum (Knuth's two-sum), plus those of its terms; `None` for anything but
    /// sums at run time. Follows [`Lowering::sum`], whose values it finds again.
    fn rounding_error(&mut self, node: Node) -> Option<Value> {
        let NodeKind::Sum(terms) = self.graph.kind(node) else { return None };
        let result = self.signed(node);
        if self.builder.stage(result.value) <= Stage::Parameter {
            return None;
        }
        if let Some(&known) = self.rounding_errors.get(&result.value) {
            return Some(known);
        }
        let mut low = None;
        for &term in terms {
            if let Some(lost) = self.rounding_error(term) {
                let negative = self.signed(term).negative != result.negative;
                low = Some(self.gather(low, lost, negative));
            }
        }
        let mut terms = self.in_order(terms).into_iter();
        let mut sum = terms.next()?;
        for term in terms {
            let opposite = sum.negative != term.negative;
            let (a, b) =
                if sum.negative && opposite { (term.value, sum.value) } else { (sum.value, term.value) };
            let builder = &mut self.builder;
            let total = if opposite { builder.sub(a, b) } else { builder.add(a, b) };
            let of_b = builder.sub(total, a);
            let of_a = builder.sub(total, of_b);
            let from_a = builder.sub(a, of_a);
            let error = if opposite {
                let from_b = builder.add(b, of_b);
                builder.sub(from_a, from_b)
            } else {
                let from_b = builder.sub(b, of_b);
                builder.add(from_a, from_b)
            };
            sum = Signed { value: total, negative: sum.negative && !opposite };
            low = Some(self.gather(low, error, sum.negative != result.negative));
        }
        if let Some(low) = low {
            self.rounding_errors.insert(result.value, low);
        }
        low
    }

    fn gather(&mut self, sum: Option<Value>, part: Value, negative: bool) -> Value {
        match (sum, negative) {
            (None, false) => part,
            (None, true) => self.builder.neg(part),
            (Some(sum), false) => self.builder.add(sum, part),
            (Some(sum), true) => self.builder.sub(sum, part),
        }
    }

    /// Sine or cosine of a sum `a` with the rounding error `e`: `sin a + e cos a` and `cos a - e sin a`.
    fn corrected(&mut self, sine: bool, angle: Value, lost: Value) -> Value {
        let (s, c) = (self.builder.sin_cos(true, angle), self.builder.sin_cos(false, angle));
        if sine {
            let part = self.builder.mul(lost, c);
            self.builder.add(s, part)
        } else {
            let part = self.builder.mul(lost, s);
            self.builder.sub(c, part)
        }
    }

    fn call(&mut self, function: Function, arguments: &[Node]) -> Signed {
        if let [a, b] = *arguments {
            let (a, b) = (self.plain(a), self.plain(b));
            return Signed { value: self.builder.call2(function, a, b), negative: false };
        }
        let node = arguments[0];
        let argument = self.signed(node);
        let constant = self.builder.stage(argument.value) == Stage::Constant;
        let round = matches!(function, Function::Sin | Function::Cos);
        if let Some(lost) = Some(node).filter(|_| round).and_then(|node| self.rounding_error(node)) {
            let sine = function == Function::Sin;
            let value = self.corrected(sine, argument.value, lost);
            return Signed { value, negative: sine && argument.negative };
        }
        let (value, negative) = match function {
            Function::Sin | Function::Cos if self.angles.contains(&node) && !constant => {
                let sine = function == Function::Sin;
                (self.builder.sin_cos(sine, argument.value), sine && argument.negative)
            }
            Function::Cos | Function::Cosh | Function::Abs => {
                (self.builder.call(function, argument.value), false)
            }
            Function::Sin
            | Function::Tan
            | Function::Asin
            | Function::Atan
            | Function::Sinh
            | Function::Tanh
            | Function::Frozen => (self.builder.call(function, argument.value), argument.negative),
            _ => {
                let argument = self.apply(argument);
                (self.builder.call(function, argument), false)
            }
        };
        self.unfold(Signed { value, negative })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpret::Evaluator;
    use crate::program::Inputs;
    use crate::program::Quantity;
    use crate::program::graph::Input;

    /// Sine and cosine of signed sums of coordinates, in parts: `(a - b) - c`, and `-c + (a - b) - d`.
    fn angles() -> Derived {
        let mut graph = Graph::new();
        let [a, b, c, d] = [0, 1, 2, 3].map(|index| graph.input(Input::Coordinate(index)));
        let first = graph.sub(a, b);
        let second = graph.sub(first, c);
        let third = graph.sub(second, d);
        let calls = |graph: &mut Graph, node| {
            [Function::Sin, Function::Cos].map(|function| graph.call(function, vec![node]))
        };
        let nodes = [second, third].map(|angle| calls(&mut graph, angle)).concat();
        let outputs =
            vec![crate::program::Output { quantity: Quantity::Forcing, rows: 4, columns: 1, values: nodes }];
        Derived {
            graph,
            outputs,
            guards: vec![],
            structures: vec![],
            samples: vec![],
            apart: vec![],
            solve: None,
        }
    }

    #[test]
    fn sines_of_sums_are_as_good_as_sines() {
        let program = lower(&angles());
        // Coordinates are integers of 53 bits in this unit; their sums have more bits and are rounded in
        // doubles.
        let unit = 2f64.powi(-48);
        let (mut random, mut rounded) = (hodograph_random::Random::new(1), 0);
        for _ in 0..200 {
            let integers = [-1.0, 1.0, 1.0, 1.0].map(|sign| sign * ((random.bits() >> 11) | 1) as f64);
            let coordinates = integers.map(|integer| integer * unit).to_vec();
            let inputs = Inputs { coordinates, ..Inputs::default() };
            let found =
                Evaluator::new(&program).evaluate(&inputs, &[Quantity::Forcing]).unwrap().remove(0).values;
            let [a, b, c, d] = integers.map(|integer| integer as i128);
            for (at, exact) in [(0, a - b - c), (2, a - b - c - d)] {
                let high = exact as f64;
                let low = (exact - high as i128) as f64 * unit;
                rounded += usize::from(low != 0.0);
                let (s, c) = (high * unit).sin_cos();
                let (sine, cosine) = (s + low * c, c - low * s);
                let error = (found[at] - sine).abs().max((found[at + 1] - cosine).abs());
                assert!(error <= 2.0 * f64::EPSILON, "{error} of {unit}");
            }
        }
        assert!(rounded > 100, "{rounded}");
    }

    #[test]
    fn sines_of_single_angles_stay_as_they_are() {
        let mut graph = Graph::new();
        let angle = graph.input(Input::Coordinate(0));
        let nodes = vec![graph.call(Function::Sin, vec![angle]), graph.call(Function::Cos, vec![angle])];
        let outputs =
            vec![crate::program::Output { quantity: Quantity::Forcing, rows: 2, columns: 1, values: nodes }];
        let program = lower(&Derived {
            graph,
            outputs,
            guards: vec![],
            structures: vec![],
            samples: vec![],
            apart: vec![],
            solve: None,
        });
        assert_eq!(program.operations.len(), 4, "an input, a pair, and its two parts");
    }
}
