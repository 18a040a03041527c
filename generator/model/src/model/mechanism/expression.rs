//! Scalar and vector expressions with all names resolved, and the indices that stand for the names.

use crate::arithmetic::Function;
use crate::number::Number;
use crate::span::Span;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub usize);
    )*};
}

ids! {
    /// Index into [`Mechanism::parameters`](super::Mechanism::parameters).
    ParameterId,
    /// Index into [`Mechanism::inputs`](super::Mechanism::inputs).
    InputId,
    /// Index into [`Mechanism::coordinates`](super::Mechanism::coordinates).
    CoordinateId,
    /// Index into [`Mechanism::speeds`](super::Mechanism::speeds).
    SpeedId,
    /// Index into [`Mechanism::definitions`](super::Mechanism::definitions).
    DefinitionId,
    /// Index into [`Mechanism::frames`](super::Mechanism::frames); 0 is N.
    FrameId,
    /// Index into [`Mechanism::points`](super::Mechanism::points); 0 is O.
    PointId,
    /// Index into [`Mechanism::bodies`](super::Mechanism::bodies).
    BodyId,
    /// Index into [`Mechanism::shapes`](super::Mechanism::shapes).
    ShapeId,
}

impl FrameId {
    /// The inertial frame N.
    pub const N: FrameId = FrameId(0);
}

impl PointId {
    /// The point O, fixed in N.
    pub const O: PointId = PointId(0);
}

/// A scalar expression.
#[derive(Clone, Debug)]
pub enum Scalar {
    /// an exact number
    Number(Number),
    /// pi
    Pi,
    /// time, s
    Time,
    /// a parameter that is not fixed
    Parameter(ParameterId),
    /// an input
    Input(InputId),
    /// a coordinate
    Coordinate(CoordinateId),
    /// a speed
    Speed(SpeedId),
    /// a scalar definition
    Definition(DefinitionId),
    /// time derivative of an expression free of speeds
    Rate(Box<Scalar>),
    /// opposite
    Neg(Box<Scalar>),
    /// sum
    Add(Vec<Scalar>),
    /// product
    Mul(Vec<Scalar>),
    /// quotient, and where it stands (for messages about a vanishing divisor)
    Div(Box<Scalar>, Box<Scalar>, Span),
    /// power
    Pow(Box<Scalar>, Box<Scalar>),
    /// a function of one or two scalars
    Call(Function, Vec<Scalar>),
    /// dot product
    Dot(Box<Vector>, Box<Vector>),
    /// magnitude
    Norm(Box<Vector>),
}

/// A vector expression.
#[derive(Clone, Debug)]
pub enum Vector {
    /// the zero vector
    Zero,
    /// components along the axes of a frame
    Components(FrameId, Box<[Scalar; 3]>),
    /// a vector definition
    Definition(DefinitionId),
    /// opposite
    Neg(Box<Vector>),
    /// sum
    Add(Vec<Vector>),
    /// scalar times vector
    Scale(Box<Scalar>, Box<Vector>),
    /// cross product
    Cross(Box<Vector>, Box<Vector>),
    /// unit vector along, and where it stands
    Unit(Box<Vector>, Span),
    /// position of one point from another
    Position {
        /// to this point
        of: PointId,
        /// from this point
        from: PointId,
    },
    /// velocity of a point in N
    Velocity(PointId),
    /// angular velocity of a frame in another
    AngularVelocity {
        /// of this frame
        of: FrameId,
        /// in this frame
        in_frame: FrameId,
    },
}
