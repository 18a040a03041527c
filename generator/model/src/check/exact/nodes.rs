//! Nodes of a graph from the expressions of a mechanism: positions, velocities and the residuals of
//! equations.
//!
//! Rates of coordinates are the inputs [`Input::Tangent`], all speeds are inputs [`Input::Speed`] in the
//! order of the mechanism, dependent ones last. Products and sums are left as they stand, so that the graph
//! is no larger than the model.

use std::collections::HashMap;

use crate::arithmetic::Function;
use crate::graph::differentiate::differentiate;
use crate::graph::{Graph, Input, Node, NodeKind};
use crate::model::mechanism::*;
use crate::number::Number;
use crate::span::Span;

/// Components along N.x, N.y, N.z.
pub type Triple = [Node; 3];
/// Rows of a matrix.
type Matrix = [Triple; 3];

/// Names may refer to names to this depth.
const MAX_DEPTH: usize = 400;
/// A larger graph is not looked at.
const LARGEST: usize = 200_000;
/// Numbers of more bits are not multiplied out.
const LONGEST: u64 = 4096;

/// What something is divided by, and where, if that is known.
pub struct Divisor {
    /// its value, or its square
    pub node: Node,
    /// where it stands
    pub span: Option<Span>,
}

/// The nodes that a mechanism was written as so far.
pub struct Nodes<'m> {
    m: &'m Mechanism,
    /// the graph
    pub graph: Graph,
    /// what must be 1 identically: the squares of the lengths of axes
    pub ones: Vec<Node>,
    /// what may not be 0 identically
    pub divisors: Vec<Divisor>,
    rates: HashMap<Input, Node>,
    scalars: HashMap<DefinitionId, Node>,
    vectors: HashMap<DefinitionId, Triple>,
    orientations: HashMap<FrameId, Matrix>,
    turnings: HashMap<FrameId, Triple>,
    stated: HashMap<FrameId, Triple>,
    positions: HashMap<PointId, Triple>,
    velocities: HashMap<PointId, Triple>,
    depth: usize,
}

impl<'m> Nodes<'m> {
    /// Of a mechanism nothing yet.
    pub fn new(m: &'m Mechanism) -> Self {
        let mut graph = Graph::new();
        let one = graph.integer(1);
        let mut rates = HashMap::from([(Input::Time, one)]);
        for i in 0..m.coordinates.len() as u32 {
            rates.insert(Input::Coordinate(i), graph.input(Input::Tangent(i)));
        }
        Nodes {
            m,
            graph,
            ones: Vec::new(),
            divisors: Vec::new(),
            rates,
            scalars: HashMap::new(),
            vectors: HashMap::new(),
            orientations: HashMap::new(),
            turnings: HashMap::new(),
            stated: HashMap::new(),
            positions: HashMap::new(),
            velocities: HashMap::new(),
            depth: 0,
        }
    }

    /// Work one level deeper; `None` where there are too many levels, or too many nodes.
    fn nested<T>(&mut self, work: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        if self.depth >= MAX_DEPTH || self.graph.kinds().len() > LARGEST {
            return None;
        }
        self.depth += 1;
        let made = work(self);
        self.depth -= 1;
        made
    }

    /// Left side less right side: one node, or three along N's axes.
    pub fn residual(&mut self, equation: &Equation) -> Option<Vec<Node>> {
        Some(match &equation.sides {
            EquationSides::Scalar(left, right) => {
                let (left, right) = (self.scalar(left)?, self.scalar(right)?);
                vec![self.less(left, right)]
            }
            EquationSides::Vector(left, right) => {
                let (left, right) = (self.vector(left)?, self.vector(right)?);
                self.difference(left, right).to_vec()
            }
        })
    }

    /// What the kinematical equations, declared motions and constraints say: residuals.
    pub fn motion(&mut self) -> Option<Vec<Node>> {
        let m = self.m;
        let mut out = Vec::new();
        for equation in m.kinematics.iter().chain(&m.constraints) {
            out.extend(self.residual(equation)?);
        }
        for (i, frame) in m.frames.iter().enumerate() {
            if let Some((within, value)) = &frame.angular_velocity {
                let declared = self.vector(value)?;
                let (own, other) = (self.turning(FrameId(i))?, self.turning(*within)?);
                let found = self.difference(own, other);
                out.extend(self.difference(declared, found));
            }
        }
        for (i, point) in m.points.iter().enumerate() {
            if let (Some(value), Place::Offset { .. } | Place::Material { .. }) =
                (&point.velocity, &point.place)
            {
                let declared = self.vector(value)?;
                let found = self.velocity_by_position(PointId(i))?;
                out.extend(self.difference(declared, found));
            }
        }
        Some(out)
    }

