//! Mechanisms of parts, derived: against the numeric evaluation, against the same mechanism written out by
//! hand, and as a module.

use crate::common::Model;
use crate::common::random::samples;
use hodograph_generator::program::{ContactQuantity as C, Quantity as Q};

hodograph::mechanism!("data/parts/chain.mech");

fn model(name: &str) -> Model {
    Model::load(&format!("../tests/data/{name}"))
}

/// The largest difference over the largest number.
fn difference(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let top = theirs.iter().fold(1e-3_f64, |top, x| top.max(x.abs()));
    ours.iter().zip(theirs).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / top
}

#[test]
fn derived_parts_are_what_the_numeric_evaluation_says() {
    for name in ["parts/chain", "parts/hand", "parts/quadruped"] {
        let model = model(name);
        let mut worst = 0.0_f64;
        for sample in samples(&model, 10) {
            let get = |quantity| model.get(&sample.inputs, quantity).values;
            worst = worst.max(difference(&get(Q::MassMatrix), &sample.numeric.mass_matrix.concat()));
            worst = worst.max(difference(&get(Q::Forcing), &sample.numeric.forcing));
            for (i, contact) in sample.numeric.contacts.iter().enumerate() {
                let normal = get(Q::Contact(i as u32, C::Normal));
                worst = worst.max(difference(&normal, &contact.normal));
            }
        }
        println!("{name}: {worst:.1e}");
        assert!(worst < 1e-13, "{name}: {worst:e}");
    }
}

/// The legs of the quadruped stand in the same order in both, and so do coordinates, speeds and parameters
/// that both have.
#[test]
fn a_quadruped_of_parts_is_the_one_that_is_written_out() {
    let (parts, by_hand) = (model("parts/quadruped"), model("many_contacts/quadruped"));
    assert_eq!(parts.mechanism.coordinates.len(), by_hand.mechanism.coordinates.len());
    let lines = |model: &Model| model.text.lines().filter(|line| !line.trim().is_empty()).count();
    let leg = std::fs::read_to_string(crate::common::root().join("tests/data/parts/leg.mech")).unwrap();
    assert!(lines(&parts) + leg.lines().count() <= 90, "{} {}", lines(&parts), leg.lines().count());
    let names = |model: &Model| -> Vec<String> {
        model.mechanism.parameters.iter().map(|parameter| parameter.name.clone()).collect()
    };
    assert_eq!(names(&parts), names(&by_hand));
    let (mut worst, mut equal, mut all) = (0.0_f64, 0, 0);
    for sample in samples(&by_hand, 50) {
        for quantity in
            [Q::Accelerations, Q::MassMatrix, Q::Forcing, Q::Contact(0, C::Gap), Q::Contact(3, C::Reduced)]
        {
            let (ours, theirs) =
                (parts.get(&sample.inputs, quantity).values, by_hand.get(&sample.inputs, quantity).values);
            worst = worst.max(difference(&ours, &theirs));
            equal += ours.iter().zip(&theirs).filter(|(a, b)| a == b).count();
            all += ours.len();
        }
    }
    println!("worst {worst:.1e}, {equal} of {all} numbers have the same bits");
    assert!(worst < 1e-12, "{worst:e}");
}

#[test]
fn fields_of_the_module_are_called_after_the_instances() {
    use chain::{Chain, Coordinates, Parameters, Speeds};
    let q = Coordinates { link_1_q: 0.3, ..Coordinates::default() };
    assert_eq!(q.link_5_q, 0.1);
    let u = Speeds { link_1_u: 0.0, link_2_u: 0.0, link_3_u: 0.0, link_4_u: 0.0, link_5_u: 1.0 };
    let soft = Chain::<f64>::default();
    let stiff = Chain::new(Parameters { link_3_stiffness: 50.0, ..Parameters::default() }).unwrap();
    let rates = |chain: &Chain<f64>| chain.accelerations(&q, &u).unwrap().link_3_u;
    assert!(rates(&stiff) < rates(&soft) - 1.0, "{} {}", rates(&stiff), rates(&soft));
    // the end of the chain, by geometry
    let angles = [0.3, 0.4, 0.5, 0.6, 0.7];
    let x: f64 = angles.iter().map(|angle: &f64| 0.2 * angle.sin()).sum();
    assert!((soft.gap_tip_wall(&q).unwrap() - (0.8 - x)).abs() < 1e-14);
}
