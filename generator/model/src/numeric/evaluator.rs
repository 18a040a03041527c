//! Values of expressions, orientations, positions and velocities at one state and motion.
//!
//! Expressions are evaluated at one of two levels. *Geometry* knows coordinates and time, which move (e1
//! carries their rates); *motion* knows speeds as well, and takes from geometry values and rates.

use std::cell::{Cell, RefCell};

use super::hyper_dual::*;
use super::state::Failure;
use crate::arithmetic::Function;
use crate::model::mechanism::*;
use crate::span::Span;

/// At which level an expression is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// coordinates and time, which move
    Geometry,
    /// speeds, velocities and rates
    Motion,
}

type Cache<T> = RefCell<Vec<Option<T>>>;

#[derive(Clone, Copy)]
enum Known {
    Scalar(HyperDual),
    Vector(Triple),
}

/// All values at one state and motion.
pub struct Evaluator<'m> {
    m: &'m Mechanism,
    parameters: &'m [f64],
    inputs: &'m [f64],
    time: HyperDual,
    coordinates: Vec<HyperDual>,
    speeds: Vec<HyperDual>,
    definitions: [Cache<Known>; 2],
    orientations: Cache<Matrix3>,
    turning: Cache<Triple>,
    positions: Cache<Triple>,
    velocities: Cache<Triple>,
    depth: Cell<usize>,
}

/// Names may refer to names to this depth.
const MAX_DEPTH: usize = 400;

impl<'m> Evaluator<'m> {
    /// `time` and `coordinates` carry their rates in e1. `speeds` are all, independent ones first.
    pub fn new(
        m: &'m Mechanism,
        parameters: &'m [f64],
        inputs: &'m [f64],
        time: HyperDual,
        coordinates: Vec<HyperDual>,
        speeds: Vec<HyperDual>,
    ) -> Self {
        fn cache<T>(n: usize) -> Cache<T> {
            RefCell::new((0..n).map(|_| None).collect())
        }
        Evaluator {
            m,
            parameters,
            inputs,
            time,
            coordinates,
            speeds,
            definitions: [cache(m.definitions.len()), cache(m.definitions.len())],
            orientations: cache(m.frames.len()),
            turning: cache(m.frames.len()),
            positions: cache(m.points.len()),
            velocities: cache(m.points.len()),
            depth: Cell::new(0),
        }
    }

    fn nested<T>(&self, run: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
        if self.depth.get() >= MAX_DEPTH {
            return Err(Failure::TooDeep);
        }
        self.depth.set(self.depth.get() + 1);
        let result = run();
        self.depth.set(self.depth.get() - 1);
        result
    }

    fn cached<T: Copy>(
        &self,
        cache: &Cache<T>,
        i: usize,
        run: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        if let Some(value) = cache.borrow()[i] {
            return Ok(value);
        }
        let value = self.nested(run)?;
        cache.borrow_mut()[i] = Some(value);
        Ok(value)
    }

    fn definition(&self, id: DefinitionId, level: Level) -> Result<Known, Failure> {
        self.cached(&self.definitions[level as usize], id.0, || match &self.m.definitions[id.0].value {
            DefinitionValue::Scalar(scalar) => Ok(Known::Scalar(self.scalar(scalar, level)?)),
            DefinitionValue::Vector(vector) => Ok(Known::Vector(self.vector(vector, level)?)),
        })
    }

