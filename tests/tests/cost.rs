//! Compares the numbers of operations of derived programs with those of other generators.

use crate::common::Model;
use hodograph_generator::arithmetic::Function;
use hodograph_generator::program::operation::{Operation, Stage, Value};
use hodograph_generator::program::{ContactQuantity, Quantity};

/// Inverse dynamics of the Stanford arm took Kane and Levinson 646 multiplications and 394 additions (1983,
/// by hand).
#[test]
fn inverse_dynamics_of_the_stanford_arm() {
    let model = Model::load("stanford_arm");
    let stages = model.program.stages();
    let (mut products, mut sums) = (0, 0);
    for value in model.program.slice(&[Quantity::InverseDynamics]).order {
        // What depends on parameters alone is computed once, at construction.
        if stages[value.index()] <= Stage::Parameter {
            continue;
        }
        match model.program.operation(value) {
            Operation::Mul(..) | Operation::Div(..) | Operation::Recip(..) => products += 1,
            Operation::Add(..) | Operation::Sub(..) | Operation::Neg(..) => sums += 1,
            Operation::MulAdd(..) | Operation::MulSub(..) | Operation::NegMulAdd(..) => {
                products += 1;
                sums += 1;
            }
            _ => {}
        }
    }
    assert!(products < 646 && sums < 394, "{products} multiplications, {sums} additions");
    assert!(products < 200 && sums < 150, "more than before: {products} multiplications, {sums} additions");
}

/// The mass matrix of two links depends on the angle between them, and takes no other sine or cosine.
#[test]
fn mass_matrix_of_the_double_pendulum() {
    let model = Model::load("../tests/models/dpend");
    let operations = model.program.slice(&[Quantity::MassMatrix]).order;
    let round = |value: &&_| {
        matches!(
            model.program.operation(**value),
            Operation::SinCos(_) | Operation::Call(Function::Sin | Function::Cos, _)
        )
    };
    assert_eq!(operations.iter().filter(round).count(), 1);
}

/// The gaps and validities of all 52 contacts of two boxes, in one pass and one by one, and their clearance: docs/theory.md,
/// 16.10 and 16.14.
#[test]
fn gaps_of_two_boxes() {
    let model = Model::load("../simulation/models/crate_on_table");
    let stages = model.program.stages();
    let near = |contact: u32| {
        [ContactQuantity::Gap, ContactQuantity::Validity].map(|of| Quantity::Contact(contact, of))
    };
    let count = |quantities: &[Quantity]| {
        let order = model.program.slice(quantities).order;
        let computed = |value: &&Value| {
            stages[value.index()] > Stage::Parameter
                && !matches!(model.program.operation(**value), Operation::Input(_))
        };
        order.iter().filter(computed).count()
    };
    let together = count(&(0..52).flat_map(near).collect::<Vec<_>>());
    let alone: usize = (0..52).map(|contact| count(&near(contact))).sum();
    println!("{together} operations together, {alone} alone");
    assert!(together < 2600 && alone > 15_000, "{together} together, {alone} alone");
    // of boxes that are apart only this is computed, once its two radii are known
    let clearance = count(&[Quantity::Contact(0, ContactQuantity::Clearance)]);
    println!("{clearance} operations for the clearance");
    assert!(clearance < 20, "{clearance}");
}
