//! The words of the language with what they mean, in one place: reading, completion, hovering and grammars
//! take them from here.

/// A word, how it is written, and what it means.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// the word
    pub text: &'static str,
    /// how it is written, with stand-ins for what belongs to it
    pub form: &'static str,
    /// what it means, in a few words
    pub meaning: &'static str,
}

const fn word(text: &'static str, form: &'static str, meaning: &'static str) -> Word {
    Word { text, form, meaning }
}

/// The words that open sections, in their order.
pub const SECTIONS: &[Word] = &[
    word("parameters", "name: unit = value,", "constants whose values are given at run time"),
    word("inputs", "name: unit,", "quantities given at each evaluation"),
    word("coordinates", "name: unit = value,", "generalised coordinates"),
    word("speeds", "name: unit = value,", "independent generalised speeds"),
    word("dependent", "name: unit,", "dependent generalised speeds"),
    word("definitions", "name = expression;", "names for expressions"),
    word("frames", "name = N.rotate(z, angle);", "orientations"),
    word("angular_velocities", "frame = vector;", "angular velocities in terms of speeds"),
    word("points", "name = O + vector;", "positions"),
    word("velocities", "point = vector;", "velocities in terms of speeds"),
    word("bodies", "name { frame: B, centre: G, mass: m, inertia: [xx, yy, zz] },", "masses and inertias"),
    word("particles", "name { point: P, mass: m },", "masses without inertia"),
    word("shapes", "name { of: Body, sphere: r },", "surfaces of bodies, of frames and of the ground"),
    word("loads", "force on P: vector;", "forces and torques"),
    word("kinematics", "d(q)/dt = u;", "kinematical equations"),
    word("constraints", "expression = expression;", "velocity constraints"),
    word("configuration", "expression = expression;", "configuration constraints"),
    word(
        "contacts",
        "name { point: P of B, normal: N.y, gap: distance },",
        "points that may strike something",
    ),
];

/// What an entry may begin with, and the words within entries.
pub const WORDS: &[Word] = &[
    word("mechanism", "mechanism Name;", "begins a model"),
    word("fixed", "fixed name: unit = value", "a parameter whose value is folded into the equations"),
    word("dependent", "dependent name: unit = value", "a coordinate that follows from the configuration"),
    word("of", "P of B", "a point of a body or frame"),
    word("in", "B in A", "relative to a frame; `Ball in Bowl`, a shape within another"),
    word("about", "about A.z", "about an axis or a point"),
    word("on", "on P", "what a load acts on; `Foot on Floor`, two shapes that may meet"),
    word("from", "from Q", "where the opposite of a load acts"),
    word("to", "P to Q", "the other end of a spring"),
    word("velocity", "velocity vector", "what moves with this velocity"),
    word("none", "gap: none", "a contact without a gap"),
];

/// The fields of a body.
pub const BODY: [&str; 4] = ["frame", "centre", "mass", "inertia"];
/// The fields of a body that takes mass and inertia from a shape.
pub const BODY_OF_SHAPE: [&str; 3] = ["frame", "centre", "shape"];
/// The fields of a shape besides the one that says what it is.
pub const SHAPE: [&str; 6] = ["of", "at", "axis", "axes", "density", "colour"];
/// The fields of a particle.
pub const PARTICLE: [&str; 2] = ["point", "mass"];
/// The fields of a contact.
pub const CONTACT: [&str; 5] = ["point", "against", "normal", "gap", "surface"];
/// The coordinates of a place along the axes of a shape.
pub const PLACES: [&str; 3] = ["x", "y", "z"];

/// Those of [`PLACES`] that stand for a place in the expression after this word: of a shape that is stated by one.
pub fn places(word: &str) -> &'static [&'static str] {
    match word {
        "curve" => &PLACES[..1],
        "surface" => &PLACES[..2],
        "implicit" => &PLACES,
        _ => &[],
    }
}

/// The fields of the surface of a contact.
pub const SURFACE: [&str; 9] =
    ["mu", "e", "law", "mu_static", "mu_impact", "sliding", "restitution", "rolling", "spinning"];
/// The fields of a spring.
pub const SPRING: [&str; 3] = ["stiffness", "length", "damping"];
/// The fields of a torsional spring.
pub const TORSION: [&str; 4] = ["angle", "rest", "stiffness", "damping"];

