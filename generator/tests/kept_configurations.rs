//! Configuration equations and velocity constraints that disagree: exact arithmetic finds what numbers cannot
//! see, accepts what agrees, and the message says which of the two decided.

use hodograph_generator::check::check;
use hodograph_generator::source::Source;

const EXACTLY: &str = "by exact arithmetic";
const BY_NUMBERS: &str = "numbers at closed states";
/// Exact arithmetic decided for arbitrary parameters, numbers for those of the model.
const NEITHER: &str = "both";

/// The errors and warnings about configuration equations: code and which road decided.
fn found(text: &str) -> Vec<(&'static str, &'static str)> {
    let source = Source::file("model.mech", text);
    let all = check(&source).diagnostics.into_iter();
    let of_configuration = |code: &str| matches!(code, "E078" | "W013");
    let others: Vec<String> =
        all.clone().filter(|d| !of_configuration(d.code.0)).map(|d| d.one_line(&source)).collect();
    assert!(others.iter().all(|other| other.contains("W0")), "{others:?}");
    let road = |message: &str| match (message.contains(EXACTLY), message.contains(BY_NUMBERS)) {
        (true, false) => EXACTLY,
        (false, true) => BY_NUMBERS,
        (true, true) => NEITHER,
        _ => panic!("{message}"),
    };
    all.filter(|d| of_configuration(d.code.0)).map(|d| (d.code.0, road(&d.message))).collect()
}

fn gears(constraint: &str, configuration: &str) -> String {
    format!(
        "mechanism Gears;\n\
        parameters {{ J: kg*m^2 = 0.1, m: kg = 1, n: 1 = 2, w0: 1/s = 1, a: rad = 0.3 }}\n\
        inputs {{ tau: N*m = 1 }}\n\
        coordinates {{ q1: rad = 0, dependent q2: rad = 0 }}\n\
        speeds {{ u1: rad/s }}\n\
        dependent {{ u2: rad/s }}\n\
        frames {{ A = N.rotate(z, q1); B = N.rotate(z, q2); }}\n\
        bodies {{ Ga {{ frame: A, centre: O, mass: m, inertia: [J, J, J] }}, \
        Gb {{ frame: B, centre: O, mass: m, inertia: [J, J, J] }} }}\n\
        loads {{ torque on A: tau*N.z; }}\n\
        constraints {{ {constraint}; }}\n\
        configuration {{ {configuration}; }}\n"
    )
}

#[test]
fn gears_that_disagree_are_found_exactly() {
    let wrong = [
        ("u2 = -n*u1", "q2 = n*q1"),
        ("u2 = u1", "q2 = 2*q1"),
        ("u2 = n*u1", "q2 = n*q1 + sin(time*3*w0)*1"),
        // what no number at random states shows
        ("u2 = 2.000000002*u1", "q2 = 2*q1"),
        ("u2 = n*u1*(1 + 1e-9)", "q2 = n*q1"),
        ("u2 = n*u1 + 1e-12*w0", "q2 = n*q1 + a"),
        ("u2 = n*u1", "q2 = n*q1 + 1e-20*sin(q1)"),
        ("u2 = cosh(a)^2*u1 - sinh(a)^2*u1*(1 + 1e-15)", "q2 = q1"),
    ];
    for (constraint, configuration) in wrong {
        assert_eq!(
            found(&gears(constraint, configuration)),
            [("E078", EXACTLY)],
            "{constraint} {configuration}"
        );
    }
}

#[test]
fn gears_that_agree_are_accepted() {
    let right = [
        ("u2 = n*u1", "q2 = n*q1"),
        ("n*u1 - u2 = 0", "q2/n = q1 + a"),
        ("u2 = 2*u1", "2*q1 - q2 = 0"),
        ("u2 = n*u1 + cos(time*3*w0)*3*w0", "q2 = n*q1 + sin(time*3*w0)*1"),
        ("u2 = cosh(a)^2*u1 - sinh(a)^2*u1", "q2 = q1 - a"),
        ("d(q2 - sin(2*q1))/dt = 0", "q2 = 2*sin(q1)*cos(q1)"),
        ("u2 = 0.1*n*u1", "10*q2 = n*q1"),
    ];
    for (constraint, configuration) in right {
        assert_eq!(found(&gears(constraint, configuration)), [], "{constraint} {configuration}");
    }
}

