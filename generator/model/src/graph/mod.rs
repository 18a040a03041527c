//! The graph that a derivation builds: sums, products and functions, each once.
//!
//! Nodes refer only to earlier nodes, so the order of the nodes is an order of evaluation. Equal expressions
//! are one node.

pub mod differentiate;
pub mod modular;

use std::collections::HashMap;

use crate::arithmetic::Function;
use crate::number::Number;

/// A node of a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Node(pub u32);

/// Where a number comes in from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Input {
    /// run-time parameter (index into `Mechanism::parameters`)
    Parameter(u32),
    /// time
    Time,
    /// coordinate
    Coordinate(u32),
    /// independent speed
    Speed(u32),
    /// named input
    Input(u32),
    /// derivative of an independent speed (for inverse dynamics)
    Acceleration(u32),
    /// direction of a linearisation: independent coordinates, then independent speeds, then named inputs
    Tangent(u32),
}

/// What a node is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// exact number
    Number(Number),
    /// pi
    Pi,
    /// from outside
    Input(Input),
    /// sum of two or more
    Sum(Vec<Node>),
    /// product of two or more; a number, if any, stands first
    Product(Vec<Node>),
    /// integer power, neither 0 nor 1; negative: the base is a divisor
    Power(Node, i32),
    /// function of one or two nodes
    Call(Function, Vec<Node>),
}

impl NodeKind {
    /// The nodes that it refers to.
    pub fn operands(&self) -> &[Node] {
        match self {
            NodeKind::Number(_) | NodeKind::Pi | NodeKind::Input(_) => &[],
            NodeKind::Sum(nodes) | NodeKind::Product(nodes) | NodeKind::Call(_, nodes) => nodes,
            NodeKind::Power(base, _) => std::slice::from_ref(base),
        }
    }
}

