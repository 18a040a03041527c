//! Explanations of E052 to E082 and W006: frames, points, bodies, loads, equations, contacts.

use super::Explanation;
use crate::diagnostics::codes::*;

const SLED: &str = "mechanism Sled;
parameters { m: kg = 1, J: kg*m^2 = 0.5, a: m = 0.3 }
coordinates { q1: m, q2: m, q3: rad }
speeds { u1: m/s, u3: rad/s }
dependent { u2: m/s }
frames { B = N.rotate(z, q3); }
points { G = O + q1*N.x + q2*N.y; K = G - a*B.x; }
velocities { G = u1*B.x + u2*B.y; }
bodies { Body { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
constraints { dot(velocity(K), B.y) = 0; }";

const LOOP: &str = "mechanism Slider;
parameters { m: kg = 1, l: m = 1 }
coordinates { q1: rad = 1, dependent q2: m = 0.5 }
speeds { u1: rad/s }
dependent { u2: m/s }
frames { A = N.rotate(z, q1); }
points { E = O + l*A.x; S = O + q2*N.x; }
particles { End { point: E, mass: m }, Slide { point: S, mass: m } }
constraints { dot(velocity(E), N.x) = u2; }
configuration { dot(position(E), N.x) = q2; }";

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: FRAME,
        text: "A frame is the same as another, or comes from it by rotate, euler, space, quaternion or \
            spin. An axis is `x`, `y`, `z`, the opposite of one of these, or `[a, b, c]` with the length 1.",
        wrong: Some("frames { B = N.rotate([0, 0, 2], q1); }"),
        right: Some("frames { B = N.rotate([0, 0, 1], q1); }"),
    },
    Explanation {
        code: QUATERNION,
        text: "A quaternion is made of four different coordinates with the unit 1, the scalar part first. \
            Their rates follow from the angular velocity, which must be stated under `angular_velocities`.",
        wrong: Some(
            "mechanism Top;\n\
            parameters { J: kg*m^2 = 1, m: kg = 1 }\n\
            coordinates { e0: 1 = 1, e1: 1, e2: 1, e3: 1 }\n\
            speeds { u1: rad/s, u2: rad/s, u3: rad/s }\n\
            frames { B = N.quaternion(e0, e1, e2, e3); }\n\
            bodies { Top { frame: B, centre: O, mass: m, inertia: [J, J, J] } }",
        ),
        right: Some(
            "mechanism Top;\n\
            parameters { J: kg*m^2 = 1, m: kg = 1 }\n\
            coordinates { e0: 1 = 1, e1: 1, e2: 1, e3: 1 }\n\
            speeds { u1: rad/s, u2: rad/s, u3: rad/s }\n\
            frames { B = N.quaternion(e0, e1, e2, e3); }\n\
            angular_velocities { B = u1*B.x + u2*B.y + u3*B.z; }\n\
            bodies { Top { frame: B, centre: O, mass: m, inertia: [J, J, J] } }",
        ),
    },
    Explanation {
        code: POINT,
        text: "A position is another point plus a vector. Points are not added or subtracted; the vector \
            from Q to P is `position(P, Q)`. In `P of B = Q + ..` Q must move with B: it is the mass centre \
            of B, a hinge, or another point of B. The velocity of a mass centre must be the rate of its position.",
        wrong: Some("points { G = -l/2*B.y; P = O - l*B.y; }"),
        right: Some("points { G = O - l/2*B.y; P = O - l*B.y; }"),
    },
    Explanation {
        code: MOTION_TWICE,
        text: "A velocity or angular velocity is stated once.",
        wrong: Some("angular_velocities { B = u1*B.z; B in N = u1*N.z; }"),
        right: Some("angular_velocities { B = u1*B.z; }"),
    },
    Explanation {
        code: INPUT_MOVES,
        text: "The value of an input is given, but not its rate. So nothing whose rate is needed may depend \
            on an input: no position, no orientation, nothing in `d( )/dt`. Prescribe motion as a function \
            of `time` and parameters, or make it a coordinate and give its speed.",
        wrong: Some("inputs { a: m }\npoints { G = O - l/2*B.y; P = O - (l + a)*B.y; }"),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, a: m = 0.1, w: rad/s = 3 }\n\
            points { G = O - l/2*B.y; P = O - (l + a*sin(w*time))*B.y; }",
        ),
    },
    Explanation {
        code: BODY,
        text: "A body has a frame, a centre, a mass and an inertia; a particle has a point and a mass.",
        wrong: Some("bodies { Rod { frame: B, centre: G, inertia: [m*l^2/12, 0, m*l^2/12] } }"),
        right: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }"),
    },
    Explanation {
        code: MASS,
        text: "Masses are positive and depend on parameters only. Where all parameters have values the mass \
            is checked with them.",
        wrong: Some(
            "bodies { Rod { frame: B, centre: G, mass: m*cos(q1), inertia: [m*l^2/12, 0, m*l^2/12] } }",
        ),
        right: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }"),
    },
    Explanation {
        code: INERTIA,
        text: "An inertia has three or six components, constant in their frame. About the mass centre no \
            principal moment exceeds the sum of the two others, for moments of inertia are sums of squares \
            of distances. Products enter with a plus sign.",
        wrong: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/3] } }"),
        right: Some("bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }"),
    },
    Explanation {
        code: LOAD,
        text: "A load and its opposite act on two different things. Loads are `gravity: g`, `force on P: \
            F`, `force on P from Q: F`, `torque on B: T`, `torque on B from A: T`, `spring P to Q: { .. }` \
            and `torsion B from A about v: { .. }`.",
        wrong: Some("loads { gravity: -g*N.y; force P: m*g*N.x; }"),
        right: Some("loads { gravity: -g*N.y; force on P: m*g*N.x; }"),
    },
    Explanation {
        code: CONSTRAINT_COUNT,
        text: "There must be as many independent constraints as dependent speeds. A vector equation counts \
            as its components that are not identically zero. More constraints are allowed in a loop with a \
            `configuration`, if they agree at every closed configuration for all values of the parameters \
            that are not `fixed`.",
        wrong: Some("speeds { u1: rad/s }\ndependent { u2: rad/s }"),
        right: Some(SLED),
    },
    Explanation {
        code: CONSTRAINT_SINGULAR,
        text: "The constraints are as many as the dependent speeds but do not determine them, at any state: \
            one of them does not occur, or occurs only in combination with another. Declare other speeds \
            dependent.",
        wrong: Some(
            "mechanism Sled;\n\
            parameters { m: kg = 1, J: kg*m^2 = 0.5, a: m = 0.3 }\n\
            coordinates { q1: m, q2: m, q3: rad }\n\
            speeds { u1: m/s, u3: rad/s }\n\
            dependent { u2: m/s }\n\
            frames { B = N.rotate(z, q3); }\n\
            points { G = O + q1*N.x + q2*N.y; K = G - a*B.x; }\n\
            velocities { G = u1*B.x + u2*B.y; }\n\
            bodies { Body { frame: B, centre: G, mass: m, inertia: [J, J, J] } }\n\
            constraints { dot(velocity(K), B.x) = 0; }",
        ),
        right: Some(SLED),
    },
    Explanation {
        code: CONFIGURATION_COUNT,
        text: "There must be as many configuration equations as coordinates marked `dependent`.",
        wrong: Some("coordinates { dependent q1: rad }"),
        right: Some(LOOP),
    },
    Explanation {
        code: NO_RATE,
        text: "The rates of all coordinates must follow from the speeds. For a coordinate `q3` whose rate \
            occurs in no equation, `d(q3)/dt = u3` is assumed if there is a speed `u3`; others need an \
            equation under `kinematics`.",
        wrong: Some("coordinates { phi: rad }\nframes { B = N.rotate(z, phi); }"),
        right: Some(
            "coordinates { phi: rad }\nframes { B = N.rotate(z, phi); }\nkinematics { d(phi)/dt = u1; }",
        ),
    },
    Explanation {
        code: KINEMATICS_SINGULAR,
        text: "There are equations for the rates of the coordinates, but they do not determine them at any \
            state: two of them are equivalent.",
        wrong: Some(
            "mechanism Point;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m, q2: m }\n\
            speeds { u1: m/s, u2: m/s }\n\
            points { P = O + q1*N.x + q2*N.y; }\n\
            particles { Point { point: P, mass: m } }\n\
            kinematics { d(q1)/dt + d(q2)/dt = u1; 2*d(q1)/dt + 2*d(q2)/dt = 2*u1; }",
        ),
        right: Some(
            "mechanism Point;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m, q2: m }\n\
            speeds { u1: m/s, u2: m/s }\n\
            points { P = O + q1*N.x + q2*N.y; }\n\
            particles { Point { point: P, mass: m } }\n\
            kinematics { d(q1)/dt + d(q2)/dt = u1; d(q1)/dt - d(q2)/dt = u2; }",
        ),
    },
    Explanation {
        code: INCONSISTENT,
        text: "A stated velocity or angular velocity contradicts the stated position or orientation, or two \
            equations give different rates for one coordinate.",
        wrong: Some(
            "mechanism Point;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            velocities { P = u1*N.y; }\n\
            particles { Point { point: P, mass: m } }",
        ),
        right: Some(
            "mechanism Point;\n\
            parameters { m: kg = 1 }\n\
            coordinates { q1: m }\n\
            speeds { u1: m/s }\n\
            points { P = O + q1*N.x; }\n\
            velocities { P = u1*N.x; }\n\
            particles { Point { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: NO_INERTIA,
        text: "The mass matrix is singular at every state: some speed moves nothing that has mass or \
            inertia, or two speeds cause the same motion.",
        wrong: Some(
            "coordinates { q1: rad, q2: rad }\n\
            speeds { u1: rad/s, u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = B.rotate(x, q2); }\n\
            points { G = O - l/2*B.y; P = O - l*C.y; }",
        ),
        right: Some(
            "coordinates { q1: rad, q2: rad }\n\
            speeds { u1: rad/s, u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = B.rotate(x, q2); }\n\
            points { G = O - l/2*B.y; P = O - l*C.y; }\n\
            particles { Tip { point: P, mass: m } }",
        ),
    },
    Explanation {
        code: EMPTY_EQUATION,
        text: "A constraint or kinematical equation must contain speeds or rates; a configuration equation \
            must contain coordinates; and neither may hold in every state, as `u1 = u1` does.",
        wrong: Some("kinematics { d(q1)/dt = u1; q1 = 0; }"),
        right: Some("kinematics { d(q1)/dt = u1; }"),
    },
    Explanation {
        code: NOT_KEPT,
        text: "A closed loop is stated twice: by positions under `configuration`, from which consistent \
            coordinates are computed, and by velocities under `constraints`, which the equations of motion \
            need. The rate of each configuration equation must follow from the constraints (and the \
            kinematical equations) wherever the loops are closed. Here it does not: the motion would leave \
            the configuration at once. The message says what decided: exact arithmetic where the configuration \
            equations can be solved by symbols, which sees every difference; numbers at closed states else, \
            which see differences above 1e-7 of the terms. Look for a sign, a factor or a point that differs, for a term with \
            `time` on one side only, or for a constraint that is missing.",
        wrong: Some(
            "coordinates { q1: rad, dependent q2: rad }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { u2 = -2*u1; }\n\
            configuration { q2 = 2*q1; }",
        ),
        right: Some(
            "coordinates { q1: rad, dependent q2: rad }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { u2 = 2*u1; }\n\
            configuration { q2 = 2*q1; }",
        ),
    },
    Explanation {
        code: NO_CONFIGURATION,
        text: "The residual of a configuration equation is bounded over all coordinates and times, with the \
            parameters of the model, and the bounds do not hold 0: a square is asked to be negative, or a link \
            to reach farther than it is long. Bounds are wider than need be where terms depend on each other; \
            where they tell nothing and no solution is found near the initial values, the warning W005 says so.",
        wrong: Some(
            "coordinates { q1: rad, dependent q2: rad }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { cos(q2)*u2 = -sin(q1)*u1; }\n\
            configuration { sin(q2) = cos(q1) + 3; }",
        ),
        right: Some(
            "coordinates { q1: rad = 0.5, dependent q2: rad = 1 }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { cos(q2)*u2 = -sin(q1)*u1; }\n\
            configuration { sin(q2) = cos(q1); }",
        ),
    },
    Explanation {
        code: NORMAL,
        text: "A normal must have the length 1. `unit(v)` is the unit vector along v.",
        wrong: Some("contacts { tip { point: P of Rod, normal: -N.x + N.y } }"),
        right: Some("contacts { tip { point: P of Rod, normal: unit(-N.x + N.y) } }"),
    },
    Explanation {
        code: CONTACT_STILL,
        text: "The point never moves relative to what it strikes: it may be a point of the body that is \
            struck, or be fixed in N.",
        wrong: Some("contacts { tip { point: P of Rod, against: Rod, normal: -N.x } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: NEVER_APPROACHES,
        text: "The point moves relative to what it strikes, but never along the normal: no impact can \
            happen. Check the normal.",
        wrong: Some("contacts { tip { point: P of Rod, normal: N.z } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: CONTACT,
        text: "What is struck is a point (`against: Q` or `against: Q of Body`), the material point of a \
            body that coincides with P (`against: Body`), a point of a frame that carries no body \
            (`against: Frame`, turning about O, or `against: Frame about Q`), or a surface with a velocity \
            (`against: velocity v`). Left out, it is a point fixed in N. Two points of one body never meet. A gap that is the same in all \
            states is that of no contact.",
        wrong: Some("contacts { tip { point: P of Rod, against: N, normal: -N.x } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
    },
    Explanation {
        code: SURFACE,
        text: "The surface of a contact holds its friction and restitution: `mu`, not negative and at most 1e100, `e`, from 0 \
            to 1, and `law`, one of newton, poisson and stronge, each a constant. Motions also read `mu_static`, \
            not less than mu, `mu_impact`, `sliding: stribeck(SPEED)`, which needs `mu_static`, and \
            `restitution`, one of threshold(SPEED), power(SPEED, EXPONENT), loss(SPEED, EXPONENT) and \
            table(SPEED, E, SPEED, E, ..), and `rolling` and `spinning`, lengths in m, not negative. What is left out is mu = 0, e = 0, law = poisson. The tool takes these where the command line does not say otherwise, and \
            says so; equations do not depend on them, but that `rolling` and \
            `spinning` ask for the relative rotation of the two bodies.",
        wrong: Some(
            "contacts { tip { point: P of Rod, normal: -N.x, gap: l - dot(position(P), N.x), surface: { mu: -0.3, \
            e: 0.5, law: stronge } } }",
        ),
        right: Some(
            "contacts { tip { point: P of Rod, normal: -N.x, gap: l - dot(position(P), N.x), surface: { mu: 0.3, \
            e: 0.5, law: stronge } } }",
        ),
    },
    Explanation {
        code: START,
        text: "`touching(contact)` as the initial value of a coordinate is the value at which the gap of that \
            contact is 0, near a guess (0, or the number that stands after the contact). It is of an \
            independent coordinate on which the gap depends, each contact is named once, and there must be \
            such a value near the guess.",
        wrong: Some(
            "coordinates { q1: rad = touching(tip) }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: 2*l - dot(position(P), N.x) } }",
        ),
        right: Some(
            "coordinates { q1: rad = touching(tip, 0.5) }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: l/2 - dot(position(P), N.x) } }",
        ),
    },
];
