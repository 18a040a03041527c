//! A mechanism with all names resolved: the result of reading a model, and the input of the derivation.
//!
//! Invariants that the front end guarantees: ids are in range; definitions, frames and points are acyclic;
//! dimensions agree; every expression is in SI units (a symbol declared in another unit appears multiplied by
//! its factor); constraints are linear in the speeds and kinematical equations linear in rates and speeds;
//! normals and gaps are free of speeds; nothing that is differentiated depends on inputs. `kinematics` holds
//! the stated equations and, last, `d(q..)/dt = u..` for the coordinates of whose rates nothing else speaks;
//! what declared velocities imply is not repeated there. Names refer to names in chains of at most 600,
//! and expressions are nested a few hundred deep at most, so recursion over them is safe.

mod expression;
mod shape;

pub use expression::*;
pub use shape::*;

use crate::span::Span;

/// A mechanism, resolved and checked.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// its name as spelled
    pub name: String,
    /// its documentation, lines joined by newlines
    pub docs: String,
    /// parameters in file order
    pub parameters: Vec<Variable>,
    /// inputs in file order
    pub inputs: Vec<Variable>,
    /// coordinates in file order
    pub coordinates: Vec<Variable>,
    /// independent speeds in file order, then dependent ones in file order
    pub speeds: Vec<Variable>,
    /// named subexpressions
    pub definitions: Vec<Definition>,
    /// frames; the first is N
    pub frames: Vec<Frame>,
    /// points; the first is O
    pub points: Vec<Point>,
    /// bodies in file order, then particles in file order
    pub bodies: Vec<Body>,
    /// what acts on the mechanism
    pub loads: Vec<Load>,
    /// kinematical equations
    pub kinematics: Vec<Equation>,
    /// velocity constraints
    pub constraints: Vec<Equation>,
    /// where `constraints` say more at arbitrary states than there are dependent speeds, and just as much
    /// wherever the loops are closed: scalar equations among them that determine the dependent speeds
    pub determining_constraints: Option<Vec<Equation>>,
    /// configuration constraints
    pub configuration: Vec<Equation>,
    /// contacts in file order; those of a pair of shapes one after another
    pub contacts: Vec<Contact>,
    /// shapes in file order: equations know them by what they give to contacts and bodies
    pub shapes: Vec<Shape>,
}

impl Mechanism {
    /// The velocity constraints that determine the dependent speeds; others follow from them wherever the
    /// loops are closed.
    pub fn constraints_of_dependent_speeds(&self) -> &[Equation] {
        self.determining_constraints.as_deref().unwrap_or(&self.constraints)
    }

    /// Number of independent coordinates and speeds: the states of the linearised equations.
    pub fn independent_states(&self) -> usize {
        self.coordinates.iter().chain(&self.speeds).filter(|quantity| !quantity.dependent).count()
    }
}

/// A parameter, input, coordinate or speed.
#[derive(Clone, Debug)]
pub struct Variable {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// unit as written, for instance `kg*m^2`
    pub unit: String,
    /// value or initial value in that unit, if one is given; unless it is `fixed`, equations do not depend
    /// on it
    pub value: Option<f64>,
    /// how the model states its initial value, where that follows from other quantities: `value` is the number
    /// with the values of the model
    pub initial: Option<Initial>,
    /// a size that such a quantity commonly has, in that unit; all quantities of a unit have the same
    pub typical: f64,
    /// one of that unit, counted in SI units: numerical checks compare equations after multiplying by it
    pub factor: f64,
    /// `fixed` (of a parameter): its value is folded in and it does not exist at run time. In expressions it
    /// appears as its number; it is kept here so that callers can refer to it by name.
    pub fixed: bool,
    /// `dependent` (of a coordinate or a speed)
    pub dependent: bool,
    /// where it is declared
    pub span: Span,
}

/// An initial value that follows from other quantities.
#[derive(Clone, Debug)]
pub enum Initial {
    /// a value in SI units, of numbers, parameters, coordinates and speeds alone
    Expression {
        /// the value
        value: Scalar,
        /// where it stands
        span: Span,
    },
    /// the value, near a guess in the unit of the coordinate, at which the gap of a contact is 0
    Touching {
        /// which contact
        contact: usize,
        /// the guess
        guess: f64,
        /// where it stands
        span: Span,
    },
}

impl Initial {
    /// Where it stands.
    pub fn span(&self) -> Span {
        match self {
            Initial::Expression { span, .. } | Initial::Touching { span, .. } => *span,
        }
    }
}

/// A named subexpression.
#[derive(Clone, Debug)]
pub struct Definition {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// what it stands for
    pub value: DefinitionValue,
    /// an expression of shapes, of which others are made: the terms of a divisor, with which it is compared, are as
    /// large as their values
    pub of_shapes: bool,
    /// where it is declared
    pub span: Span,
}

/// What a definition stands for.
#[derive(Clone, Debug)]
pub enum DefinitionValue {
    /// a scalar
    Scalar(Scalar),
    /// a vector
    Vector(Vector),
}

