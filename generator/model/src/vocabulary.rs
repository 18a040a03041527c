//! Words that authors know from other modelling languages and textbooks, with the words of this language.
//! Suggestions are sought here first, since the name with the nearest spelling often means something else.

/// What a table says of a word.
fn look(table: &[(&str, &'static str)], word: &str) -> Option<&'static str> {
    table.iter().find(|(habit, _)| *habit == word).map(|(_, here)| *here)
}

/// The section that is meant.
pub fn section(word: &str) -> Option<&'static str> {
    let table = [
        ("constants", "parameters"),
        ("consts", "parameters"),
        ("params", "parameters"),
        ("fixed", "parameters"),
        ("controls", "inputs"),
        ("generalized_coordinates", "coordinates"),
        ("coords", "coordinates"),
        ("positions", "coordinates"),
        ("generalized_speeds", "speeds"),
        ("dependent_speeds", "dependent"),
        ("variables", "definitions"),
        ("let", "definitions"),
        ("where", "definitions"),
        ("rotations", "frames"),
        ("orientations", "frames"),
        ("body", "bodies"),
        ("links", "bodies"),
        ("rigid_bodies", "bodies"),
        ("masses", "particles"),
        ("forces", "loads"),
        ("torques", "loads"),
        ("gravity", "loads"),
        ("springs", "loads"),
        ("actuators", "loads"),
        ("equations", "kinematics"),
        ("kinematic", "kinematics"),
        ("nonholonomic", "constraints"),
        ("holonomic", "configuration"),
        ("loops", "configuration"),
        ("geometry", "shapes"),
        ("geometries", "shapes"),
        ("geoms", "shapes"),
        ("colliders", "shapes"),
        ("surfaces", "shapes"),
        ("collisions", "contacts"),
        ("impacts", "contacts"),
    ];
    look(&table, word)
}

/// The load that is meant.
pub fn load(word: &str) -> Option<&'static str> {
    let table = [
        ("weight", "gravity"),
        ("g", "gravity"),
        ("moment", "torque"),
        ("couple", "torque"),
        ("motor", "torque"),
        ("damper", "spring"),
        ("dashpot", "spring"),
        ("linear_spring", "spring"),
        ("torsional_spring", "torsion"),
        ("torsion_spring", "torsion"),
        ("rotational_spring", "torsion"),
    ];
    look(&table, word)
}

/// The field that is meant, if the record has it.
pub fn field(word: &str, known: &[&str]) -> Option<&'static str> {
    let table = [
        ("center", "centre"),
        ("com", "centre"),
        ("cog", "centre"),
        ("cm", "centre"),
        ("mass_center", "centre"),
        ("mass_centre", "centre"),
        ("origin", "centre"),
        ("point", "centre"),
        ("centre", "point"),
        ("center", "point"),
        ("com", "point"),
        ("position", "point"),
        ("m", "mass"),
        ("weight", "mass"),
        ("I", "inertia"),
        ("J", "inertia"),
        ("moment_of_inertia", "inertia"),
        ("orientation", "frame"),
        ("n", "normal"),
        ("direction", "normal"),
        ("distance", "gap"),
        ("on", "against"),
        ("with", "against"),
        ("surface", "against"),
        ("k", "stiffness"),
        ("constant", "stiffness"),
        ("c", "damping"),
        ("d", "damping"),
        ("b", "damping"),
        ("l0", "length"),
        ("free_length", "length"),
        ("rest_length", "length"),
        ("natural_length", "length"),
        ("theta", "angle"),
        ("friction", "mu"),
        ("restitution", "e"),
        ("cor", "e"),
        ("hypothesis", "law"),
        ("rest_angle", "rest"),
    ];
    table.iter().find(|(habit, here)| *habit == word && known.contains(here)).map(|(_, here)| *here)
}