/// All fields with their meaning.
pub const FIELDS: &[Word] = &[
    word("frame", "frame: B", "the frame fixed in the body"),
    word("centre", "centre: G", "the mass centre"),
    word("mass", "mass: m", "the mass, kg"),
    word("inertia", "inertia: [xx, yy, zz]", "the inertia, kg*m^2, about the mass centre"),
    word("point", "point: P of B", "the point"),
    word("against", "against: Q of B", "what is struck; left out: what is fixed in N"),
    word("normal", "normal: N.y", "the unit vector from what is struck to what strikes"),
    word("gap", "gap: distance", "the distance, m"),
    word(
        "surface",
        "surface: { mu: 0.3, e: 0.5, law: stronge }",
        "friction and restitution; of a shape, `surface: h*sin(k*x)`, the height z = h(x, y)",
    ),
    word("shape", "shape: Hull", "the shape from which mass and inertia follow"),
    word("of", "of: Body", "the body, particle or frame with which the shape moves; left out: N"),
    word("at", "at: P + vector", "the place of the shape; left out: the mass centre of its body"),
    word("axis", "axis: B.z", "the axis of rotation of the shape"),
    word("axes", "axes: B", "the frame along whose axes the shape lies; left out: its own"),
    word("density", "density: rho", "the density, kg/m^3"),
    word("colour", "colour: teal", "how the shape is drawn: a name or [red, green, blue]"),
    word("sphere", "sphere: r", "a ball"),
    word("capsule", "capsule: [r, l]", "all within r of a segment of length l"),
    word("cylinder", "cylinder: [r, l]", "a cylinder, radius and length"),
    word("cone", "cone: [r, h]", "a cone, radius and height; its place is the centre of its base"),
    word("disc", "disc: r", "a thin rim"),
    word("torus", "torus: [R, r]", "a tyre, radius and radius of its tube"),
    word("ellipsoid", "ellipsoid: [a, b, c]", "semi-axes along x, y and z"),
    word("box", "box: [a, b, c]", "lengths along x, y and z"),
    word("rectangle", "rectangle: [a, b]", "lengths along x and y, in the plane of motion"),
    word("polytope", "polytope: [P, Q, G + a*B.x]", "the convex hull of points"),
    word("plane", "plane: N.z", "a plane with its normal"),
    word("half_space", "half_space: N.z", "what lies behind a plane with this normal"),
    word("curve", "curve: h*sin(k*x)", "y = h(x) in the plane of x and y"),
    word(
        "implicit",
        "implicit: x^2 + y^2 - r^2",
        "where a function of x, y and z vanishes; it is positive outside",
    ),
    word("mu", "mu: 0.3", "the coefficient of friction"),
    word("e", "e: 0.5", "the coefficient of restitution, from 0 to 1"),
    word("law", "law: stronge", "the hypothesis of restitution: what e means"),
    word("mu_static", "mu_static: 0.4", "the coefficient of static friction"),
    word("mu_impact", "mu_impact: 0.3", "the coefficient of friction in impacts"),
    word("sliding", "sliding: stribeck(0.1)", "friction as a function of the speed of slip"),
    word("restitution", "restitution: threshold(0.1)", "restitution as a function of the speed of approach"),
    word("rolling", "rolling: 0.002", "the lever arm of rolling friction, m"),
    word("spinning", "spinning: 0.001", "the lever arm of spinning friction, m"),
    word("stiffness", "stiffness: k", "the stiffness"),
    word("length", "length: l0", "the length at rest, m"),
    word("damping", "damping: c", "the damping"),
    word("angle", "angle: q1", "the angle of the spring"),
    word("rest", "rest: q0", "the angle at rest"),
];

/// The loads.
pub const LOADS: [&str; 5] = ["gravity", "force", "torque", "spring", "torsion"];

/// The loads with their forms.
pub const LOAD_FORMS: &[Word] = &[
    word("gravity", "gravity: -g*N.z;", "acceleration of gravity, on everything that has mass"),
    word("force", "force on P: F*N.x;", "a force at a point"),
    word("torque", "torque on B: tau*N.z;", "a torque on a frame or body"),
    word("spring", "spring P to H: { stiffness: k, length: l0, damping: c };", "a spring and damper"),
    word("torsion", "torsion B about N.z: { stiffness: k };", "a torsional spring and damper"),
];

/// How a frame is oriented in the one before the dot.
pub const ORIENTATIONS: [&str; 5] = ["rotate", "euler", "space", "quaternion", "spin"];

/// What stands after the dot behind a frame.
pub const MEMBERS: &[Word] = &[
    word("x", "A.x", "the first unit vector of the frame"),
    word("y", "A.y", "the second unit vector of the frame"),
    word("z", "A.z", "the third unit vector of the frame"),
    word("vec", "A.vec(a, b, c)", "the vector with these components along the axes of the frame"),
    word("rotate", "A.rotate(z, angle)", "a right-handed rotation about an axis of the frame"),
    word("euler", "A.euler(xyz, q1, q2, q3)", "three rotations about the new axes"),
    word("space", "A.space(xyz, q1, q2, q3)", "three rotations about the axes of the frame"),
    word("quaternion", "A.quaternion(e0, e1, e2, e3)", "a unit quaternion, scalar part first"),
    word("spin", "A.spin(u*A.y)", "an angular velocity whose angle is ignorable"),
];

