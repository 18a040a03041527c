//! Explanations of warnings of models that can be solved, but probably do not say what their author means.

use super::Explanation;
use crate::diagnostics::codes::*;

const BALL: &str = "mechanism Ball;
parameters { m: kg = 1, r: m = 0.1, J: kg*m^2 = 4e-3, g: m/s^2 = 9.81 }
inputs { F: N }
coordinates { q1: m, q2: m = 0.5, q3: rad }
speeds { u1: m/s, u2: m/s, u3: rad/s }
frames { B = N.rotate(z, q3); }
points { G = O + q1*N.x + q2*N.y; C of Ball = G - r*N.y; }
bodies { Ball { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
loads { gravity: -g*N.y; force on C: F*N.x; }
contacts { floor { point: C of Ball, normal: N.y, gap: q2 - r } }";

pub(super) const TABLE: &[Explanation] = &[
    Explanation {
        code: GAP_RATE,
        text: "The gap is the distance along the normal between the point that strikes and what it strikes. \
            Its rate is then the velocity of the point along the normal, and the bodies approach while the \
            gap closes. Here the two differ, even where the gap is closed: the normal points the wrong way, \
            the gap has the wrong sign, or it is that of another point. A simulation would let the bodies \
            pass through each other or stop them in the air.",
        wrong: Some("contacts { tip { point: P of Rod, normal: -N.x, gap: dot(position(P), N.x) + 0.2*l } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x, gap: 0.2*l - dot(position(P), N.x) } }"),
    },
    Explanation {
        code: CONTACT_POINT,
        text: "In `point: P of Body` the velocity of the contact is that of the material point of Body at \
            P. P may wander over the surface of Body, as the lowest point of a wheel does, but here it \
            moves through Body along the normal: P belongs to another body. Without `of` the velocity is \
            that of the geometric point P, which for the lowest point of a wheel does not contain the \
            rotation of the wheel.",
        wrong: Some(
            "coordinates { q1: rad = 0.3, q2: rad }\n\
            speeds { u1: rad/s, u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = B.rotate(z, q2); }\n\
            points { G = O - l/2*B.y; K = O - l*B.y; H = K - l/2*C.y; P = K - l*C.y; }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Fore { frame: \
            C, centre: H, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: l - dot(position(P), N.x) } }",
        ),
        right: Some(
            "coordinates { q1: rad = 0.3, q2: rad }\n\
            speeds { u1: rad/s, u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = B.rotate(z, q2); }\n\
            points { G = O - l/2*B.y; K = O - l*B.y; H = K - l/2*C.y; P = K - l*C.y; }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Fore { frame: \
            C, centre: H, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }\n\
            contacts { tip { point: P of Fore, normal: -N.x, gap: l - dot(position(P), N.x) } }",
        ),
    },
    Explanation {
        code: BEGINS_INSIDE,
        text: "With the initial values of the model the gap of a contact is negative: the body begins \
            inside what it strikes. Either the initial values are wrong or the sign of the gap is.",
        wrong: Some(
            "coordinates { q1: rad = 0.9 }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: 0.2*l - dot(position(P), N.x) } }",
        ),
        right: Some(
            "coordinates { q1: rad = 0.1 }\n\
            contacts { tip { point: P of Rod, normal: -N.x, gap: 0.2*l - dot(position(P), N.x) } }",
        ),
    },
    Explanation {
        code: LOAD_POINT,
        text: "A contact acts on the material point of a body, such as the lowest point of a wheel; a load \
            on the same name acts on the geometric point. That moves differently: the load does not act on \
            the rotation of the body. `C of Body = ..` under `points` makes C a material point of the body.",
        wrong: Some(
            "mechanism Ball;\n\
            parameters { m: kg = 1, r: m = 0.1, J: kg*m^2 = 4e-3, g: m/s^2 = 9.81 }\n\
            inputs { F: N }\n\
            coordinates { q1: m, q2: m = 0.5, q3: rad }\n\
            speeds { u1: m/s, u2: m/s, u3: rad/s }\n\
            frames { B = N.rotate(z, q3); }\n\
            points { G = O + q1*N.x + q2*N.y; C = G - r*N.y; }\n\
            bodies { Ball { frame: B, centre: G, mass: m, inertia: [J, J, J] } }\n\
            loads { gravity: -g*N.y; force on C: F*N.x; }\n\
            contacts { floor { point: C of Ball, normal: N.y, gap: q2 - r } }",
        ),
        right: Some(BALL),
    },
    Explanation {
        code: TORSION_ANGLE,
        text: "A torsion spring acts with the torque -stiffness*(angle - rest) about its axis and stores \
            the energy stiffness*(angle - rest)^2/2. These agree only if the rate of the angle is the \
            angular velocity of the body, relative to that of `from`, about the axis. Here they do not: a \
            wrong sign, another joint's angle, or a wrong axis.",
        wrong: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, k: N*m/rad = 3 }\n\
            loads { gravity: -g*N.y; torsion B about N.z: { angle: -q1, stiffness: k }; }",
        ),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, k: N*m/rad = 3 }\n\
            loads { gravity: -g*N.y; torsion B about N.z: { angle: q1, stiffness: k }; }",
        ),
    },
    Explanation {
        code: NO_EFFECT,
        text: "A force on a point that never moves and a torque on a frame that never turns do nothing. \
            Perhaps another point or body is meant.",
        wrong: Some("loads { gravity: -g*N.y; force on O: m*g*N.x; }"),
        right: Some("loads { gravity: -g*N.y; force on P: m*g*N.x; }"),
    },
    Explanation {
        code: KEPT_BY_VALUES,
        text: "The motion keeps a configuration equation with the values that the parameters have in the \
            model, and does not with others: a number or another parameter stands in the constraints where \
            the configuration has this one. As soon as it is set at run time, the motion leaves the \
            configuration. The message says whether exact arithmetic or numbers at closed states decided.",
        wrong: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, n: 1 = 2 }\n\
            coordinates { q1: rad, dependent q2: rad }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { u2 = 2*u1; }\n\
            configuration { q2 = n*q1; }",
        ),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, n: 1 = 2 }\n\
            coordinates { q1: rad, dependent q2: rad }\n\
            speeds { u1: rad/s }\n\
            dependent { u2: rad/s }\n\
            frames { B = N.rotate(z, q1); C = N.rotate(z, q2); }\n\
            bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] }, Gear { frame: C, \
            centre: O, mass: m, inertia: [m*l^2/9, m*l^2/9, m*l^2/9] } }\n\
            constraints { u2 = n*u1; }\n\
            configuration { q2 = n*q1; }",
        ),
    },
    Explanation {
        code: NO_GAP,
        text: "A simulation sees that a contact closes by its gap, the distance of the point that strikes, \
            along the normal, from what is struck. This contact has none: bodies pass through each other \
            there. A contact whose collisions are computed at \
            given instants alone, where a state says that it closes, has `gap: none`.",
        wrong: Some("contacts { tip { point: P of Rod, normal: -N.x } }"),
        right: Some("contacts { tip { point: P of Rod, normal: -N.x, gap: l - dot(position(P), N.x) } }"),
    },
    Explanation {
        code: NO_START,
        text: "With the initial values something is divided by 0, or is not finite, or the rates are not \
            determined, although this is not so at other states: `eval` and `simulate` cannot begin there \
            unless they are given another state.",
        wrong: Some(
            "coordinates { q1: rad = 0 }\n\
            loads { gravity: -g*N.y; torque on Rod: 0.01*m*g*l/q1*N.z; }",
        ),
        right: Some(
            "coordinates { q1: rad = 0.1 }\n\
            loads { gravity: -g*N.y; torque on Rod: 0.01*m*g*l/q1*N.z; }",
        ),
    },
    Explanation {
        code: NARROW,
        text: "A sphere on a surface or a curve has one contact, where it would first touch if it came down. In a \
            hollow that is more curved than the sphere it touches at several places, of which one contact knows one. \
            The ground is looked at up to 20 radii around the start.",
        wrong: Some(
            "shapes { Knob { of: Rod, at: P, sphere: l/5 }, Wall { at: O - 2*l*N.y, curve: l/10*sin(20*x/l)^2 } }\n\
            contacts { tip { Knob on Wall } }",
        ),
        right: Some(
            "shapes { Knob { of: Rod, at: P, sphere: l/20 }, Wall { at: O - 2*l*N.y, curve: l/10*sin(2*x/l)^2 } }\n\
            contacts { tip { Knob on Wall } }",
        ),
    },
    Explanation {
        code: BY_VALUES,
        text: "Normals and axes must be unit vectors, and an inertia that is given in a frame in which its body turns must \
            be round about that axis. Here this is so with the values that the model states, and not with others, which \
            parameters may have at run time: equations would be wrong then. Divide a vector by its length with `unit`, \
            use an angle, name one parameter twice, or make the parameters `fixed`.",
        wrong: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, a: 1 = 0.6, b: 1 = 0.8 }\n\
            contacts { tip { point: P of Rod, normal: -a*N.x - b*N.y, gap: l - dot(position(P), a*N.x + b*N.y) } }",
        ),
        right: Some(
            "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, a: rad = 0.9273 }\n\
            contacts { tip { point: P of Rod, normal: -cos(a)*N.x - sin(a)*N.y, gap: l - dot(position(P), \
            cos(a)*N.x + sin(a)*N.y) } }",
        ),
    },
];
