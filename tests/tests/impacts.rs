//! Collisions of emitted modules agree with outcomes computed elsewhere (see `tests/data/README.md`), those
//! of the paper among them.

use crate::common::emitted::{Emitted, Hit, emitted};
use crate::common::{Model, Reference, number, references, root};
use hodograph::{Law, ReducedMatrix, Surface};
use nalgebra::Vector3;
use serde_json::Value;

#[test]
fn reference_outcomes() {
    let modules = emitted();
    let mut compared = 0;
    for reference in references() {
        let path = root().join("tests/data/reference/impacts").join(format!("{}.json", reference.name));
        let Ok(text) = std::fs::read_to_string(path) else { continue };
        let data: Value = serde_json::from_str(&text).expect("JSON");
        let module = modules.iter().find(|module| module.name() == reference.name).expect("a module");
        for impact in data["impacts"].as_array().expect("impacts") {
            compared += outcomes(&**module, &reference, impact);
        }
    }
    assert_eq!(compared, 96, "of 108; the others are wedged");
}

fn outcomes(module: &dyn Emitted, reference: &Reference, impact: &Value) -> usize {
    let model = Model::load(&reference.name);
    let state = &reference.states()[impact["state"].as_u64().expect("a state") as usize];
    let at = reference.inputs(&model, state);
    let contact = impact["contact"].as_str().expect("a contact");
    let contact = model.mechanism.contacts.iter().position(|c| c.name == contact).expect("the contact");
    let (mu, e) = (number(&impact["mu"]), number(&impact["e"]));
    // Where the reference itself is known to fewer digits only.
    let bound = if impact["degenerate"].is_null() { 1e-10 } else { 1e-7 };
    let mut compared = 0;
    for &law in Law::ALL {
        let key = law.name();
        let expected = &impact[key];
        let place = format!("{} mu {mu} e {e} {key}", reference.name);
        let hit = module.collide(contact, &at, &Surface { mu, e, law });
        if expected["end"].is_null() {
            // Wedged. Only Poisson's hypothesis has an outcome then: the bodies stay in contact.
            match hit {
                Ok(hit) if law == Law::Poisson => {
                    assert!(hit.separation[0].abs() < 1e-10, "{place}: {hit:?}")
                }
                Ok(hit) => panic!("{place}: {hit:?}"),
                Err(message) => assert!(message.contains("wedge"), "{place}: {message}"),
            }
            continue;
        }
        compare(&place, &hit.unwrap_or_else(|message| panic!("{place}: {message}")), expected, bound);
        compared += 1;
    }
    compared
}

fn compare(place: &str, hit: &Hit, expected: &Value, bound: f64) {
    let of = |keys: [&str; 3]| Vector3::from(keys.map(|key| number(&expected[key])));
    let impulse = of(["I_n", "I_t", "I_s"]);
    let velocity = of(["v_n2", "v_t2", "v_s2"]);
    let speed = velocity.norm() + Vector3::from(hit.approach).norm();
    let near = |what: &str, ours: f64, theirs: f64, scale: f64| {
        assert!((ours - theirs).abs() <= bound * scale, "{place}: {what} {ours} {theirs}\n{hit:?}");
    };
    for i in 0..3 {
        near("impulse", hit.impulse[i], impulse[i], impulse.norm());
        near("velocity", hit.separation[i], velocity[i], speed);
    }
    near("work", hit.contact_work, number(&expected["dE"]), impulse.norm() * speed);
    near("normal work", hit.normal_work, number(&expected["E_n"]), impulse.norm() * speed);
}

/// Table of the two sleds, `docs/assumptions.md`: mu, law, then I_n2, v_n2, v_t2, v_s2 with s = t x n, and
/// dE.
const NINE: [(f64, Law, [f64; 5], &str); 9] = [
    (0.6, Law::Newton, [8.971948198, 0.7568864176, -0.3248973871, -0.3281050863, -1.436743011], "sliding"),
    (0.6, Law::Poisson, [6.152383187, 0.403583274, -0.1574039107, -0.161284564, -2.491550657], "sliding"),
    (0.6, Law::Stronge, [7.013981068, 0.5115321742, -0.2088974513, -0.2119217875, -2.232487328], "sliding"),
    (
        1.1,
        Law::Newton,
        [19.45541188, 0.7568864176, -0.1862359917, -0.1799531581, 1.375248751],
        "sliding, renewal",
    ),
    (
        1.1,
        Law::Poisson,
        [4.921769084, 0.1397178113, -0.02287165415, -0.02210005895, -2.815883679],
        "sliding, renewal",
    ),
    (
        1.1,
        Law::Stronge,
        [7.988210862, 0.2699337265, -0.0573397663, -0.05540535927, -2.375912802],
        "sliding, renewal",
    ),
    (1.6, Law::Newton, [32.85398885, 0.7568864176, 0.0, 0.0, 9.162923556], "sliding, sticking"),
    (1.6, Law::Poisson, [4.037396922, 0.08032111863, 0.0, 0.0, -2.899810409], "sliding, sticking"),
    (1.6, Law::Stronge, [8.486951889, 0.1847892144, 0.0, 0.0, -2.309998909], "sliding, sticking"),
];

/// The nine outcomes with the reduced matrix and velocity of the paper's example rounded to eight digits.
#[test]
fn nine_outcomes_of_the_two_sleds() {
    let m = ReducedMatrix::new(0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211);
    let v = Vector3::new(-0.946108022, 1.06306701, 0.0);
    for (mu, law, [i_n, v_n, v_t, v_s, work], path) in NINE {
        let hit = hodograph::solve(&m, &v, &Surface { mu, e: 0.8, law }).expect("an outcome");
        let pairs = [
            (hit.impulse.x, i_n),
            (hit.velocity.x, v_n),
            (hit.velocity.y, v_t),
            (hit.velocity.z, v_s),
            (hit.contact_work, work),
        ];
        for (ours, theirs) in pairs {
            assert!((ours - theirs).abs() <= 1e-9 * theirs.abs().max(1.0), "{mu} {law:?}: {ours} {theirs}");
        }
        assert_eq!(hit.path.phases().join(", "), path);
    }
}