/// An axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

/// A frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// the frame it is oriented in; `None` for N alone. Never a frame made by `spin`.
    pub parent: Option<FrameId>,
    /// how it is oriented in its parent
    pub orientation: Orientation,
    /// the declared angular velocity: in which frame, and what it is
    pub angular_velocity: Option<(FrameId, Vector)>,
    /// where it is declared
    pub span: Span,
    /// where its orientation is stated; of a rotation about a vector, where the vector stands
    pub orientation_span: Span,
    /// where its angular velocity is stated; else where it is declared
    pub motion_span: Span,
}

/// How a frame is oriented in its parent.
#[derive(Clone, Debug)]
pub enum Orientation {
    /// the same axes
    Aligned,
    /// right-handed simple rotation about an axis of the parent, negated if `negative`
    Simple {
        /// the axis
        axis: Axis,
        /// rotation about the opposite of the axis
        negative: bool,
        /// the angle, rad
        angle: Scalar,
    },
    /// right-handed rotation about a unit vector with these components in the parent
    About {
        /// components of the unit vector
        axis: Box<[Scalar; 3]>,
        /// the angle, rad
        angle: Scalar,
    },
    /// three rotations about the new axes (`body`) or about the parent's (`space`)
    Euler {
        /// the axes, in order
        axes: [Axis; 3],
        /// the angles, in order, rad
        angles: Box<[Scalar; 3]>,
        /// about the new axes; else about the parent's
        body_fixed: bool,
    },
    /// unit quaternion, scalar part first
    Quaternion([CoordinateId; 4]),
    /// no orientation: the angle is ignorable, and this is the angular velocity in the parent
    Spin(Vector),
}

/// A point.
#[derive(Clone, Debug)]
pub struct Point {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// how its position or velocity is known
    pub place: Place,
    /// declared velocity in N
    pub velocity: Option<Vector>,
    /// where it is declared
    pub span: Span,
    /// where its velocity is stated; else where it is declared
    pub motion_span: Span,
}

/// How a point's position or velocity is known.
#[derive(Clone, Debug)]
pub enum Place {
    /// O itself
    Origin,
    /// position from another point; velocity by differentiation
    Offset {
        /// the other point
        from: PointId,
        /// the position from there
        by: Vector,
    },
    /// as `Offset`, but a material point of `frame`, as `from` is: velocity by the rigid-body rule
    Material {
        /// the frame of which it is a point
        frame: FrameId,
        /// the other point
        from: PointId,
        /// the position from there
        by: Vector,
    },
    /// only the velocity in N is known
    Velocity(Vector),
}

/// A rigid body, or a particle (without frame).
#[derive(Clone, Debug)]
pub struct Body {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// the frame fixed in it; `None`: a particle
    pub frame: Option<FrameId>,
    /// its mass centre
    pub centre: PointId,
    /// its mass, kg
    pub mass: Scalar,
    /// where the mass is stated
    pub mass_span: Span,
    /// its inertia; `None`: a particle
    pub inertia: Option<Inertia>,
    /// where it is declared
    pub span: Span,
}

/// Inertia of a body.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// xx, yy, zz, xy, yz, zx of the inertia matrix (products with a plus sign), kg m^2
    pub components: Box<[Scalar; 6]>,
    /// the frame of the components
    pub frame: FrameId,
    /// the point it is about; `None`: the mass centre
    pub about: Option<PointId>,
    /// where it is stated
    pub span: Span,
}

/// What acts on the mechanism.
#[derive(Clone, Debug)]
pub struct Load {
    /// what it is
    pub kind: LoadKind,
    /// whether it has a potential energy: `-m g . r` of gravity, `k s^2/2` of a spring stretched by s. Not where
    /// minus the gradient of these is another force, and not of forces and torques.
    pub potential: bool,
    /// where the points or frames are named on which it acts, in the order of its kind
    pub ends: Vec<Span>,
    /// where it is declared
    pub span: Span,
}

/// The kinds of load.
#[derive(Clone, Debug)]
pub enum LoadKind {
    /// acceleration of gravity, on all bodies and particles
    Gravity(Vector),
    /// a force at a point, with its opposite at another
    Force {
        /// where it acts
        on: PointId,
        /// where its opposite acts
        from: Option<PointId>,
        /// the force, N
        force: Vector,
    },
    /// a torque on a frame, with its opposite on another
    Torque {
        /// where it acts
        on: FrameId,
        /// where its opposite acts
        from: Option<FrameId>,
        /// the torque, N m
        torque: Vector,
    },
    /// a spring and damper along the line of two points
    Spring {
        /// one end
        a: PointId,
        /// other end
        b: PointId,
        /// N/m
        stiffness: Scalar,
        /// m
        length: Scalar,
        /// N s/m
        damping: Scalar,
    },
    /// a torsional spring and damper
    Torsion {
        /// where it acts
        on: FrameId,
        /// where its opposite acts
        from: Option<FrameId>,
        /// unit vector
        axis: Vector,
        /// rad
        angle: Scalar,
        /// where the angle is stated
        angle_span: Span,
        /// rad
        rest: Scalar,
        /// N m/rad
        stiffness: Scalar,
        /// N m s/rad
        damping: Scalar,
    },
}