    /// A scalar.
    pub fn scalar(&mut self, scalar: &Scalar) -> Option<Node> {
        self.nested(|this| this.scalar_at_level(scalar))
    }

    fn scalar_at_level(&mut self, scalar: &Scalar) -> Option<Node> {
        let index = |i: usize| i as u32;
        Some(match scalar {
            Scalar::Number(number) => self.graph.number(number.clone()),
            Scalar::Pi => self.graph.pi(),
            Scalar::Time => self.graph.input(Input::Time),
            Scalar::Parameter(i) => self.graph.input(Input::Parameter(index(i.0))),
            Scalar::Input(i) => self.graph.input(Input::Input(index(i.0))),
            Scalar::Coordinate(i) => self.graph.input(Input::Coordinate(index(i.0))),
            Scalar::Speed(i) => self.graph.input(Input::Speed(index(i.0))),
            Scalar::Definition(i) => match (&self.m.definitions[i.0].value, self.scalars.get(i)) {
                (_, Some(node)) => *node,
                (DefinitionValue::Scalar(value), None) => {
                    let node = self.scalar(value)?;
                    self.scalars.insert(*i, node);
                    node
                }
                (DefinitionValue::Vector(_), None) => return None,
            },
            Scalar::Rate(inner) => {
                let inner = self.scalar(inner)?;
                self.rate([inner])[0]
            }
            Scalar::Neg(inner) => {
                let inner = self.scalar(inner)?;
                self.negative(inner)
            }
            Scalar::Add(items) => {
                let items: Option<Vec<Node>> = items.iter().map(|item| self.scalar(item)).collect();
                self.graph.sum(items?)
            }
            Scalar::Mul(items) => {
                let mut product = self.graph.integer(1);
                for item in items {
                    let factor = self.scalar(item)?;
                    product = times(&mut self.graph, product, factor);
                }
                product
            }
            Scalar::Div(a, b, span) => {
                let (a, b) = (self.scalar(a)?, self.scalar(b)?);
                self.divisors.push(Divisor { node: b, span: Some(*span) });
                if self.graph.is_zero(b) {
                    return None;
                }
                let b = self.graph.power(b, -1);
                times(&mut self.graph, a, b)
            }
            Scalar::Pow(base, exponent) => {
                let (base, exponent) = (self.scalar(base)?, self.scalar(exponent)?);
                let exponent = self.graph.as_number(exponent)?.to_integer()?;
                if exponent < 0 {
                    self.divisors.push(Divisor { node: base, span: None });
                }
                if exponent < 0 && self.graph.is_zero(base) {
                    return None;
                }
                let exponent = i32::try_from(exponent).ok().filter(|n| n.abs() < 1000)?;
                match self.graph.as_number(base) {
                    // exact powers of powers would have more digits than there is room for
                    Some(number) if bits(number) * u64::from(exponent.unsigned_abs()) > LONGEST => {
                        self.graph.intern(NodeKind::Power(base, exponent))
                    }
                    _ => self.graph.power(base, exponent),
                }
            }
            Scalar::Call(function, arguments) => {
                let arguments: Option<Vec<Node>> = arguments.iter().map(|a| self.scalar(a)).collect();
                let arguments = arguments?;
                if *function == Function::Tan {
                    let node = self.graph.call(Function::Cos, arguments.clone());
                    self.divisors.push(Divisor { node, span: None });
                }
                self.graph.call(*function, arguments)
            }
            Scalar::Dot(a, b) => {
                let (a, b) = (self.vector(a)?, self.vector(b)?);
                self.dot(a, b)
            }
            Scalar::Norm(v) => {
                let v = self.vector(v)?;
                let square = self.dot(v, v);
                self.graph.call(Function::Sqrt, vec![square])
            }
        })
    }

