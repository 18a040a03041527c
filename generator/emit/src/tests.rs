//! Compares a small module with a reviewed one, and tests properties of every module.

use std::collections::BTreeMap;

use super::interface::{self as offers, Struct};
use super::{Options, Program, Requests, Specialised, interface, module, module_in_parts};
use proc_macro2::TokenStream;
use quote::quote;

use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::*;
use hodograph_model::number::Number;
use hodograph_model::span::Span;
use hodograph_program::program::graph::{Graph, Input};
use hodograph_program::program::{
    ContactQuantity, Derived, Guard, Output, PointQuantity, Quantity as Q, Structure,
};

fn quantity(name: &str, docs: &str, unit: &str, value: Option<f64>) -> Variable {
    Variable {
        name: name.into(),
        docs: docs.into(),
        unit: unit.into(),
        value,
        fixed: false,
        initial: None,
        typical: 1.0,
        factor: 1.0,
        dependent: false,
        span: Span::default(),
    }
}

/// A particle on a massless rod of length l about O, whose end strikes the wall with normal -N.x.
fn mechanism() -> Mechanism {
    let span = Span::default();
    let point = |name: &str, place| Point {
        name: name.into(),
        docs: String::new(),
        place,
        velocity: None,
        span,
        motion_span: span,
    };
    Mechanism {
        name: "Pendulum".into(),
        docs: "A particle on a rod, and a wall.".into(),
        parameters: vec![
            quantity("m", "mass", "kg", Some(2.0)),
            quantity("l", "length of the rod", "m", Some(0.5)),
            quantity("g", "", "m/s^2", Some(9.81)),
        ],
        inputs: vec![quantity("tau", "torque at the pivot", "N*m", None)],
        coordinates: vec![quantity("q1", "angle from the vertical", "rad", Some(0.3))],
        speeds: vec![quantity("u1", "", "rad/s", None)],
        definitions: vec![],
        frames: vec![Frame {
            name: "N".into(),
            docs: String::new(),
            parent: None,
            orientation: Orientation::Aligned,
            angular_velocity: None,
            span,
            orientation_span: span,
            motion_span: span,
        }],
        points: vec![point("O", Place::Origin), point("P", Place::Velocity(Vector::Zero))],
        bodies: vec![Body {
            name: "Bob".into(),
            docs: String::new(),
            frame: None,
            centre: PointId(1),
            mass: Scalar::Parameter(ParameterId(0)),
            mass_span: span,
            inertia: None,
            span,
        }],
        loads: vec![],
        kinematics: vec![],
        constraints: vec![],
        determining_constraints: None,
        configuration: vec![],
        shapes: vec![],
        contacts: vec![Contact {
            name: "TipWall".into(),
            docs: "the bob strikes the wall".into(),
            point: PointId(1),
            body: Some(BodyId(0)),
            against: Against::Fixed,
            shapes: None,
            normal: Vector::Zero,
            point_span: span,
            against_span: span,
            normal_span: span,
            gap: None,
            without_gap: false,
            validity: None,
            tangent: None,
            clearance: None,
            first_of_pair: None,
            gap_span: span,
            surface: None,
            law: ContactLaw::default(),
            turning: None,
            span,
        }],
    }
}

