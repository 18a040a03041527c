//! Values of many states: columns, and lanes of generated modules, against the generated module one state at a
//! time, in turns in one process and thread. What counts is the ratio: all are measured under the same load, and
//! the best of many turns is taken. With `--seconds` it prints the time of the forward dynamics of the generated
//! quadruped alone, s a state, for `bindings/python/throughput`.

use std::hint::black_box;
use std::time::Instant;

use hodograph::lanes::{F64x4, F64x8, Lanes};
use hodograph_generator::interpret::columns::LANES;
use hodograph_generator::program::Quantity;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Column, Table};

/// The module of the model in this folder, with 18 speeds, and that of an arm with seven joints.
#[allow(missing_docs)]
mod generated {
    hodograph::mechanism!("quadruped.mech");
    hodograph::mechanism!("../../../models/arm_7dof.mech");
}

use generated::{arm_7dof, quadruped};

/// States in a turn.
const ROWS: usize = 2048;
const TURNS: usize = 40;

/// A number between -1 and 1.
fn number(row: usize, index: usize) -> f64 {
    ((row * 71 + index * 13 + 5) as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0
}

/// Numbers of all states around those of the start.
fn numbers<const N: usize>(start: [f64; N], by: f64) -> Vec<[f64; N]> {
    (0..ROWS).map(|row| std::array::from_fn(|i| start[i] + by * number(row, i))).collect()
}

/// Time of a call, s.
fn timed(call: impl FnOnce()) -> f64 {
    let start = Instant::now();
    call();
    start.elapsed().as_secs_f64()
}

/// A way to the answers for all states, and its name.
type Way<'w, const P: usize> = (&'w str, &'w mut dyn FnMut(&mut [[f64; P]]));

/// The best times of the ways, s, which give the same bits.
fn measured<const P: usize>(ways: &mut [Way<'_, P>]) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; ways.len()];
    let mut answers = vec![vec![[0.0; P]; ROWS]; ways.len()];
    for _ in 0..TURNS {
        for (((_, way), best), answers) in ways.iter_mut().zip(&mut best).zip(&mut answers) {
            *best = best.min(timed(|| way(black_box(answers))));
        }
    }
    let bits = |answers: &[[f64; P]]| -> Vec<u64> {
        answers.as_flattened().iter().map(|number| number.to_bits()).collect()
    };
    for (of_way, (name, _)) in answers.iter().zip(ways) {
        assert_eq!(bits(&answers[0]), bits(of_way), "{name}");
    }
    best
}

/// Prints the throughput of each way over that of the first.
fn told<const P: usize>(what: &str, ways: &mut [Way<'_, P>], times: &[f64]) {
    for ((name, _), time) in ways.iter().zip(times).skip(1) {
        println!("{what}: throughput of {name} over one by one: {:.2}", times[0] / time);
    }
}

/// A routine of a generated module, one by one and in lanes: `numbers` makes an array of its answer.
macro_rules! routine {
    ($name:ident: $module:ident, $machine:ident, $q:literal, $u:literal, $routine:ident($($inputs:ident)?), |$answer:ident| $numbers:expr) => {
        mod $name {
            use super::$module::*;
            use super::Lanes;

            /// Coordinates and speeds of all states.
            pub struct States {
                pub q: Vec<[f64; $q]>,
                pub u: Vec<[f64; $u]>,
            }

            pub fn one_by_one(machine: &$machine<f64>, states: &States, answers: &mut [[f64; $u]]) {
                for (row, answer) in answers.iter_mut().enumerate() {
                    let (q, u) = (Coordinates::from(states.q[row]), Speeds::from(states.u[row]));
                    let $answer = machine.$routine(&q, &u $(, &$inputs::default())?).expect("regular");
                    *answer = $numbers;
                }
            }

            pub fn in_lanes<L: Lanes>(machine: &$machine<L>, states: &States, answers: &mut [[f64; $u]]) {
                $(let inputs = $inputs::<L>::from_lanes(|_| $inputs::default());)?
                for (block, answers) in answers.chunks_exact_mut(L::COUNT).enumerate() {
                    let first = block * L::COUNT;
                    let q = Coordinates::<L>::from_lanes(|lane| states.q[first + lane].into());
                    let u = Speeds::<L>::from_lanes(|lane| states.u[first + lane].into());
                    let $answer = machine.$routine(&q, &u $(, routine!(reference $inputs inputs))?).expect("regular");
                    let numbers: [L; $u] = $numbers;
                    for (lane, answer) in answers.iter_mut().enumerate() {
                        *answer = numbers.map(|number| number.lane(lane));
                    }
                }
            }
        }
    };
    (reference $inputs:ident $name:ident) => { &$name };
}

routine!(dynamics: quadruped, Anymal, 19, 18, accelerations(Inputs), |answer| answer.into());
routine!(arm: arm_7dof, Arm7dof, 7, 7, accelerations(), |answer| answer.into());
routine!(derivatives: arm_7dof, Arm7dof, 7, 7, accelerations_derivatives(), |answer| {
    let sum = answer.by_coordinates.column(6) + answer.by_speeds.column(0) + answer.value;
    let [sum] = sum.data.0;
    sum
});

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/quadruped.mech");
    let interpreted = InterpretedMechanism::read(model.as_ref())?;
    let machine = quadruped::Anymal::<f64>::default();
    let start = quadruped::Coordinates::default().into();
    let states = dynamics::States { q: numbers(start, 0.4), u: numbers([0.0; 18], 2.0) };
    let columns = interpreted.columns(&[Quantity::Accelerations]);
    let inputs = [[0.0; 18]; ROWS];
    let table = Table {
        rows: ROWS,
        coordinates: Column::of_rows(states.q.as_flattened(), 19),
        speeds: Column::of_rows(states.u.as_flattened(), 18),
        inputs: Column::of_rows(inputs.as_flattened(), 18),
        ..Table::default()
    };
    let four = quadruped::Anymal::<F64x4>::from_lanes(|_| machine);
    let eight = quadruped::Anymal::<F64x8>::from_lanes(|_| machine);
    let mut failures = vec![None; ROWS];
    let mut by_columns = |answers: &mut [[f64; 18]]| {
        columns.by_rows(&table, 0..ROWS, answers.as_flattened_mut(), &mut failures);
        assert!(failures.iter().all(Option::is_none), "all states are regular");
    };
    let ways: &mut [Way<'_, 18>] = &mut [
        ("one by one", &mut |answers| dynamics::one_by_one(&machine, &states, answers)),
        ("columns", &mut by_columns),
        ("four lanes", &mut |answers| dynamics::in_lanes(&four, &states, answers)),
        ("eight lanes", &mut |answers| dynamics::in_lanes(&eight, &states, answers)),
    ];
    let times = measured(ways);
    if std::env::args().any(|argument| argument == "--seconds") {
        println!("{:e}", times[0] / ROWS as f64);
        return Ok(());
    }
    println!("{ROWS} states a turn, one thread, the same bits");
    println!("slots of a block of columns: {} ({} kB)", columns.slots(), columns.slots() * 8 * LANES / 1024);
    told("forward dynamics of the quadruped", ways, &times);

    let machine = arm_7dof::Arm7dof::<f64>::default();
    let four = arm_7dof::Arm7dof::<F64x4>::from_lanes(|_| machine);
    let eight = arm_7dof::Arm7dof::<F64x8>::from_lanes(|_| machine);
    let (q, u) = (numbers([0.0; 7], 3.0), numbers([0.0; 7], 2.0));
    let states = arm::States { q, u };
    let ways: &mut [Way<'_, 7>] = &mut [
        ("one by one", &mut |answers| arm::one_by_one(&machine, &states, answers)),
        ("four lanes", &mut |answers| arm::in_lanes(&four, &states, answers)),
        ("eight lanes", &mut |answers| arm::in_lanes(&eight, &states, answers)),
    ];
    let times = measured(ways);
    told("forward dynamics of the arm", ways, &times);
    let states = derivatives::States { q: states.q, u: states.u };
    let ways: &mut [Way<'_, 7>] = &mut [
        ("one by one", &mut |answers| derivatives::one_by_one(&machine, &states, answers)),
        ("four lanes", &mut |answers| derivatives::in_lanes(&four, &states, answers)),
        ("eight lanes", &mut |answers| derivatives::in_lanes(&eight, &states, answers)),
    ];
    let times = measured(ways);
    told("derivatives of the arm's accelerations", ways, &times);
    Ok(())
}