/// The shape that is meant, or the field of a shape.
pub fn shape(word: &str) -> Option<&'static str> {
    let table = [
        ("ball", "sphere"),
        ("point", "sphere"),
        ("circle", "disc"),
        ("disk", "disc"),
        ("ring", "disc"),
        ("wheel", "disc"),
        ("rim", "disc"),
        ("tyre", "torus"),
        ("tire", "torus"),
        ("pill", "capsule"),
        ("rod", "capsule"),
        ("tube", "cylinder"),
        ("cuboid", "box"),
        ("cube", "box"),
        ("block", "box"),
        ("hull", "polytope"),
        ("convex", "polytope"),
        ("mesh", "polytope"),
        ("polygon", "polytope"),
        ("ground", "plane"),
        ("floor", "plane"),
        ("wall", "plane"),
        ("halfspace", "half_space"),
        ("heightfield", "surface"),
        ("height", "surface"),
        ("terrain", "surface"),
        ("function", "implicit"),
        ("level_set", "implicit"),
        ("levelset", "implicit"),
        ("sdf", "implicit"),
        ("body", "of"),
        ("frame", "of"),
        ("on", "of"),
        ("centre", "at"),
        ("center", "at"),
        ("place", "at"),
        ("position", "at"),
        ("origin", "at"),
        ("normal", "axis"),
        ("direction", "axis"),
        ("color", "colour"),
        ("rho", "density"),
    ];
    look(&table, word)
}

/// What to write for a unit.
pub fn unit(word: &str) -> Option<&'static str> {
    let table = [
        ("Nm", "N*m"),
        ("degree", "deg"),
        ("degrees", "deg"),
        ("radian", "rad"),
        ("radians", "rad"),
        ("meter", "m"),
        ("meters", "m"),
        ("metre", "m"),
        ("metres", "m"),
        ("sec", "s"),
        ("second", "s"),
        ("seconds", "s"),
        ("newton", "N"),
        ("newtons", "N"),
        ("Newton", "N"),
        ("kilogram", "kg"),
        ("kilograms", "kg"),
        ("gram", "g"),
        ("grams", "g"),
        ("joule", "J"),
        ("watt", "W"),
        ("pascal", "Pa"),
        ("hertz", "Hz"),
        ("minute", "min"),
        ("hour", "h"),
        ("hr", "h"),
        ("rpm", "rev/min"),
        ("turn", "rev"),
        ("turns", "rev"),
        ("ton", "Mg"),
        ("tonne", "Mg"),
        ("t", "Mg"),
    ];
    look(&table, word)
}

/// What is said where an author writes a unit or a type that no conversion can save.
pub fn unit_advice(word: &str) -> Option<&'static str> {
    match word {
        "lb" | "lbs" | "lbm" | "lbf" | "in" | "inch" | "ft" | "foot" | "feet" | "oz" | "slug" | "mi"
        | "mph" | "kgf" | "kp" | "dyn" | "erg" | "psi" | "bar" | "atm" | "cal" | "kcal" | "hp" | "knot" => {
            Some("only SI units: convert the value")
        }
        "f32" | "f64" | "float" | "double" | "real" | "Real" | "int" => Some(
            "after the colon stands a unit, such as `kg` or `m/s`; the type of numbers is chosen in Rust",
        ),
        "scalar" | "none" | "None" | "dimensionless" | "unitless" | "number" => {
            Some("a plain number has the unit `1`")
        }
        "A" | "V" | "C" | "K" | "F" | "T" | "ohm" | "mol" | "cd" => {
            Some("a mechanism is measured in m, kg, s and what follows from them")
        }
        _ => None,
    }
}