    /// A scalar, in SI units.
    pub fn scalar(&self, scalar: &Scalar, level: Level) -> Result<HyperDual, Failure> {
        let still = |value: HyperDual| if level == Level::Motion { value.still() } else { value };
        Ok(match scalar {
            Scalar::Number(n) => HyperDual::constant(n.to_f64()),
            Scalar::Pi => HyperDual::constant(std::f64::consts::PI),
            Scalar::Time => still(self.time),
            Scalar::Parameter(i) => HyperDual::constant(self.parameters[i.0]),
            Scalar::Input(i) => HyperDual::constant(self.inputs[i.0]),
            Scalar::Coordinate(i) => still(self.coordinates[i.0]),
            Scalar::Speed(i) => match level {
                Level::Motion => self.speeds[i.0],
                Level::Geometry => return Err(Failure::Unsupported("a speed in a position")),
            },
            Scalar::Definition(i) => match self.definition(*i, level)? {
                Known::Scalar(value) => value,
                Known::Vector(_) => return Err(Failure::Unsupported("a vector in place of a scalar")),
            },
            Scalar::Rate(inner) => match level {
                Level::Motion => self.scalar(inner, Level::Geometry)?.rate(),
                Level::Geometry => return Err(Failure::Unsupported("a rate in a position")),
            },
            Scalar::Neg(inner) => -self.scalar(inner, level)?,
            Scalar::Add(items) => {
                let mut sum = HyperDual::ZERO;
                for item in items {
                    sum = sum + self.scalar(item, level)?;
                }
                sum
            }
            Scalar::Mul(items) => {
                let mut product = HyperDual::ONE;
                for item in items {
                    product = product * self.scalar(item, level)?;
                }
                product
            }
            Scalar::Div(a, b, span) => {
                let (a, b) = (self.scalar(a, level)?, self.scalar(b, level)?);
                if b.re == 0.0 {
                    return Err(Failure::DivisionByZero(*span));
                }
                a / b
            }
            Scalar::Pow(base, exponent) => {
                let (b, e) = (self.scalar(base, level)?, self.scalar(exponent, level)?);
                if e == HyperDual::constant(e.re) { b.power(e.re) } else { (e * b.ln()).exp() }
            }
            Scalar::Call(function, arguments) => {
                let a = self.scalar(&arguments[0], level)?;
                match function {
                    Function::Sin => a.sin(),
                    Function::Cos => a.cos(),
                    Function::Tan => a.tan(),
                    Function::Asin => a.asin(),
                    Function::Acos => a.acos(),
                    Function::Atan => a.atan(),
                    Function::Sqrt => a.sqrt(),
                    Function::Exp => a.exp(),
                    Function::Log => a.ln(),
                    Function::Sinh => a.sinh(),
                    Function::Cosh => a.cosh(),
                    Function::Tanh => a.tanh(),
                    Function::Abs => a.abs(),
                    Function::Sign => HyperDual::constant(if a.re < 0.0 { -1.0 } else { 1.0 }),
                    Function::Frozen => HyperDual::constant(a.re),
                    Function::Atan2 => a.atan2(self.scalar(&arguments[1], level)?),
                    Function::Min | Function::Max => {
                        let b = self.scalar(&arguments[1], level)?;
                        if (a.re < b.re) == (*function == Function::Min) { a } else { b }
                    }
                }
            }
            Scalar::Dot(a, b) => dot(self.vector(a, level)?, self.vector(b, level)?),
            Scalar::Norm(v) => {
                let v = self.vector(v, level)?;
                dot(v, v).sqrt()
            }
        })
    }

    /// A vector, by its components along N.x, N.y, N.z.
    pub fn vector(&self, vector: &Vector, level: Level) -> Result<Triple, Failure> {
        let still = |v: Triple| if level == Level::Motion { v.map(HyperDual::still) } else { v };
        let moving_only = |what| match level {
            Level::Motion => Ok(()),
            Level::Geometry => Err(Failure::Unsupported(what)),
        };
        Ok(match vector {
            Vector::Zero => [HyperDual::ZERO; 3],
            Vector::Components(frame, components) => {
                let mut v = [HyperDual::ZERO; 3];
                for (c, component) in v.iter_mut().zip(components.iter()) {
                    *c = self.scalar(component, level)?;
                }
                let axes = self.orientation(*frame)?;
                apply(&axes.map(still), v)
            }
            Vector::Definition(i) => match self.definition(*i, level)? {
                Known::Vector(value) => value,
                Known::Scalar(_) => return Err(Failure::Unsupported("a scalar in place of a vector")),
            },
            Vector::Neg(inner) => self.vector(inner, level)?.map(|c| -c),
            Vector::Add(items) => {
                let mut sum = [HyperDual::ZERO; 3];
                for item in items {
                    sum = add(sum, self.vector(item, level)?);
                }
                sum
            }
            Vector::Scale(s, v) => scale(self.scalar(s, level)?, self.vector(v, level)?),
            Vector::Cross(a, b) => cross(self.vector(a, level)?, self.vector(b, level)?),
            Vector::Unit(v, span) => {
                let v = self.vector(v, level)?;
                let length = dot(v, v).sqrt();
                if length.re == 0.0 {
                    return Err(Failure::DivisionByZero(*span));
                }
                scale(HyperDual::ONE / length, v)
            }
            Vector::Position { of, from } => still(sub(self.position(*of)?, self.position(*from)?)),
            Vector::Velocity(point) => {
                moving_only("a velocity in a position")?;
                self.velocity(*point)?
            }
            Vector::AngularVelocity { of, in_frame } => {
                moving_only("an angular velocity in a position")?;
                sub(self.angular_velocity(*of)?, self.angular_velocity(*in_frame)?)
            }
        })
    }