#[test]
fn what_holds_for_the_values_alone_is_told_exactly() {
    for (constraint, configuration) in
        [("u2 = 2*u1", "q2 = n*q1"), ("u2 = n*u1", "q2 = 2*q1"), ("u2 = n^2/2*u1", "q2 = n*q1")]
    {
        assert_eq!(
            found(&gears(constraint, configuration)),
            [("W013", EXACTLY)],
            "{constraint} {configuration}"
        );
    }
}

/// The lengths of a linkage, in which the equations of its loop are linear, close it.
fn four_bar(point: &str) -> String {
    format!(
        "mechanism FourBar;\n\
        parameters {{ m: kg = 1, l1: m = 1, l2: m = 1.3, l3: m = 1.2, d0: m = 1.5, g: m/s^2 = 9.81 }}\n\
        coordinates {{ q1: rad = 1, dependent q2: rad = 0.3, dependent q3: rad = 1.3 }}\n\
        speeds {{ u1: rad/s = 1 }}\n\
        dependent {{ u2: rad/s, u3: rad/s }}\n\
        frames {{ A = N.rotate(z, q1); B = N.rotate(z, q2); C = N.rotate(z, q3); }}\n\
        points {{ P = O + l1*A.x; E1 = P + l2*B.x; Other = P + {point}*B.x; E2 = O + d0*N.x + l3*C.x; }}\n\
        particles {{ One {{ point: P, mass: m }}, Two {{ point: E1, mass: m }} }}\n\
        loads {{ gravity: -g*N.y; }}\n\
        constraints {{ velocity(Other) = velocity(E2); }}\n\
        configuration {{ position(E1) = position(E2); }}\n"
    )
}

#[test]
fn linkages_are_closed_by_their_lengths() {
    assert_eq!(found(&four_bar("l2")), []);
    assert_eq!(found(&four_bar("(l2*2 - l2)")), []);
    let road = |point: &str| found(&four_bar(point));
    assert!(road("l1").iter().all(|found| found.0 == "E078"), "{:?}", road("l1"));
    // with the values no symbol closes the loop, and 1e-9 is too little for numbers
    assert_eq!(road("l2*(1 + 1e-9)"), [("W013", NEITHER)]);
}

#[test]
fn numbers_decide_where_symbols_do_not() {
    let scotch = |rate: &str| gears(&format!("u2 = {rate}"), "q2 = sqrt(1 + q1^2) - 1 + abs(a) - a");
    assert_eq!(found(&scotch("q1*u1/sqrt(1 + q1^2)")), []);
    assert_eq!(found(&scotch("1.1*q1*u1/sqrt(1 + q1^2)")), [("E078", BY_NUMBERS)]);
}

/// A four-bar linkage in a plane that leans. Its start closes the loop up to rounding, along all three axes; rounding is no
/// equation.
#[test]
fn a_loop_in_a_tilted_plane_may_be_closed_from_the_start() {
    let linkage = |turn: &str, q2: &str| {
        format!(
            "mechanism Tilted;\n\
            parameters {{ m: kg = 1, l1: m = 0.3, l2: m = 0.8, l3: m = 0.6, d: m = 0.9, g: m/s^2 = 9.81 }}\n\
            coordinates {{ q1: rad = 1.5472, dependent q2: rad = {q2}, dependent q3: rad = 1.8139138124924439 }}\n\
            speeds {{ u1: rad/s = 1 }}\n\
            dependent {{ u2: rad/s, u3: rad/s }}\n\
            frames {{ W = N.rotate({turn}); A = W.rotate(z, q1); B = W.rotate(z, q2); C = W.rotate(z, q3); }}\n\
            points {{ P = O + l1*A.x; E1 = P + l2*B.x; E2 = O + d*W.x + l3*C.x; }}\n\
            particles {{ One {{ point: P, mass: m }}, Two {{ point: E1, mass: m }} }}\n\
            loads {{ gravity: -g*W.y; }}\n\
            constraints {{ velocity(E1) = velocity(E2); }}\n\
            configuration {{ position(E1) = position(E2); }}\n"
        )
    };
    for turn in ["x, 0.3", "[0.36, 0.48, 0.8], 0.7", "y, -1.1", "[0.6, 0, 0.8], 2"] {
        for q2 in ["0.3608274909496134", "0.3608", "0.4"] {
            assert_eq!(found(&linkage(turn, q2)), [], "{turn} {q2}");
        }
    }
}
