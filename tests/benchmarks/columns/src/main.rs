//! Forward dynamics of a quadruped with 18 speeds: many states at once against the generated module, in turns
//! in one process and thread. What counts is the ratio: both are measured under the same load, and the best
//! of many turns is taken. With `--seconds` it prints the time of the generated module alone, s a state, for
//! `bindings/python/throughput`.

use std::hint::black_box;
use std::time::Instant;

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_generator::interpret::columns::LANES;
use hodograph_generator::program::Quantity;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Column, Table};

/// The module of the model in this folder.
#[allow(missing_docs)]
mod generated {
    hodograph::mechanism!("quadruped.mech");
}

/// States in a turn.
const ROWS: usize = 2048;
const TURNS: usize = 40;

/// A number between -1 and 1.
fn number(row: usize, index: usize) -> f64 {
    ((row * 71 + index * 13 + 5) as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0
}

/// Time of a call, s.
fn timed(call: impl FnOnce()) -> f64 {
    let start = Instant::now();
    call();
    start.elapsed().as_secs_f64()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/quadruped.mech");
    let interpreted = InterpretedMechanism::read(model.as_ref())?;
    let generated = generated::quadruped::Anymal::<f64>::default();
    let generated: &dyn Mechanism = &generated;
    let [n, p, w] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
        .map(|kind| generated.count(kind));
    let (mut start, mut u, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
    generated.initial_state(&mut start, &mut u, &mut inputs)?;
    let matrix = |width: usize, by: f64| -> Vec<f64> {
        (0..ROWS * width).map(|place| by * number(place / width, place % width)).collect()
    };
    let mut q = matrix(n, 0.4);
    q.iter_mut().enumerate().for_each(|(place, number)| *number += start[place % n]);
    let (u, inputs) = (matrix(p, 2.0), matrix(w, 3.0));
    let columns = interpreted.columns(&[Quantity::Accelerations]);
    let table = Table {
        rows: ROWS,
        coordinates: Column::of_rows(&q, n),
        speeds: Column::of_rows(&u, p),
        inputs: Column::of_rows(&inputs, w),
        ..Table::default()
    };
    let mut one_by_one = vec![0.0; ROWS * p];
    let (mut together, mut failures) = (vec![0.0; ROWS * p], vec![None; ROWS]);
    let (mut best, mut best_together) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..TURNS {
        best = best.min(timed(|| {
            for (row, answer) in one_by_one.chunks_exact_mut(p).enumerate() {
                let state = State {
                    time: 0.0,
                    coordinates: &q[row * n..(row + 1) * n],
                    speeds: &u[row * p..(row + 1) * p],
                    inputs: &inputs[row * w..(row + 1) * w],
                };
                if generated.accelerations(&state, answer).is_err() {
                    answer.fill(f64::NAN);
                }
            }
            black_box(&mut one_by_one);
        }));
        best_together = best_together.min(timed(|| {
            columns.by_rows(&table, 0..ROWS, &mut together, &mut failures);
            black_box(&mut together);
        }));
    }
    assert!(failures.iter().all(Option::is_none), "all states are regular");
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&one_by_one), bits(&together), "the same bits");
    if std::env::args().any(|argument| argument == "--seconds") {
        println!("{:e}", best / ROWS as f64);
        return Ok(());
    }
    println!("forward dynamics of the quadruped, {ROWS} states a turn, one thread, the same bits");
    println!("slots of a block: {} ({} kB)", columns.slots(), columns.slots() * 8 * LANES / 1024);
    println!("throughput of columns over that of the generated module: {:.2}", best / best_together);
    Ok(())
}