    /// The axes of a frame, as columns, along N's. At the level of geometry.
    pub fn orientation(&self, frame: FrameId) -> Result<Matrix3, Failure> {
        self.cached(&self.orientations, frame.0, || {
            let f = &self.m.frames[frame.0];
            let Some(parent) = f.parent else { return Ok(IDENTITY) };
            Ok(product(&self.orientation(parent)?, &self.relative_orientation(&f.orientation)?))
        })
    }

    fn relative_orientation(&self, orientation: &Orientation) -> Result<Matrix3, Failure> {
        let g = Level::Geometry;
        let simple = |axis: Axis, angle: HyperDual| {
            let mut v = [HyperDual::ZERO; 3];
            v[axis as usize] = HyperDual::ONE;
            about(v, angle)
        };
        Ok(match orientation {
            Orientation::Aligned => IDENTITY,
            Orientation::Simple { axis, negative, angle } => {
                let angle = self.scalar(angle, g)?;
                simple(*axis, if *negative { -angle } else { angle })
            }
            Orientation::About { axis, angle } => {
                let mut v = [HyperDual::ZERO; 3];
                for (c, component) in v.iter_mut().zip(axis.iter()) {
                    *c = self.scalar(component, g)?;
                }
                about(v, self.scalar(angle, g)?)
            }
            Orientation::Euler { axes, angles, body_fixed } => {
                let mut out = IDENTITY;
                for (axis, angle) in axes.iter().zip(angles.iter()) {
                    let turn = simple(*axis, self.scalar(angle, g)?);
                    out = if *body_fixed { product(&out, &turn) } else { product(&turn, &out) };
                }
                out
            }
            Orientation::Quaternion(ids) => {
                let [a, b, c, d] = ids.map(|i| self.coordinates[i.0]);
                let two = HyperDual::constant(2.0);
                [
                    [a * a + b * b - c * c - d * d, two * (b * c - a * d), two * (b * d + a * c)],
                    [two * (b * c + a * d), a * a - b * b + c * c - d * d, two * (c * d - a * b)],
                    [two * (b * d - a * c), two * (c * d + a * b), a * a - b * b - c * c + d * d],
                ]
            }
            Orientation::Spin(_) => return Err(Failure::Unsupported("axes of a frame made by `spin`")),
        })
    }

    /// Angular velocity of a frame in another by the rates of the coordinates alone.
    pub fn turning_by_geometry(&self, of: FrameId, within: FrameId) -> Result<Triple, Failure> {
        let (a, b) = (self.orientation(of)?, self.orientation(within)?);
        let rates = |m: &Matrix3| {
            let (rate, value) =
                (m.map(|row| row.map(HyperDual::rate)), m.map(|row| row.map(HyperDual::still)));
            let spin = product(&rate, &transposed(&value));
            // antisymmetric for a rotation; the mean keeps what rounding and a quaternion's length disturb
            // small
            let half = HyperDual::constant(0.5);
            [
                half * (spin[2][1] - spin[1][2]),
                half * (spin[0][2] - spin[2][0]),
                half * (spin[1][0] - spin[0][1]),
            ]
        };
        Ok(sub(rates(&a), rates(&b)))
    }

    /// Angular velocity of a frame in N.
    pub fn angular_velocity(&self, frame: FrameId) -> Result<Triple, Failure> {
        self.cached(&self.turning, frame.0, || {
            let f = &self.m.frames[frame.0];
            let Some(parent) = f.parent else { return Ok([HyperDual::ZERO; 3]) };
            match (&f.angular_velocity, &f.orientation) {
                (Some((within, value)), _) => {
                    Ok(add(self.angular_velocity(*within)?, self.vector(value, Level::Motion)?))
                }
                (None, Orientation::Spin(value)) => {
                    Ok(add(self.angular_velocity(parent)?, self.vector(value, Level::Motion)?))
                }
                (None, _) => {
                    Ok(add(self.angular_velocity(parent)?, self.turning_by_geometry(frame, parent)?))
                }
            }
        })
    }

    /// Position of a point from O, or from the point by whose velocity it is known. At the level of geometry.
    pub fn position(&self, point: PointId) -> Result<Triple, Failure> {
        self.cached(&self.positions, point.0, || match &self.m.points[point.0].place {
            Place::Origin | Place::Velocity(_) => Ok([HyperDual::ZERO; 3]),
            Place::Offset { from, by } | Place::Material { from, by, .. } => {
                Ok(add(self.position(*from)?, self.vector(by, Level::Geometry)?))
            }
        })
    }