    /// A vector, along N's axes.
    pub fn vector(&mut self, vector: &Vector) -> Option<Triple> {
        self.nested(|this| this.vector_at_level(vector))
    }

    fn vector_at_level(&mut self, vector: &Vector) -> Option<Triple> {
        Some(match vector {
            Vector::Zero => self.zero(),
            Vector::Components(frame, components) => {
                let [x, y, z] = &**components;
                let along = [self.scalar(x)?, self.scalar(y)?, self.scalar(z)?];
                let axes = self.orientation(*frame)?;
                self.apply(axes, along)
            }
            Vector::Definition(i) => match (&self.m.definitions[i.0].value, self.vectors.get(i)) {
                (_, Some(known)) => *known,
                (DefinitionValue::Vector(value), None) => {
                    let made = self.vector(value)?;
                    self.vectors.insert(*i, made);
                    made
                }
                (DefinitionValue::Scalar(_), None) => return None,
            },
            Vector::Neg(inner) => self.vector(inner)?.map(|c| self.negative(c)),
            Vector::Add(items) => {
                let mut sum = self.zero();
                for item in items {
                    let item = self.vector(item)?;
                    sum = self.total(sum, item);
                }
                sum
            }
            Vector::Scale(scalar, vector) => {
                let (scalar, vector) = (self.scalar(scalar)?, self.vector(vector)?);
                vector.map(|c| times(&mut self.graph, scalar, c))
            }
            Vector::Cross(a, b) => {
                let (a, b) = (self.vector(a)?, self.vector(b)?);
                self.cross(a, b)
            }
            Vector::Unit(vector, span) => {
                let vector = self.vector(vector)?;
                let square = self.dot(vector, vector);
                self.divisors.push(Divisor { node: square, span: Some(*span) });
                if self.graph.is_zero(square) {
                    return None;
                }
                let length = self.graph.call(Function::Sqrt, vec![square]);
                let scale = self.graph.power(length, -1);
                vector.map(|c| times(&mut self.graph, scale, c))
            }
            Vector::Position { of, from } => {
                let (of, from) = (self.position(*of)?, self.position(*from)?);
                self.difference(of, from)
            }
            Vector::Velocity(point) => self.velocity(*point)?,
            Vector::AngularVelocity { of, in_frame } => {
                let (of, within) = (self.angular_velocity(*of)?, self.angular_velocity(*in_frame)?);
                self.difference(of, within)
            }
        })
    }

    /// The axes of a frame, as columns, along N's.
    fn orientation(&mut self, frame: FrameId) -> Option<Matrix> {
        if let Some(known) = self.orientations.get(&frame) {
            return Some(*known);
        }
        let made = self.nested(|this| {
            let Some(parent) = this.m.frames[frame.0].parent else { return Some(this.identity()) };
            let (outer, own) = (this.orientation(parent)?, this.relative(frame)?);
            Some(this.matrix_product(outer, own))
        })?;
        self.orientations.insert(frame, made);
        Some(made)
    }

    /// The axes of a frame along its parent's.
    fn relative(&mut self, frame: FrameId) -> Option<Matrix> {
        let m = self.m;
        Some(match &m.frames[frame.0].orientation {
            Orientation::Aligned => self.identity(),
            Orientation::Simple { axis, negative, angle } => {
                let angle = self.scalar(angle)?;
                let angle = if *negative { self.negative(angle) } else { angle };
                self.simple(*axis, angle)
            }
            Orientation::About { axis, angle } => {
                let [x, y, z] = &**axis;
                let axis = [self.scalar(x)?, self.scalar(y)?, self.scalar(z)?];
                let square = self.dot(axis, axis);
                self.ones.push(square);
                let angle = self.scalar(angle)?;
                self.about(axis, angle)
            }
            Orientation::Euler { axes, angles, body_fixed } => {
                let mut out = self.identity();
                for (axis, angle) in axes.iter().zip(angles.iter()) {
                    let angle = self.scalar(angle)?;
                    let turn = self.simple(*axis, angle);
                    out = match body_fixed {
                        true => self.matrix_product(out, turn),
                        false => self.matrix_product(turn, out),
                    };
                }
                out
            }
            // a quaternion is one of a rotation only where its length is 1, and spun frames have no axes
            Orientation::Quaternion(_) | Orientation::Spin(_) => return None,
        })
    }