/// What to do about a function of other languages.
pub fn function(word: &str) -> Option<&'static str> {
    let table = [
        ("arctan", "did you mean `atan`?"),
        ("arcsin", "did you mean `asin`?"),
        ("arccos", "did you mean `acos`?"),
        ("arctan2", "did you mean `atan2`?"),
        ("ln", "did you mean `log`? It is the natural logarithm"),
        ("log10", "write `log(x)/log(10)`"),
        ("log2", "write `log(x)/log(2)`"),
        ("fabs", "did you mean `abs`?"),
        ("sgn", "did you mean `sign`?"),
        ("sqr", "write `x^2` for the square, `sqrt(x)` for the square root"),
        ("square", "write `x^2`"),
        ("cbrt", "write `x^(1/3)`"),
        ("hypot", "write `sqrt(a^2 + b^2)`, or `norm(v)` for a vector"),
        ("sec", "write `1/cos(x)`"),
        ("csc", "write `1/sin(x)`"),
        ("cot", "write `1/tan(x)`"),
        ("asinh", "write `log(x + sqrt(x^2 + 1))`"),
        ("acosh", "write `log(x + sqrt(x^2 - 1))`"),
        ("atanh", "write `log((1 + x)/(1 - x))/2`"),
        ("coth", "write `1/tanh(x)`"),
        ("sech", "write `1/cosh(x)`"),
        ("power", "write `x^2` or `pow(a, b)`"),
        ("magnitude", "did you mean `norm`?"),
        ("mag", "did you mean `norm`?"),
        ("length", "the length of a vector is `norm(v)`"),
        ("normalize", "did you mean `unit`?"),
        ("normalise", "did you mean `unit`?"),
        ("vec", "name the frame: `N.vec(a, b, c)`"),
        ("vector", "name the frame: `N.vec(a, b, c)`"),
        ("pos", "did you mean `position`?"),
        ("vel", "did you mean `velocity`?"),
        ("ang_vel", "did you mean `angular_velocity`?"),
        ("omega", "did you mean `angular_velocity`?"),
        ("radians", "declare the quantity in `deg`, as in `q1: deg = 30`: it is converted where it is used"),
        ("deg2rad", "declare the quantity in `deg`, as in `q1: deg = 30`: it is converted where it is used"),
        ("deg", "declare the quantity in `deg`, as in `q1: deg = 30`: it is converted where it is used"),
        ("rotate", "a rotation is stated under `frames`, as in `B = N.rotate(z, q1);`"),
    ];
    look(&table, word)
}

/// The word that an advice such as ``did you mean `norm`?`` offers.
pub fn word_meant(advice: &str) -> Option<&str> {
    advice.strip_prefix("did you mean `")?.split('`').next()
}

/// Whether it is how others call the derivative.
pub fn differentiates(function: &str) -> bool {
    matches!(function, "diff" | "der" | "ddt" | "derivative" | "Derivative" | "deriv" | "dot_" | "dt" | "D")
}

/// The name that is meant: words for what is given.
pub fn name(word: &str) -> Option<&'static str> {
    look(&[("t", "time"), ("T", "time"), ("PI", "pi"), ("Pi", "pi"), ("π", "pi"), ("M_PI", "pi")], word)
}

/// The name whose rate is meant by `q1_dot`, `q1dot`, `dq1`, `qd1`, `qdot1`, `q1d`, `q1_d`, if it is
/// declared.
pub fn rate_of(word: &str, declared: impl Fn(&str) -> bool) -> Option<String> {
    let mut candidates: Vec<String> = Vec::new();
    for mark in ["_dot", "dot", "_d", "_p", "d", "p"] {
        candidates.extend(word.strip_suffix(mark).map(str::to_owned));
    }
    for mark in ["dot_", "d_", "dot", "d"] {
        candidates.extend(word.strip_prefix(mark).map(str::to_owned));
    }
    // `qd1` and `qdot1` for `q1`, `qd_hip` for `q_hip`
    for mark in ["dot", "d"] {
        if let Some((before, after)) = word.split_once(mark)
            && !before.is_empty()
        {
            candidates.push(format!("{before}{after}"));
        }
    }
    candidates.into_iter().find(|name| !name.is_empty() && declared(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_recognised() {
        let declared = |name: &str| ["q1", "q_hip", "theta", "d"].contains(&name);
        for word in ["q1_dot", "q1dot", "dq1", "qd1", "qdot1", "q1d", "d_q1", "q1_d", "q1p"] {
            assert_eq!(rate_of(word, declared).as_deref(), Some("q1"), "{word}");
        }
        assert_eq!(rate_of("theta_dot", declared).as_deref(), Some("theta"));
        assert_eq!(rate_of("qd_hip", declared).as_deref(), Some("q_hip"));
        assert_eq!(rate_of("speed", declared), None);
    }

    #[test]
    fn a_field_is_advised_where_the_record_has_it() {
        assert_eq!(field("com", &["centre", "mass"]), Some("centre"));
        assert_eq!(field("com", &["point", "mass"]), Some("point"));
        assert_eq!(field("com", &["stiffness"]), None);
    }
}