    /// Velocity of a point in N.
    pub fn velocity(&self, point: PointId) -> Result<Triple, Failure> {
        self.cached(&self.velocities, point.0, || match &self.m.points[point.0].velocity {
            Some(value) => self.vector(value, Level::Motion),
            None => self.velocity_by_position(point),
        })
    }

    /// Velocity of a point as its place tells, whatever is declared of it.
    pub fn velocity_by_position(&self, point: PointId) -> Result<Triple, Failure> {
        match &self.m.points[point.0].place {
            Place::Origin => Ok([HyperDual::ZERO; 3]),
            Place::Velocity(value) => self.vector(value, Level::Motion),
            Place::Offset { from, by } => {
                Ok(add(self.velocity(*from)?, self.vector(by, Level::Geometry)?.map(HyperDual::rate)))
            }
            Place::Material { frame, from, by } => {
                let arm = self.vector(by, Level::Geometry)?.map(HyperDual::still);
                Ok(add(self.velocity(*from)?, cross(self.angular_velocity(*frame)?, arm)))
            }
        }
    }

    /// Velocity in N of a point as a place, whatever matter is there: the rate of its position.
    pub fn rate_of_position(&self, point: PointId) -> Result<Triple, Failure> {
        let rate = self.position(point)?.map(HyperDual::rate);
        match self.root(point) {
            PointId::O => Ok(rate),
            root => Ok(add(self.velocity(root)?, rate)),
        }
    }

    /// Whether the positions of both are known from the same point.
    pub fn same_root(&self, a: PointId, b: PointId) -> bool {
        self.root(a) == self.root(b)
    }

    /// The point from which the position of a point is known.
    pub fn root(&self, point: PointId) -> PointId {
        let mut at = point;
        while let Place::Offset { from, .. } | Place::Material { from, .. } = &self.m.points[at.0].place {
            at = *from;
        }
        at
    }

    /// Velocity of the material point of a body that is at a point now.
    pub fn velocity_on_body(&self, point: PointId, body: BodyId) -> Result<Triple, Failure> {
        let body = &self.m.bodies[body.0];
        match body.frame {
            Some(frame) if self.same_root(point, body.centre) => {
                let arm = sub(self.position(point)?, self.position(body.centre)?).map(HyperDual::still);
                Ok(add(self.velocity(body.centre)?, cross(self.angular_velocity(frame)?, arm)))
            }
            Some(_) => self.velocity(point),
            None => self.velocity(body.centre),
        }
    }

    /// Relative velocity of a contact: of P less of what it strikes.
    pub fn contact_velocity(&self, contact: &Contact) -> Result<Triple, Failure> {
        let of = |point: PointId, body: Option<BodyId>| match body {
            Some(body) => self.velocity_on_body(point, body),
            None => self.velocity(point),
        };
        let striking = of(contact.point, contact.body)?;
        let struck = match &contact.against {
            Against::Fixed => [HyperDual::ZERO; 3],
            Against::Point(point, body) => of(*point, *body)?,
            Against::Body(body) => self.velocity_on_body(contact.point, *body)?,
            Against::Velocity(value) => self.vector(value, Level::Motion)?,
        };
        Ok(sub(striking, struck))
    }

    /// Left side less right side of an equation: one number, or three along N's axes.
    pub fn residual(&self, equation: &Equation, level: Level) -> Result<Vec<HyperDual>, Failure> {
        match &equation.sides {
            EquationSides::Scalar(l, r) => Ok(vec![self.scalar(l, level)? - self.scalar(r, level)?]),
            EquationSides::Vector(l, r) => Ok(sub(self.vector(l, level)?, self.vector(r, level)?).to_vec()),
        }
    }

    /// A point, if a place is needed for a message.
    pub fn span_of(&self, point: PointId) -> Span {
        self.m.points[point.0].span
    }
}

/// Right-handed rotation about a unit vector.
fn about(axis: Triple, angle: HyperDual) -> Matrix3 {
    let (s, c) = (angle.sin(), angle.cos());
    let [x, y, z] = axis;
    let rest = HyperDual::ONE - c;
    [
        [c + rest * x * x, rest * x * y - s * z, rest * x * z + s * y],
        [rest * y * x + s * z, c + rest * y * y, rest * y * z - s * x],
        [rest * z * x - s * y, rest * z * y + s * x, c + rest * z * z],
    ]
}