/// The functions.
pub const FUNCTIONS: &[Word] = &[
    word("sin", "sin(x)", "sine"),
    word("cos", "cos(x)", "cosine"),
    word("tan", "tan(x)", "tangent"),
    word("asin", "asin(x)", "arc sine, rad"),
    word("acos", "acos(x)", "arc cosine, rad"),
    word("atan", "atan(x)", "arc tangent, rad"),
    word("atan2", "atan2(y, x)", "angle of the point (x, y), rad"),
    word("sqrt", "sqrt(x)", "square root"),
    word("exp", "exp(x)", "exponential"),
    word("log", "log(x)", "natural logarithm"),
    word("sinh", "sinh(x)", "hyperbolic sine"),
    word("cosh", "cosh(x)", "hyperbolic cosine"),
    word("tanh", "tanh(x)", "hyperbolic tangent"),
    word("abs", "abs(x)", "magnitude of a scalar"),
    word("sign", "sign(x)", "-1, 0 or 1"),
    word("min", "min(a, b)", "the lesser"),
    word("max", "max(a, b)", "the greater"),
    word("pow", "pow(a, b)", "power, as a^b"),
    word("dot", "dot(v, w)", "scalar product of two vectors"),
    word("cross", "cross(v, w)", "vector product"),
    word("norm", "norm(v)", "magnitude of a vector"),
    word("unit", "unit(v)", "unit vector along a vector"),
    word("position", "position(P, Q)", "vector from Q, or from O, to P"),
    word("velocity", "velocity(P)", "velocity of a point in N; with two points the difference"),
    word("angular_velocity", "angular_velocity(B, A)", "angular velocity of B in A, or in N"),
    word("d", "d(q)/dt", "time derivative"),
];

/// Functions that stand in initial values only.
pub const START_FUNCTIONS: &[Word] =
    &[word("touching", "touching(contact)", "the value at which the gap of a contact is 0")];

/// The hypotheses of restitution.
pub const LAWS: &[Word] = &[
    word("newton", "law: newton", "ratio of normal velocities"),
    word("poisson", "law: poisson", "ratio of normal impulses"),
    word("stronge", "law: stronge", "ratio of works of the normal force"),
];

/// Laws of sliding friction.
pub const SLIDING: &[Word] = &[
    word("constant", "sliding: constant", "one coefficient"),
    word("stribeck", "sliding: stribeck(speed)", "falls from the static coefficient with the speed of slip"),
];

/// Laws of restitution as functions of the speed of approach.
pub const RESTITUTION: &[Word] = &[
    word("constant", "restitution: constant", "one coefficient"),
    word("threshold", "restitution: threshold(speed)", "none below a speed"),
    word("power", "restitution: power(speed, exponent)", "falls as a power of the speed"),
    word("loss", "restitution: loss(speed, exponent)", "the loss grows as a power of the speed"),
    word("table", "restitution: table(speed, e, speed, e)", "values at speeds, with lines between"),
];

/// What is given in every model.
pub const GIVEN: &[Word] = &[
    word("N", "N", "the inertial frame"),
    word("O", "O", "a point fixed in the inertial frame"),
    word("time", "time", "the time, s"),
    word("pi", "pi", "3.14159.."),
];

/// The entry of a table.
pub fn look<'w>(table: &'w [Word], text: &str) -> Option<&'w Word> {
    table.iter().find(|word| word.text == text)
}

/// The words of a table, for messages.
pub fn texts(table: &[Word]) -> String {
    table.iter().map(|word| word.text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::tree::Section;

    #[test]
    fn every_word_that_is_read_has_its_meaning() {
        let sections: Vec<&str> = Section::ALL.iter().map(|section| section.word()).collect();
        assert_eq!(SECTIONS.iter().map(|word| word.text).collect::<Vec<_>>(), sections);
        let kinds = crate::model::mechanism::Kind::ALL.map(|kind| kind.word());
        let records =
            [&BODY[..], &BODY_OF_SHAPE, &SHAPE, &kinds, &PARTICLE, &CONTACT, &SURFACE, &SPRING, &TORSION];
        for field in records.into_iter().flatten() {
            assert!(look(FIELDS, field).is_some(), "{field}");
        }
        assert_eq!(LOAD_FORMS.iter().map(|word| word.text).collect::<Vec<_>>(), LOADS);
        for operation in ORIENTATIONS {
            assert!(look(MEMBERS, operation).is_some(), "{operation}");
        }
    }
}
