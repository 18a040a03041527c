//! Mistakes that an author makes, one or two at a time, in one small model: each is told at its place.
//! `tests/diagnostics` holds the words of such messages.

use hodograph_generator::check::check;
use hodograph_generator::source::Source;

/// The model, line by line.
const MODEL: [&str; 9] = [
    "mechanism Rod;",
    "parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }",
    "coordinates { q1: rad = 0.3 }",
    "speeds { u1: rad/s }",
    "frames { B = N.rotate(z, q1); }",
    "points { G = O - l/2*B.y; P = O - l*B.y; }",
    "bodies { Arm { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }",
    "loads { gravity: -g*N.y; }",
    "contacts { tip { point: P of Arm, normal: -N.x, gap: l - dot(position(P), N.x) } }",
];

/// What stands in the place of lines, and what is said: codes, lines and columns.
type Case = (&'static str, &'static [(usize, &'static str)], &'static [&'static str]);

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("arity", &[(4, "frames { B = N.rotate(z); }")],
        &["E052 5:14"]),
    ("arity2", &[(5, "points { G = O - l/2*B.y; P = O - sin(q1, q1)*l*B.y; }")],
        &["E041 6:35"]),
    ("bad_axis", &[(4, "frames { B = N.rotate(w, q1); }")],
        &["E052 5:23"]),
    ("bad_number", &[(1, "parameters { m: kg = 1e, l: m = 0.5.3, g: m/s^2 = 9.81 }")],
        &["E004 2:22", "E006 2:37"]),
    ("body_frame_point", &[(6, "bodies { Arm { frame: G, centre: B, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }")],
        &["E025 7:23", "E025 7:34"]),
    ("constraint_no_dep", &[(7, "loads { gravity: -g*N.y; } constraints { u1 = 0; }")],
        &["E070 8:42"]),
    ("contact_no_point", &[(8, "contacts { tip { normal: -N.x } }")],
        &["E013 9:12"]),
    ("contact_unknown_body", &[(8, "contacts { tip { point: P of Leg, normal: -N.x, gap: l - dot(position(P), N.x) } }")],
        &["E020 9:30"]),
    ("div_zero", &[(5, "points { G = O - l/2*B.y; P = O - l/(q1 - q1)*B.y; }")],
        &["E034 6:37"]),
    ("dup_param", &[(1, "parameters { m: kg = 1, m: kg = 2, l: m = 0.5, g: m/s^2 = 9.81 }")],
        &["E021 2:25"]),
    ("dup_point", &[(5, "points { G = O - l/2*B.y; P = O - l*B.y; P = O; }")],
        &["E021 6:42"]),
    ("emptybody", &[(6, "bodies { Arm { } }")],
        &["E060 7:10"]),
    ("field_unknown", &[(6, "bodies { Arm { frame: B, center: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }")],
        &["E013 7:26"]),
    ("force_nowhere", &[(7, "loads { gravity: -g*N.y; force: m*g*N.x; }")],
        &["E063 8:26"]),
    ("gap_none_typo", &[(8, "contacts { tip { point: P of Arm, normal: -N.x, gap: nothing } }")],
        &["E020 9:54"]),
    ("gap_speed", &[(8, "contacts { tip { point: P of Arm, normal: -N.x, gap: l*u1 } }")],
        &["E031 9:54"]),
    ("gap_wrong_sign", &[(8, "contacts { tip { point: P of Arm, normal: N.x, gap: l - dot(position(P), N.x) } }")],
        &["W007 9:53"]),
    ("inertia2", &[(6, "bodies { Arm { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0] } }")],
        &["E062 7:55"]),
    ("inertia_impossible", &[(6, "bodies { Arm { frame: B, centre: G, mass: m, inertia: [m*l^2, 0, m*l^2/12] } }")],
        &["E062 7:55"]),
    ("init_self", &[(2, "coordinates { q1: rad = q1 }")],
        &["E024 3:25"]),
    ("init_unit", &[(2, "coordinates { q1: rad = l }")],
        &["E031 3:25"]),
    ("keyword", &[(1, "parameters { m: kg = 1, fn: m = 1, l: m = 0.5, g: m/s^2 = 9.81 }")],
        &["E022 2:25"]),
    ("loop_names", &[(5, "points { G = P - l/2*B.y; P = G - l*B.y; }")],
        &["E024 6:31"]),
    ("mass_unit", &[(6, "bodies { Arm { frame: B, centre: G, mass: l, inertia: [m*l^2/12, 0, m*l^2/12] } }")],
        &["E031 7:43"]),
    ("missing_semi", &[(5, "points { G = O - l/2*B.y P = O - l*B.y; }")],
        &["E006 6:24"]),
    ("missing_speed", &[(3, "speeds { v: rad/s }")],
        &["E073 3:15"]),
    ("nan_big", &[(1, "parameters { m: kg = 1e400, l: m = 0.5, g: m/s^2 = 9.81 }")],
        &["E033 2:22"]),
    ("neg_mass", &[(1, "parameters { m: kg = -1, l: m = 0.5, g: m/s^2 = 9.81 }")],
        &["E061 7:43"]),
    ("no_mechanism", &[(0, "")],
        &["E006 2:1"]),
    ("normal_not_unit", &[(8, "contacts { tip { point: P of Arm, normal: -2*N.x, gap: l - dot(position(P), N.x) } }")],
        &["E080 9:43"]),
    ("normal_scalar", &[(8, "contacts { tip { point: P of Arm, normal: 1, gap: l } }")],
        &["E040 9:43"]),
    ("pair1", &[(1, "parameters { m: kg = 1, l: m = 0.5, g: m/s = 9.81 }"), (8, "contacts { tip { point: Q of Arm, normal: -N.x, gap: l } }")],
        &["E031 8:18", "E020 9:25"]),
    ("pair2", &[(4, "frames { B = N.rotate(z, q2); }"), (6, "bodies { Arm { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l/12] } }")],
        &["E020 5:26", "E031 7:69"]),
    ("paren", &[(5, "points { G = O - (l/2*B.y; P = O - l*B.y; }")],
        &["E005 6:43"]),
    ("scalar_as_vector", &[(5, "points { G = O - l/2; P = O - l*B.y; }")],
        &["E040 6:18"]),
    ("section_twice", &[(7, "loads { gravity: -g*N.y; } loads { gravity: g*N.y; }")],
        &["E009 8:28", "E063 8:36"]),
    ("section_typo", &[(7, "load { gravity: -g*N.y; }")],
        &["E007 8:1"]),
    ("sin_len", &[(5, "points { G = O - l/2*B.y; P = O - l*sin(l)*B.y; }")],
        &["E031 6:41"]),
    ("speed_unit", &[(3, "speeds { u1: m/s }")],
        &["E031 4:10"]),
    ("sqrt_dim", &[(5, "points { G = O - l/2*B.y; P = O - sqrt(l)*B.y; }")],
        &["E031 6:35"]),
    ("surface_e", &[(8, "contacts { tip { point: P of Arm, normal: -N.x, gap: l - dot(position(P), N.x), surface: { mu: -1, e: 2, law: stronk } } }")],
        &["E083 9:96", "E083 9:103", "E083 9:111"]),
    ("torque_point", &[(7, "loads { gravity: -g*N.y; torque on P: m*g*l*N.z; }")],
        &["E025 8:36"]),
    ("touch_unknown", &[(2, "coordinates { q1: rad = touching(floor) }")],
        &["E020 3:34"]),
    ("two_speeds", &[(3, "speeds { u1: rad/s, u2: rad/s }")],
        &["E076 4:21"]),
    ("unclosed", &[(5, "points { G = O - l/2*B.y; P = O - l*B.y; ")],
        &["E005 6:8"]),
    ("unit_mismatch", &[(7, "loads { gravity: -g*l*N.y; }")],
        &["E031 8:18"]),
    ("unit_typo", &[(1, "parameters { m: kgg = 1, l: m = 0.5, g: m/s^2 = 9.81 }")],
        &["E030 2:17"]),
    ("unknown_frame", &[(4, "frames { B = M.rotate(z, q1); }")],
        &["E020 5:14"]),
    ("unknown_name", &[(5, "points { G = O - L/2*B.y; P = O - l*B.y; }")],
        &["E020 6:18"]),
    ("vector_as_scalar", &[(8, "contacts { tip { point: P of Arm, normal: -N.x, gap: position(P) } }")],
        &["E040 9:54"]),
];

fn said(lines: &[&str]) -> Vec<String> {
    let source = Source::file("rod.mech", lines.join("\n") + "\n");
    let told = check(&source).diagnostics;
    let of = |d: &hodograph_generator::diagnostics::Diagnostic| {
        let at = source.location(d.primary.span).expect("a place");
        format!("{} {}:{}", d.code.0, at.line, at.column)
    };
    told.iter().map(of).collect()
}

/// A mark of the order of bytes is no part of the first line.
#[test]
fn columns_are_counted_without_a_byte_order_mark() {
    for text in ["mechanism 5;", "\u{feff}mechanism 5;"] {
        let source = Source::file("model.mech", text);
        let found = check(&source).diagnostics;
        let at = source.location(found[0].primary.span).expect("a place");
        assert_eq!((at.line, at.column), (1, 11), "{text}");
    }
}

#[test]
fn every_mistake_is_told_at_its_place() {
    assert_eq!(said(&MODEL), [""; 0]);
    for (name, changes, expected) in CASES {
        let mut lines = MODEL;
        changes.iter().for_each(|(line, text)| lines[*line] = text);
        assert_eq!(said(&lines), *expected, "{name}");
    }
    assert_eq!(CASES.len(), 50);
}
