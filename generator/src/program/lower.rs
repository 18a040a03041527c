//! From sums, products and powers to binary operations.
//!
//! * Signs travel beside the values and end in additions and subtractions, not in multiplications by -1.
//! * Factors and terms are ordered by stage, so that what depends on parameters alone forms a value of its own and is hoisted.
//! * A divisor that occurs once divides; one that occurs more often is inverted once.
//! * Sine and cosine of one angle are computed together.

use std::collections::{HashMap, HashSet};

use super::build::Builder;
use super::graph::{Graph, Node, Value as Form};
use super::operation::{Operation, Stage, Value};
use super::routine::Derived;
use super::{Guard, Output, Program};
use crate::model::mechanism::Function;

/// A value and whether its opposite is meant.
#[derive(Clone, Copy, Debug)]
struct Signed {
    value: Value,
    negative: bool,
}

/// The program of a derivation whose graph has been through the passes.
pub fn lower(derived: &Derived) -> Program {
    let roots = derived.outputs.iter().flat_map(|output| output.nodes.iter().copied());
    let reachable = reachable(&derived.graph, roots);
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
            values: output.nodes.iter().map(|&node| lowering.plain(node)).collect(),
        })
        .collect();
    let mut guards = Vec::new();
    for guard in derived.guards.iter().filter(|guard| reachable[guard.value.0 as usize]) {
        // A sign does not matter to a value that must not vanish.
        let value = lowering.signed(guard.value).value;
        let scale = guard.scale.map(|scale| {
            let needed = self::reachable(&derived.graph, [scale]);
            lowering.nodes(&needed);
            lowering.signed(scale).value
        });
        guards.push(Guard { value, scale, message: guard.message.clone() });
    }
    Program { operations: lowering.builder.finish(), outputs, guards, structures: derived.structures.clone() }
}

/// Which nodes the roots need.
pub fn reachable(graph: &Graph, roots: impl IntoIterator<Item = Node>) -> Vec<bool> {
    let mut reachable = vec![false; graph.values().len()];
    for root in roots {
        reachable[root.0 as usize] = true;
    }
    for index in (0..graph.values().len()).rev() {
        if reachable[index] {
            for operand in operands(&graph.values()[index]) {
                reachable[operand.0 as usize] = true;
            }
        }
    }
    reachable
}

/// The nodes that a node refers to.
pub fn operands(form: &Form) -> &[Node] {
    match form {
        Form::Number(_) | Form::Pi | Form::Input(_) => &[],
        Form::Sum(nodes) | Form::Product(nodes) | Form::Call(_, nodes) => nodes,
        Form::Power(base, _) => std::slice::from_ref(base),
    }
}

struct Lowering<'a> {
    graph: &'a Graph,
    builder: Builder,
    lowered: Vec<Option<Signed>>,
    /// how many products divide by a node
    divisions: HashMap<Node, usize>,
    /// angles of which both sine and cosine are wanted
    angles: HashSet<Node>,
}

impl<'a> Lowering<'a> {
    fn new(graph: &'a Graph) -> Self {
        Lowering {
            graph,
            builder: Builder::default(),
            lowered: vec![None; graph.values().len()],
            divisions: HashMap::new(),
            angles: HashSet::new(),
        }
    }

    /// Counts what decides how a node is lowered.
    fn survey(&mut self, reachable: &[bool]) {
        let mut functions: HashMap<Node, (bool, bool)> = HashMap::new();
        for (index, form) in self.graph.values().iter().enumerate() {
            if !reachable[index] {
                continue;
            }
            match form {
                Form::Call(Function::Sin, argument) => functions.entry(argument[0]).or_default().0 = true,
                Form::Call(Function::Cos, argument) => functions.entry(argument[0]).or_default().1 = true,
                Form::Power(..) => {}
                _ => {
                    for &operand in operands(form) {
                        if let &Form::Power(base, exponent) = self.graph.value(operand)
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
        for (index, form) in self.graph.values().iter().enumerate() {
            if reachable[index] && self.lowered[index].is_none() {
                let signed = self.form(form);
                self.lowered[index] = Some(signed);
            }
        }
    }

    /// A lowered node.
    fn signed(&self, node: Node) -> Signed {
        // Nodes refer to earlier nodes only, and all reachable ones are lowered in order.
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

    fn form(&mut self, form: &Form) -> Signed {
        let positive = |value| Signed { value, negative: false };
        match form {
            Form::Number(number) => {
                Signed { value: self.builder.constant(number.to_f64().abs()), negative: number.is_negative() }
            }
            Form::Pi => positive(self.builder.constant(std::f64::consts::PI)),
            Form::Input(input) => positive(self.builder.push(Operation::Input(*input))),
            Form::Sum(terms) => self.sum(terms),
            Form::Product(factors) => self.product(factors),
            &Form::Power(base, exponent) => self.power(base, exponent),
            Form::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn is_product(&self, value: Value) -> bool {
        matches!(self.builder.operation(value), Operation::Mul(..))
    }

    fn sum(&mut self, terms: &[Node]) -> Signed {
        let mut terms: Vec<Signed> = terms.iter().map(|&term| self.signed(term)).collect();
        // Products last within a stage: each then is the product of a fused multiply-add.
        terms.sort_by_key(|term| {
            (self.builder.stage(term.value), self.is_product(term.value), term.negative, term.value)
        });
        let mut terms = terms.into_iter();
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

    /// Moves the sign of a negation or of a negative constant out of a value.
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
            let shared_divisor = match *self.graph.value(factor) {
                Form::Power(base, exponent) if exponent < 0 => {
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

    /// The product of values, those of early stages first; a number multiplies the earliest group.
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

    fn call(&mut self, function: Function, arguments: &[Node]) -> Signed {
        if let [a, b] = *arguments {
            let (a, b) = (self.plain(a), self.plain(b));
            return Signed { value: self.builder.call2(function, a, b), negative: false };
        }
        let node = arguments[0];
        let argument = self.signed(node);
        let constant = self.builder.stage(argument.value) == Stage::Constant;
        let (value, negative) = match function {
            Function::Sin | Function::Cos if self.angles.contains(&node) && !constant => {
                let sine = function == Function::Sin;
                (self.builder.sin_cos(sine, argument.value), sine && argument.negative)
            }
            Function::Cos | Function::Abs => (self.builder.call(function, argument.value), false),
            Function::Sin | Function::Tan | Function::Asin | Function::Atan => {
                (self.builder.call(function, argument.value), argument.negative)
            }
            _ => {
                let argument = self.apply(argument);
                (self.builder.call(function, argument), false)
            }
        };
        self.unfold(Signed { value, negative })
    }
}