/// An equation between scalars or vectors.
#[derive(Clone, Debug)]
pub struct Equation {
    /// the two sides
    pub sides: EquationSides,
    /// where it stands
    pub span: Span,
}

/// The two sides of an equation.
#[derive(Clone, Debug)]
pub enum EquationSides {
    /// left = right
    Scalar(Scalar, Scalar),
    /// left = right
    Vector(Vector, Vector),
}

/// A contact.
#[derive(Clone, Debug)]
pub struct Contact {
    /// name as spelled
    pub name: String,
    /// documentation
    pub docs: String,
    /// the point P that strikes
    pub point: PointId,
    /// the body it belongs to, if said
    pub body: Option<BodyId>,
    /// what is struck
    pub against: Against,
    /// unit vector n from what is struck to what strikes
    pub normal: Vector,
    /// where the point is named
    pub point_span: Span,
    /// where it is said what is struck; else where the contact is declared
    pub against_span: Span,
    /// where the normal is stated
    pub normal_span: Span,
    /// distance, m
    pub gap: Option<Scalar>,
    /// whether the model says that there is none, `gap: none`
    pub without_gap: bool,
    /// how far the place of contact is within the faces and edges that touch there, m; none where these do not end
    pub validity: Option<Scalar>,
    /// the first tangent, a unit vector across the normal; none where the derivation chooses one
    pub tangent: Option<Vector>,
    /// a bound from below on how far its two shapes are apart, m: while it is positive none of their contacts touches;
    /// only the first of many contacts of a pair has it
    pub clearance: Option<Scalar>,
    /// the number of the contact that has the clearance of the same two shapes
    pub first_of_pair: Option<usize>,
    /// where the gap is stated; else where the contact is declared
    pub gap_span: Span,
    /// friction and restitution, where the model states them
    pub surface: Option<Surface>,
    /// what the surface does beyond these
    pub law: ContactLaw,
    /// the two shapes from which point, normal and gap follow
    pub shapes: Option<[ShapeId; 2]>,
    /// the frames in which what strikes and what is struck are fixed, where the surface states friction of their
    /// relative rotation
    pub turning: Option<[FrameId; 2]>,
    /// where it is declared
    pub span: Span,
}

impl Contact {
    /// Whether it is one of the dozens of a pair with edges, such as two boxes: these have no methods and no derivatives of their
    /// own, and generated modules reach them by number.
    pub fn is_one_of_many(&self) -> bool {
        self.tangent.is_some()
    }
}

/// Friction and restitution of a contact. They are defaults of the tool and of the module: equations do not
/// depend on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Coulomb's coefficient of friction, not negative
    pub mu: f64,
    /// coefficient of restitution, from 0 to 1
    pub e: f64,
    /// the hypothesis of restitution: a word of [`crate::words::LAWS`]
    pub law: &'static str,
}

impl Surface {
    /// What is left out of a surface is this: without friction, without rebound.
    pub const PLAIN: Surface = Surface { mu: 0.0, e: 0.0, law: "poisson" };
    /// The greatest coefficient of friction that a model may state: motions take squares of it.
    pub const MOST_FRICTION: f64 = 1e100;
}

/// What a surface does beyond one coefficient of friction and one of restitution. Simulations read it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactLaw {
    /// static coefficient of friction, not less than mu
    pub mu_static: Option<f64>,
    /// coefficient of friction in impacts, not negative
    pub mu_impact: Option<f64>,
    /// sliding friction as a function of the speed of slip
    pub sliding: Option<Named>,
    /// restitution as a function of the speed of approach
    pub restitution: Option<Named>,
    /// lever arm of rolling friction, m, not negative
    pub rolling: Option<f64>,
    /// lever arm of spinning friction, m, not negative
    pub spinning: Option<f64>,
}

impl ContactLaw {
    /// Whether it asks for the relative rotation of the two bodies.
    pub fn asks_for_rotation(&self) -> bool {
        self.rolling.is_some() || self.spinning.is_some()
    }
}

/// A law by its name, and its numbers in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// in lower case, as in models
    pub name: String,
    /// speeds, exponents, coefficients
    pub numbers: Vec<f64>,
}

impl Named {
    /// The laws of sliding friction.
    pub const SLIDING: &'static str = "constant or stribeck(SPEED)";
    /// The laws of restitution.
    pub const RESTITUTION: &'static str = "constant, threshold(SPEED), power(SPEED, EXPONENT), loss(SPEED, EXPONENT) or table(SPEED, E, SPEED, E, ..)";
}

/// What a contact strikes.
#[derive(Clone, Debug)]
pub enum Against {
    /// a point fixed in N
    Fixed,
    /// a named point P', of a body if said
    Point(PointId, Option<BodyId>),
    /// the material point of a body that coincides with P
    Body(BodyId),
    /// a surface with this velocity in N
    Velocity(Vector),
}