fn derived() -> Derived {
    let mut g = Graph::new();
    let [m, l, gravity] = [0, 1, 2].map(|i| g.input(Input::Parameter(i)));
    let (q, u, tau) = (g.input(Input::Coordinate(0)), g.input(Input::Speed(0)), g.input(Input::Input(0)));
    let (sine, cosine) = (g.call(Function::Sin, vec![q]), g.call(Function::Cos, vec![q]));
    let (zero, one, minus) = (g.integer(0), g.integer(1), g.integer(-1));
    let square = g.power(l, 2);
    let mass = g.product([m, square]);
    let weight = g.product([minus, m, gravity, l, sine]);
    let forcing = g.sum([weight, tau]);
    let acceleration = g.div(forcing, mass);
    let half = g.number(Number::ratio(1, 2));
    let speed = g.power(u, 2);
    let energy = g.product([half, mass, speed]);
    // Velocity of the bob: l u (cos, sin, 0); the basis is n = -x, first = y, second = -z.
    let lc = g.product([l, cosine]);
    let ls = g.product([l, sine]);
    let normal = g.neg(lc);
    let (vx, vy) = (g.product([lc, u]), g.product([ls, u]));
    let vn = g.neg(vx);
    let px = ls;
    let py = g.neg(lc);
    let inverse = g.power(mass, -1);
    let products = [(normal, normal), (normal, ls), (ls, ls)].map(|(a, b)| g.product([a, b, inverse]));
    let responses = [normal, ls].map(|a| g.product([a, inverse]));
    let output = |quantity, rows, columns, nodes: Vec<_>| Output { quantity, rows, columns, values: nodes };
    let contact = |quantity, rows, columns, nodes| output(Q::Contact(0, quantity), rows, columns, nodes);
    let outputs = vec![
        output(Q::CoordinateRates, 1, 1, vec![u]),
        output(Q::MassMatrix, 1, 1, vec![mass]),
        output(Q::Forcing, 1, 1, vec![forcing]),
        output(Q::Accelerations, 1, 1, vec![acceleration]),
        output(Q::KineticEnergy, 1, 1, vec![energy]),
        output(Q::Point(1, PointQuantity::Position), 3, 1, vec![px, py, zero]),
        contact(ContactQuantity::Normal, 3, 1, vec![minus, zero, zero]),
        contact(ContactQuantity::First, 3, 1, vec![zero, one, zero]),
        contact(ContactQuantity::Second, 3, 1, vec![zero, zero, minus]),
        contact(ContactQuantity::Velocity, 3, 1, vec![vn, vy, zero]),
        contact(
            ContactQuantity::Reduced,
            6,
            1,
            vec![products[0], products[1], zero, products[2], zero, zero],
        ),
        contact(ContactQuantity::Response, 1, 3, vec![responses[0], responses[1], zero]),
    ];
    let guards = vec![Guard { value: mass, scale: None, message: "the bob has no inertia".into() }];
    Derived {
        graph: g,
        outputs,
        guards,
        structures: vec![Structure::Planar],
        samples: vec![],
        apart: vec![],
        solve: None,
    }
}

fn emitted() -> String {
    let krate = quote!(::hodograph);
    let options =
        Options { krate, module: "pendulum".into(), tracked: vec![], requests: Requests::default() };
    let tokens = module(&mechanism(), &Program::new(&derived()), &options).unwrap();
    prettyplease::unparse(&syn::parse2(tokens).expect("generated code is Rust"))
}