    /// Angular velocity of a frame in N by the rates of the coordinates alone.
    fn turning(&mut self, frame: FrameId) -> Option<Triple> {
        if let Some(known) = self.turnings.get(&frame) {
            return Some(*known);
        }
        let made = self.nested(|this| {
            let Some(parent) = this.m.frames[frame.0].parent else { return Some(this.zero()) };
            let (outer, own) = (this.turning(parent)?, this.turning_in_parent(frame)?);
            Some(this.total(outer, own))
        })?;
        self.turnings.insert(frame, made);
        Some(made)
    }

    /// Angular velocity of a frame in its parent by the rates of the coordinates, along N's axes.
    fn turning_in_parent(&mut self, frame: FrameId) -> Option<Triple> {
        let parent = self.m.frames[frame.0].parent?;
        let axes = self.orientation(parent)?;
        let own = self.relative(frame)?;
        let rates: Matrix = own.map(|row| self.rate(row));
        // the products of rows of R' and R: of R' R^T, which is antisymmetric
        let mut at = |i: usize, j: usize| self.dot(rates[i], own[j]);
        let along = [at(2, 1), at(0, 2), at(1, 0)];
        Some(self.apply(axes, along))
    }

    /// Angular velocity of a frame in N, as the model states it.
    fn angular_velocity(&mut self, frame: FrameId) -> Option<Triple> {
        if let Some(known) = self.stated.get(&frame) {
            return Some(*known);
        }
        let made = self.nested(|this| {
            let f = &this.m.frames[frame.0];
            let Some(parent) = f.parent else { return Some(this.zero()) };
            let (outer, own) = match (&f.angular_velocity, &f.orientation) {
                (Some((within, value)), _) => (this.angular_velocity(*within)?, this.vector(value)?),
                (None, Orientation::Spin(value)) => (this.angular_velocity(parent)?, this.vector(value)?),
                (None, _) => (this.angular_velocity(parent)?, this.turning_in_parent(frame)?),
            };
            Some(this.total(outer, own))
        })?;
        self.stated.insert(frame, made);
        Some(made)
    }

    fn position(&mut self, point: PointId) -> Option<Triple> {
        if let Some(known) = self.positions.get(&point) {
            return Some(*known);
        }
        let made = self.nested(|this| match &this.m.points[point.0].place {
            Place::Origin | Place::Velocity(_) => Some(this.zero()),
            Place::Offset { from, by } | Place::Material { from, by, .. } => {
                let (from, by) = (this.position(*from)?, this.vector(by)?);
                Some(this.total(from, by))
            }
        })?;
        self.positions.insert(point, made);
        Some(made)
    }

    fn velocity(&mut self, point: PointId) -> Option<Triple> {
        if let Some(known) = self.velocities.get(&point) {
            return Some(*known);
        }
        let made = self.nested(|this| match &this.m.points[point.0].velocity {
            Some(value) => this.vector(value),
            None => this.velocity_by_position(point),
        })?;
        self.velocities.insert(point, made);
        Some(made)
    }

    fn velocity_by_position(&mut self, point: PointId) -> Option<Triple> {
        let m = self.m;
        match &m.points[point.0].place {
            Place::Origin => Some(self.zero()),
            Place::Velocity(value) => self.vector(value),
            Place::Offset { from, by } => {
                let (from, by) = (self.velocity(*from)?, self.vector(by)?);
                let rate = self.rate(by);
                Some(self.total(from, rate))
            }
            Place::Material { frame, from, by } => {
                let (from, by, turning) =
                    (self.velocity(*from)?, self.vector(by)?, self.angular_velocity(*frame)?);
                let around = self.cross(turning, by);
                Some(self.total(from, around))
            }
        }
    }

    /// Rates of what is free of speeds.
    fn rate<const N: usize>(&mut self, nodes: [Node; N]) -> [Node; N] {
        let rates = differentiate(&mut self.graph, &nodes, &self.rates);
        std::array::from_fn(|i| rates[i])
    }

    fn zero(&mut self) -> Triple {
        [self.graph.integer(0); 3]
    }