/// The graph.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    kinds: Vec<NodeKind>,
    known: HashMap<NodeKind, Node>,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// What the nodes are, in an order of evaluation.
    pub fn kinds(&self) -> &[NodeKind] {
        &self.kinds
    }

    /// What a node is.
    pub fn kind(&self, node: Node) -> &NodeKind {
        &self.kinds[node.0 as usize]
    }

    /// Which nodes the roots need.
    pub fn reachable(&self, roots: impl IntoIterator<Item = Node>) -> Vec<bool> {
        let mut reachable = vec![false; self.kinds.len()];
        for root in roots {
            reachable[root.0 as usize] = true;
        }
        for (index, kind) in self.kinds.iter().enumerate().rev() {
            if reachable[index] {
                for operand in kind.operands() {
                    reachable[operand.0 as usize] = true;
                }
            }
        }
        reachable
    }

    /// A node as it is: nothing is collected or flattened. Operands must be nodes of this graph. The passes
    /// use it to say which factors or terms belong together.
    pub fn intern(&mut self, value: NodeKind) -> Node {
        if let Some(&node) = self.known.get(&value) {
            return node;
        }
        let node = Node(self.kinds.len() as u32);
        self.kinds.push(value.clone());
        self.known.insert(value, node);
        node
    }

    /// Operations that these nodes need, roughly: a rule for choosing between two ways to the same numbers.
    pub fn cost(&self, nodes: &[Node]) -> usize {
        let mut seen = vec![false; self.kinds.len()];
        let mut open = nodes.to_vec();
        let mut cost = 0;
        while let Some(node) = open.pop() {
            if std::mem::replace(&mut seen[node.0 as usize], true) {
                continue;
            }
            match self.kind(node) {
                NodeKind::Number(_) | NodeKind::Pi | NodeKind::Input(_) => {}
                NodeKind::Sum(parts) | NodeKind::Product(parts) => {
                    cost += parts.len() - 1;
                    open.extend(parts);
                }
                NodeKind::Power(base, n) => {
                    cost += n.unsigned_abs() as usize;
                    open.push(*base);
                }
                NodeKind::Call(_, parts) => {
                    cost += 20;
                    open.extend(parts);
                }
            }
        }
        cost
    }

    /// An exact number.
    pub fn number(&mut self, number: Number) -> Node {
        self.intern(NodeKind::Number(number))
    }

    /// An integer.
    pub fn integer(&mut self, n: i64) -> Node {
        self.number(Number::integer(n))
    }

    /// pi.
    pub fn pi(&mut self) -> Node {
        self.intern(NodeKind::Pi)
    }

    /// A number from outside.
    pub fn input(&mut self, input: Input) -> Node {
        self.intern(NodeKind::Input(input))
    }

    /// The number a node is, if it is one.
    pub fn as_number(&self, node: Node) -> Option<&Number> {
        match self.kind(node) {
            NodeKind::Number(number) => Some(number),
            _ => None,
        }
    }

    /// Whether the node is the number 0.
    pub fn is_zero(&self, node: Node) -> bool {
        self.as_number(node).is_some_and(Number::is_zero)
    }

    /// The sum of `terms`, numbers collected and zeros dropped.
    pub fn sum(&mut self, terms: impl IntoIterator<Item = Node>) -> Node {
        let mut constant = Number::integer(0);
        let mut rest = Vec::new();
        for term in terms {
            match self.kind(term) {
                NodeKind::Number(number) => constant = Number(constant.0 + &number.0),
                _ => rest.push(term),
            }
        }
        if !constant.is_zero() || rest.is_empty() {
            let constant = self.number(constant);
            rest.push(constant);
        }
        rest.sort_unstable();
        if let [only] = rest[..] { only } else { self.intern(NodeKind::Sum(rest)) }
    }

    /// Cancels a divisor against a factor that is the same, or whose parts are; says what number is left of
    /// it.
    fn cancel(&mut self, factors: &mut Vec<Node>) -> Option<Number> {
        for at in 0..factors.len() {
            let &NodeKind::Power(base, exponent) = self.kind(factors[at]) else { continue };
            if exponent > 0 {
                continue;
            }
            let (mut number, mut wanted) = (Number::integer(1), vec![base]);
            if let NodeKind::Product(parts) = self.kind(base) {
                wanted = parts.clone();
                if let Some(first) = self.as_number(wanted[0]).cloned() {
                    number = first;
                    wanted.remove(0);
                }
            }
            let mut left = factors.clone();
            left.remove(at);
            if wanted.iter().all(|&part| self.take(&mut left, part)) {
                let rest = self.power(base, exponent + 1);
                left.extend(Some(rest).filter(|_| exponent + 1 != 0));
                *factors = left;
                return Some(Number(number.0.recip()));
            }
        }
        None
    }

    /// Takes a factor out of a product once; says whether it was there.
    fn take(&mut self, factors: &mut Vec<Node>, factor: Node) -> bool {
        let is_power =
            |node: Node| matches!(*self.kind(node), NodeKind::Power(base, n) if base == factor && n > 0);
        let Some(at) = factors.iter().position(|&node| node == factor || is_power(node)) else {
            return false;
        };
        let found = factors.remove(at);
        if let &NodeKind::Power(base, exponent) = self.kind(found)
            && found != factor
        {
            let rest = self.power(base, exponent - 1);
            factors.push(rest);
        }
        true
    }

    /// The product of `factors`, numbers collected, ones dropped; 0 if one of them is 0. Divisors cancel
    /// against equal factors.
    pub fn product(&mut self, factors: impl IntoIterator<Item = Node>) -> Node {
        let mut constant = Number::integer(1);
        let mut rest = Vec::new();
        for factor in factors {
            match self.kind(factor) {
                NodeKind::Number(number) => constant = Number(constant.0 * &number.0),
                NodeKind::Product(inner) => {
                    for &factor in &inner.clone() {
                        match self.kind(factor) {
                            NodeKind::Number(number) => constant = Number(constant.0 * &number.0),
                            _ => rest.push(factor),
                        }
                    }
                }
                _ => rest.push(factor),
            }
        }
        if constant.is_zero() {
            return self.integer(0);
        }
        while let Some(number) = self.cancel(&mut rest) {
            constant = Number(constant.0 * number.0);
        }
        rest.sort_unstable();
        if !constant.is_one() || rest.is_empty() {
            let constant = self.number(constant);
            rest.insert(0, constant);
        }
        if let [only] = rest[..] { only } else { self.intern(NodeKind::Product(rest)) }
    }

    /// `-a`.
    pub fn neg(&mut self, a: Node) -> Node {
        let minus = self.integer(-1);
        self.product([minus, a])
    }

    /// `a - b`.
    pub fn sub(&mut self, a: Node, b: Node) -> Node {
        let b = self.neg(b);
        self.sum([a, b])
    }

    /// `a^n`.
    pub fn power(&mut self, a: Node, n: i32) -> Node {
        match (n, self.kind(a)) {
            (0, _) => self.integer(1),
            (1, _) => a,
            (_, NodeKind::Number(number)) if !(n < 0 && number.is_zero()) => {
                let number = Number(number.0.pow(n));
                self.number(number)
            }
            (_, &NodeKind::Power(base, m)) if m.checked_mul(n).is_some() => self.power(base, m * n),
            _ => self.intern(NodeKind::Power(a, n)),
        }
    }

    /// `a / b`.
    pub fn div(&mut self, a: Node, b: Node) -> Node {
        let b = self.power(b, -1);
        self.product([a, b])
    }

    /// The same nodes with inputs replaced.
    pub fn replaced(&mut self, nodes: &[Node], by: &HashMap<Input, Node>) -> Vec<Node> {
        let mut renamed: HashMap<Node, Node> = HashMap::new();
        let reachable = self.reachable(nodes.iter().copied());
        for index in (0..reachable.len()).filter(|&index| reachable[index]) {
            let node = Node(index as u32);
            let kind = self.kind(node).clone();
            let changed = kind.operands().iter().any(|operand| renamed.contains_key(operand));
            let of = |nodes: Vec<Node>| -> Vec<Node> {
                nodes.into_iter().map(|node| renamed.get(&node).copied().unwrap_or(node)).collect()
            };
            let new = match kind {
                NodeKind::Input(input) => by.get(&input).copied(),
                NodeKind::Sum(terms) if changed => Some(self.sum(of(terms))),
                NodeKind::Product(factors) if changed => Some(self.product(of(factors))),
                NodeKind::Power(base, n) if changed => Some(self.power(of(vec![base])[0], n)),
                NodeKind::Call(function, arguments) if changed => Some(self.call(function, of(arguments))),
                _ => None,
            };
            renamed.extend(new.map(|new| (node, new)));
        }
        nodes.iter().map(|node| renamed.get(node).copied().unwrap_or(*node)).collect()
    }

    /// A function of one or two nodes.
    pub fn call(&mut self, function: Function, arguments: Vec<Node>) -> Node {
        self.intern(NodeKind::Call(function, arguments))
    }
}