/// Compares with a reviewed file; `HODOGRAPH_GOLDEN=write cargo test -p hodograph-emit` rewrites it.
fn reviewed(name: &str, text: &str) {
    let folder = if name.ends_with(".derivation") { "../program" } else { "." };
    let path = format!("{}/{folder}/tests/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("HODOGRAPH_GOLDEN").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let reviewed = std::fs::read_to_string(&path).unwrap();
    assert!(text == reviewed, "{path} differs; look at the difference after HODOGRAPH_GOLDEN=write");
}

#[test]
fn the_module_is_the_reviewed_one() {
    reviewed("pendulum.rs", &emitted());
}

/// The structure of a reduced matrix selects the closed form that the collision calls.
#[test]
fn structure_selects_the_closed_form() {
    let call = |structure| {
        let derived = Derived { structures: vec![structure], ..derived() };
        let options = Options {
            krate: quote!(::hodograph),
            module: "pendulum".into(),
            tracked: vec![],
            requests: Requests::default(),
        };
        module(&mechanism(), &Program::new(&derived), &options).unwrap().to_string()
    };
    for (structure, marker) in [
        (Structure::Planar, "Planar"),
        (Structure::Balanced, "Balanced"),
        (Structure::Diagonal, "Diagonal"),
        (Structure::Isotropic, "Isotropic"),
    ] {
        assert!(
            call(structure)
                .contains(&format!("resolve_structured :: < :: hodograph :: structure :: {marker} , T >"))
        );
    }
    assert!(!call(Structure::General).contains("resolve_structured"));
}

/// Known parts of the surface are folded in, and the others become arguments; the structure selects the
/// closed form.
#[test]
fn known_parts_of_the_surface_are_folded_into_a_specialised_collision() {
    let name = |text: &str| quote::format_ident!("{text}");
    let emitted = |structure, contact: &str, law, e, budget| {
        let derived = Derived { structures: vec![structure], ..derived() };
        let asked = Specialised { name: name("strike"), contact: name(contact), law, mu: None, e, budget };
        let requests = Requests { specialised: vec![asked], ..Requests::default() };
        let options =
            Options { krate: quote!(::hodograph), module: "pendulum".into(), tracked: vec![], requests };
        let text = module(&mechanism(), &Program::new(&derived), &options)?.to_string();
        let method = text.split_once("pub fn strike").expect("a method").1;
        Ok::<String, String>(method.split("Collision {").next().unwrap_or_default().to_owned())
    };
    let contact = &mechanism().contacts[0].name;
    let contact = hodograph_model::rust_names::snake_case(contact);
    let text = emitted(Structure::Planar, &contact, Some("stronge"), Some(0.5), Some(8)).unwrap();
    assert!(text.contains("mu : T ,)") && text.contains(". with_budget (8u32)"), "{text}");
    assert!(text.contains(
        "resolve_structured_inlined :: < :: hodograph :: structure :: Planar , :: hodograph :: generated :: OneLaw < { :: hodograph :: Law :: Stronge . number () } > , T >"
    ));
    let text = emitted(Structure::General, &contact, None, None, None).unwrap();
    assert!(text.contains("mu : T , e : T , law : :: hodograph :: Law ,)"), "{text}");
    assert!(
        text.contains("resolve_inlined :: < :: hodograph :: generated :: AnyLaw , T >")
            && !text.contains("with_budget")
    );
    let error = emitted(Structure::General, "nobody", None, None, None).unwrap_err();
    assert!(error.contains("no contact `nobody`"), "{error}");
}

/// A value that depends on parameters alone, but is compared with one that depends on coordinates, is stored
/// for the routines that check it.
#[test]
fn a_guard_is_checked_where_all_of_it_is_known() {
    let mut derived = derived();
    let g = &mut derived.graph;
    let coordinate = g.input(Input::Coordinate(0));
    let scale = g.sum([derived.guards[0].value, coordinate]);
    derived.guards[0].scale = Some(scale);
    let options = Options {
        krate: quote!(::hodograph),
        module: "pendulum".into(),
        tracked: vec![],
        requests: Requests::default(),
    };
    let text = module(&mechanism(), &Program::new(&derived), &options).unwrap().to_string();
    let (before, check) = text.split_once("fn check (").expect("a check");
    let (check, after) = check.split_once("impl").expect("more");
    assert!(!before.contains("vanishes_beside") && !check.contains("q . q1"), "{check}");
    assert!(after.contains("vanishes_beside"));
}

/// A result that is a factor of another needs no check: the product is not finite either. Its reciprocal
/// needs one.
#[test]
fn only_results_that_no_other_depends_on_are_checked() {
    let mut derived = derived();
    let g = &mut derived.graph;
    let (q, u) = (g.input(Input::Coordinate(0)), g.input(Input::Speed(0)));
    let first = g.product([q, u]);
    let second = {
        let product = g.product([first, u]);
        g.sum([product, q])
    };
    let third = g.power(second, -1);
    derived.outputs.push(Output {
        quantity: Q::Point(1, PointQuantity::Velocity),
        rows: 3,
        columns: 1,
        values: vec![first, second, third],
    });
    let options = Options {
        krate: quote!(::hodograph),
        module: "pendulum".into(),
        tracked: vec![],
        requests: Requests::default(),
    };
    let text = module(&mechanism(), &Program::new(&derived), &options).unwrap().to_string();
    let (_, method) = text.split_once("pub fn velocity_p (").expect("the method");
    let (_, check) = method.split_once("all_finite ([").expect("a check");
    let (checked, after) = check.split_once("])").expect("its end");
    assert_eq!(checked.split(',').count(), 2, "{checked}");
    let checked: Vec<&str> = checked.split(',').map(str::trim).collect();
    let answer =
        method.split_once("from ([[").and_then(|(_, rest)| rest.split_once(']')).expect("an answer").0;
    let answer: Vec<&str> = answer.split(',').map(str::trim).collect();
    assert_eq!(checked, answer[1..], "{after}");
}

/// The same with at most three operations in a function.
#[test]
fn long_routines_come_in_parts() {
    let options = Options {
        krate: quote!(::hodograph),
        module: "pendulum_in_parts".into(),
        tracked: vec![],
        requests: Requests::default(),
    };
    let tokens = module_in_parts(&mechanism(), &Program::new(&derived()), &options, 3).unwrap();
    reviewed("pendulum_in_parts.rs", &prettyplease::unparse(&syn::parse2(tokens).expect("parts are Rust")));
}

/// The tests of the whole evaluate this derivation beside the reviewed module.
#[test]
fn the_derivation_is_the_reviewed_one() {
    reviewed("pendulum.derivation", &hodograph_program::artifact::encode(&Program::new(&derived()), "0"));
}

#[test]
fn the_same_program_gives_the_same_code() {
    assert_eq!(emitted(), emitted());
}

#[test]
fn a_foreign_program_is_refused() {
    let mut mechanism = mechanism();
    mechanism.coordinates.clear();
    let options = Options {
        krate: quote!(::hodograph),
        module: "x".into(),
        tracked: vec![],
        requests: Requests::default(),
    };
    let error = module(&mechanism, &Program::new(&derived()), &options).unwrap_err();
    assert!(error.contains("Coordinate(0)"), "{error}");
}

/// The interface and the Rust text declare the same methods and structs.
#[test]
fn the_interface_is_that_of_the_module() {
    let file: syn::File = syn::parse_str(&emitted()).unwrap();
    let syn::Item::Mod(module) = &file.items[0] else { panic!("a module") };
    let items = &module.content.as_ref().unwrap().1;
    let krate = quote!(::hodograph);
    let text =
        |tokens: TokenStream| tokens.to_string().replace(' ', "").replace(",)", ")").replace(",>", ">");

    let mut declared = BTreeMap::new();
    for item in items {
        let syn::Item::Impl(block) = item else { continue };
        let of_mechanism = text(quote!(#block)).contains("forPendulum<T>") || block.trait_.is_some();
        for item in block.items.iter().filter(|_| !of_mechanism) {
            if let syn::ImplItem::Fn(method) = item
                && matches!(method.vis, syn::Visibility::Public(_))
                && let Some(syn::FnArg::Receiver(_)) = method.sig.inputs.first()
            {
                let taken = method.sig.inputs.iter().skip(1).map(|argument| text(quote!(#argument)));
                let answer = &method.sig.output;
                declared.insert(method.sig.ident.to_string(), (taken.collect(), text(quote!(#answer))));
            }
        }
    }
    // methods that construct, read and change a mechanism or an outcome are not routines
    declared.retain(|name, _| !["parameters", "set_parameters", "outcome"].contains(&name.as_str()));

    let offered = interface(&mechanism(), &Program::new(&derived()), "pendulum").unwrap();
    let methods: BTreeMap<String, (Vec<String>, String)> = offered
        .methods
        .iter()
        .flat_map(|method| {
            let each = |argument| text(offers::declared(std::slice::from_ref(argument), &krate));
            let taken = method.arguments.iter().map(each).map(|taken| taken.trim_end_matches(',').to_owned());
            let taken: Vec<String> = taken.collect();
            let in_place = method.in_place.as_ref().map(|in_place| {
                let out = format!("out:&mut{}", text(method.answer.tokens(&krate)));
                let failure = text(method.failure.tokens(&krate));
                let result = format!("->::core::result::Result<(),{failure}>");
                (in_place.into.to_string(), (taken.iter().cloned().chain([out]).collect(), result))
            });
            let by_value =
                (method.name.clone(), (taken.clone(), format!("->{}", text(method.result(&krate)))));
            [Some(by_value), in_place].into_iter().flatten()
        })
        .collect();
    assert_eq!(methods, declared);
    assert_eq!(methods.len(), 18);

    let fields = |item: &syn::Item| match item {
        syn::Item::Struct(record) => {
            let of = |field: &syn::Field| field.ident.as_ref().map(ToString::to_string);
            Some((record.ident.to_string(), record.fields.iter().filter_map(of).collect::<Vec<_>>()))
        }
        _ => None,
    };
    let mut declared: BTreeMap<String, Vec<String>> = items.iter().filter_map(fields).collect();
    let own = declared.remove("Pendulum").expect("the mechanism's type");
    assert_eq!(own, ["parameters", "hoisted"]);
    let names = |record: &Struct| record.names().into_iter().map(str::to_owned).collect();
    let structures = offered.structures.iter().map(|record| (record.name.clone(), names(record)));
    assert_eq!(structures.collect::<BTreeMap<_, _>>(), declared);
}
