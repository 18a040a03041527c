//! Explanations of E030 to E051 and of warnings: units, dimensions, scalars and vectors, speeds.

use super::Explanation;
use crate::diagnostics::codes::*;

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: UNKNOWN_UNIT,
        text: "Units are products and quotients of `kg g m s min h rad deg rev N Pa J W Hz 1`, with SI \
            prefixes and whole powers.",
        wrong: Some("speeds { u1: rpm }"),
        right: Some("speeds { u1: rev/min }"),
    },
    Explanation {
        code: DIMENSION,
        text: "Only quantities of the same dimension can be added, compared or equated, and some values \
            must have a certain dimension: a mass is in kg, an angle in rad. If several uses contradict the \
            unit of a declaration, the declaration is reported, once; if one use contradicts the others, \
            that use is reported. A plain number has no unit, so a length cannot be `0.5`; declare a \
            parameter with a unit (`fixed`, if it need not be changed at run time). Radians count as 1.",
        wrong: Some("points { G = O - l/2*B.y; P = O - 0.5*B.y; }"),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, fixed a: m = 0.5 }\n\
            points { G = O - l/2*B.y; P = O - a*B.y; }",
        ),
    },
    Explanation {
        code: EXPONENT,
        text: "Constant exponents are fractions of at most 100 in size. An exponent that is not constant needs base and \
            exponent to be plain numbers. The dimension of a power must be known when the model is read.",
        wrong: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^q1/12, 0, m*l^2/12] } }"),
        right: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }"),
    },
    Explanation {
        code: NUMBER_RANGE,
        text: "Numbers and constants lie between 1e-300 and 1e300 in size, or are 0, and have at most 60 \
            characters; so must every value at the states at which the model is checked.",
        wrong: Some("parameters { m: kg = 1e999, l: m = 0.5, g: m/s^2 = 9.81 }"),
        right: Some("parameters { m: kg = 1e9, l: m = 0.5, g: m/s^2 = 9.81 }"),
    },
    Explanation {
        code: ZERO_DIVISOR,
        text: "A divisor is the constant 0, with rounding or without, as `sin(pi)` is, or is zero at every state at which \
            the model is checked.",
        wrong: Some("points { G = O - l/(1 - 1)*B.y; P = O - l*B.y; }"),
        right: Some("points { G = O - l/(1 + 1)*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: CONSTANT,
        text: "The value of a declaration consists of numbers, `pi` and functions. A quantity that depends \
            on others belongs to `definitions`. A dependent speed has no value at all: it follows from the \
            constraints.",
        wrong: Some(
            "parameters { m: kg = 1, l: m = 0.5, a: m = l/2, g: m/s^2 = 9.81 }\n\
            points { G = O - a*B.y; P = O - l*B.y; }",
        ),
        right: Some("definitions { a = l/2; }\npoints { G = O - a*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: NEEDS_VALUE,
        text: "A `fixed` parameter is folded into the equations, so it needs a value.",
        wrong: Some("parameters { m: kg = 1, fixed l: m, g: m/s^2 = 9.81 }"),
        right: Some("parameters { m: kg = 1, fixed l: m = 0.5, g: m/s^2 = 9.81 }"),
    },
    Explanation {
        code: SCALAR_VECTOR,
        text: "Scalars and vectors cannot be added, a vector cannot be a divisor, and the products of two \
            vectors are `dot(a, b)` and `cross(a, b)`.",
        wrong: Some("loads { gravity: -g; }"),
        right: Some("loads { gravity: -g*N.y; }"),
    },
    Explanation {
        code: FUNCTION,
        text: "The functions are sin, cos, tan, asin, acos, atan, atan2, sqrt, exp, log, sinh, cosh, tanh, \
            abs, sign, min, max, pow, dot, cross, norm, unit, position, velocity and angular_velocity.",
        wrong: Some("frames { B = N.rotate(z, arctan(q1)); }"),
        right: Some("frames { B = N.rotate(z, atan(q1)); }"),
    },
    Explanation {
        code: NO_AXES,
        text: "A frame made by `spin` has an angular velocity, but its angle is ignorable and not known. \
            Use the axes of the frame that it spins in; give the inertia in that frame too.",
        wrong: Some("frames { B = N.spin(u1*N.z); }\npoints { G = O; P = O - l*N.y; }"),
        right: Some("frames { B = N.rotate(z, q1); }\npoints { G = O; P = O - l*B.y; }"),
    },
    Explanation {
        code: NO_POSITION,
        text: "The position of a point that is given by its velocity is not known relative to O; neither \
            are those of points placed from it. Differences of their positions are known: `position(P, K)`.",
        wrong: Some(
            "points { K: velocity u1*l*B.x; G = K - l/2*B.y; P = K - l*B.y; }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: dot(position(P), -N.x) } }",
        ),
        right: Some(
            "points { K: velocity u1*l*B.x; G = K - l/2*B.y; P = K - l*B.y; }\n\
            contacts { tip { point: P of Rod, normal: -N.x } }",
        ),
    },
    Explanation {
        code: SPEED_DEPENDENT,
        text: "Positions, angles, normals, gaps, masses, inertias, stiffnesses and configuration equations \
            must not depend on speeds, on velocities or on rates of coordinates.",
        wrong: Some("contacts { tip { point: P of Rod, normal: unit(velocity(P)) } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: NOT_LINEAR,
        text: "Constraints, kinematical equations and stated velocities must be linear in speeds and rates \
            of coordinates, as Kane's method requires (simple non-holonomic systems). Speeds cannot be \
            multiplied with each other, nor be divisors.",
        wrong: Some("kinematics { d(q1)/dt = u1^2/u1; }"),
        right: Some("kinematics { d(q1)/dt = u1; }"),
    },
    Explanation {
        code: UNUSED_PARAMETER,
        text: "The parameter enters no equation. It is kept; perhaps another one was meant.",
        wrong: Some("parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, k: N/m = 3 }"),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, k: N/m = 3 }\n\
            loads { gravity: -g*N.y; force on P: -k*l*N.x; }",
        ),
    },
    Explanation {
        code: UNUSED_INPUT,
        text: "The input enters no equation.",
        wrong: Some("inputs { F: N }"),
        right: Some("inputs { F: N }\nloads { gravity: -g*N.y; force on P: F*N.x; }"),
    },
    Explanation {
        code: UNUSED_DEFINITION,
        text: "Nothing refers to the definition.",
        wrong: Some("definitions { h = l/2; }"),
        right: Some("definitions { h = l/2; }\npoints { G = O - h*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: UNCHECKED,
        text: "Some mistakes are found only by evaluating the model at some states: inertias that no body \
            has, constraints that determine nothing, normals that are not unit vectors. They are not looked \
            for in a mechanism of more than 8000 points, frames, definitions, bodies and contacts together, \
            because it would take too long.",
        wrong: None,
        right: None,
    },
    Explanation {
        code: NOT_CLOSED,
        text: "With the values of the model the configuration equations have no solution near the initial \
            values, where dependent coordinates are guesses: a link is too short, or a guess is far away. \
            Other parameters or guesses may close the loop, so it is no error; where it is certain that no \
            coordinates satisfy an equation with the values of the model, that is the error E079.",
        wrong: Some(
            "mechanism Slider;\n\
            parameters { m: kg = 1, a: m = 1, b: m = 0.2 }\n\
            coordinates { q1: rad = 1.5, dependent q2: m = 0.5 }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: m/s }\n\
            frames { A = N.rotate(z, q1); }\n\
            points { P = O + a*A.x; S = O + q2*N.x; }\n\
            particles { Pin { point: P, mass: m }, Block { point: S, mass: m } }\n\
            constraints { dot(velocity(P, S), position(P, S)) = 0; }\n\
            configuration { dot(position(P, S), position(P, S)) = b^2; }",
        ),
        right: Some(
            "mechanism Slider;\n\
            parameters { m: kg = 1, a: m = 1, b: m = 2 }\n\
            coordinates { q1: rad = 1.5, dependent q2: m = 1.8 }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: m/s }\n\
            frames { A = N.rotate(z, q1); }\n\
            points { P = O + a*A.x; S = O + q2*N.x; }\n\
            particles { Pin { point: P, mass: m }, Block { point: S, mass: m } }\n\
            constraints { dot(velocity(P, S), position(P, S)) = 0; }\n\
            configuration { dot(position(P, S), position(P, S)) = b^2; }",
        ),
    },
];