    fn negative(&mut self, a: Node) -> Node {
        let minus = self.graph.integer(-1);
        times(&mut self.graph, minus, a)
    }

    fn less(&mut self, a: Node, b: Node) -> Node {
        let b = self.negative(b);
        self.graph.sum([a, b])
    }

    fn total(&mut self, a: Triple, b: Triple) -> Triple {
        std::array::from_fn(|i| self.graph.sum([a[i], b[i]]))
    }

    fn difference(&mut self, a: Triple, b: Triple) -> Triple {
        std::array::from_fn(|i| self.less(a[i], b[i]))
    }

    fn dot(&mut self, a: Triple, b: Triple) -> Node {
        let terms: [Node; 3] = std::array::from_fn(|i| times(&mut self.graph, a[i], b[i]));
        self.graph.sum(terms)
    }

    fn cross(&mut self, a: Triple, b: Triple) -> Triple {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let (first, second) = (times(&mut self.graph, a[j], b[k]), times(&mut self.graph, a[k], b[j]));
            self.less(first, second)
        })
    }

    fn identity(&mut self) -> Matrix {
        let (zero, one) = (self.graph.integer(0), self.graph.integer(1));
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { one } else { zero }))
    }

    fn apply(&mut self, matrix: Matrix, v: Triple) -> Triple {
        matrix.map(|row| self.dot(row, v))
    }

    fn matrix_product(&mut self, a: Matrix, b: Matrix) -> Matrix {
        a.map(|row| std::array::from_fn(|j| self.dot(row, [b[0][j], b[1][j], b[2][j]])))
    }

    fn simple(&mut self, axis: Axis, angle: Node) -> Matrix {
        let mut along = self.zero();
        along[axis as usize] = self.graph.integer(1);
        self.about(along, angle)
    }

    /// Right-handed rotation about a unit vector.
    fn about(&mut self, axis: Triple, angle: Node) -> Matrix {
        let [sine, cosine] =
            [Function::Sin, Function::Cos].map(|function| self.graph.call(function, vec![angle]));
        let one = self.graph.integer(1);
        let rest = self.less(one, cosine);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let square = times(&mut self.graph, axis[i], axis[j]);
                let part = times(&mut self.graph, rest, square);
                if i == j {
                    return self.graph.sum([cosine, part]);
                }
                // the entries of the cross product with the axis: -z, y, z, -x, -y, x
                let turned = times(&mut self.graph, sine, axis[3 - i - j]);
                let turned = if (j + 3 - i) % 3 == 1 { self.negative(turned) } else { turned };
                self.graph.sum([part, turned])
            })
        })
    }
}

/// A product of two that takes no factors of others into its list: those of a chain of products would be
/// many. A number stands first.
pub fn times(graph: &mut Graph, a: Node, b: Node) -> Node {
    let number = |graph: &Graph, node: Node| graph.as_number(node).cloned();
    match (number(graph, a), number(graph, b)) {
        (Some(x), Some(y)) if bits(&x) + bits(&y) <= LONGEST => graph.number(Number(x.0 * y.0)),
        (Some(_), Some(_)) => graph.intern(NodeKind::Product(vec![a, b])),
        (Some(x), None) => multiple(graph, x, b),
        (None, Some(y)) => multiple(graph, y, a),
        (None, None) if a == b => graph.power(a, 2),
        (None, None) => graph.intern(NodeKind::Product(vec![a.min(b), a.max(b)])),
    }
}

fn multiple(graph: &mut Graph, number: Number, node: Node) -> Node {
    let (number, rest) = match graph.kind(node) {
        NodeKind::Product(factors) if factors.len() == 2 => match graph.as_number(factors[0]) {
            Some(first) if bits(first) + bits(&number) <= LONGEST => {
                (Number(number.0 * &first.0), factors[1])
            }
            _ => (number, node),
        },
        _ => (number, node),
    };
    if number.is_zero() {
        return graph.integer(0);
    }
    if number.is_one() {
        return rest;
    }
    let number = graph.number(number);
    graph.intern(NodeKind::Product(vec![number, rest]))
}

fn bits(number: &Number) -> u64 {
    number.0.numer().bits() + number.0.denom().bits()
}
