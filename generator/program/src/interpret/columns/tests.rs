//! Compares columns with [`Prepared`]: the same bits and the same errors.

use super::*;
use crate::artifact;
use crate::interpret::constants::Constants;
use crate::interpret::prepared::{Arguments, Failed, Prepared};
use crate::program::operation::{Bits, Operation as O, Value};
use crate::program::{Guard, Output, Program, Quantity, graph::Input};

/// A program with every form of every operation, and with guards whose scale varies or is constant.
fn program() -> Program {
    use hodograph_model::arithmetic::Function as F;
    let mut operations = vec![
        O::Input(Input::Parameter(0)),
        O::Constant(Bits::new(0.75)),
        O::Input(Input::Coordinate(0)),
        O::Input(Input::Speed(0)),
        O::Input(Input::Time),
    ];
    let [p, k, q, u, t] = [0, 1, 2, 3, 4].map(Value);
    let mut results = vec![p, k, q, u, t];
    let mut add = |operation| {
        operations.push(operation);
        Value(operations.len() as u32 - 1)
    };
    for make in [O::Add, O::Sub, O::Mul, O::Div] {
        results.extend([(q, u), (q, p), (k, u), (t, t)].map(|(a, b)| add(make(a, b))));
    }
    for make in [O::MulAdd, O::MulSub, O::NegMulAdd] {
        let all = [(q, u, t), (q, p, t), (p, q, u), (q, u, k), (q, p, k), (k, u, p), (p, k, t), (q, q, q)];
        results.extend(all.map(|(a, b, c)| add(make(a, b, c))));
    }
    let (both, only_cosine) = (add(O::SinCos(q)), add(O::SinCos(u)));
    results.extend([add(O::Cosine(both)), add(O::Sine(both)), add(O::Cosine(only_cosine))]);
    for function in [F::Sin, F::Cos, F::Tan, F::Atan, F::Exp, F::Sinh, F::Cosh, F::Tanh, F::Abs, F::Sign] {
        results.push(add(O::Call(function, u)));
    }
    for function in [F::Atan2, F::Min, F::Max] {
        results.extend([(q, u), (q, k), (p, t)].map(|(a, b)| add(O::Call2(function, a, b))));
    }
    results.extend([add(O::Neg(q)), add(O::Recip(u))]);
    let difference = add(O::Sub(q, u));
    results.push(difference);
    let guard = |value, scale, message: &str| Guard { value, scale, message: message.into() };
    Program {
        outputs: vec![Output {
            quantity: Quantity::Forcing,
            rows: results.len(),
            columns: 1,
            values: results,
        }],
        operations,
        guards: vec![
            guard(u, None, "u"),
            guard(difference, Some(q), "beside a coordinate"),
            guard(t, Some(k), "beside a constant"),
            guard(p, Some(t), "a parameter beside the time"),
        ],
        structures: Vec::new(),
    }
}

/// A program whose results are sums, differences and products of which nobody reads the parts, in all orders.
fn program_of_sums() -> Program {
    let mut operations = vec![
        O::Input(Input::Parameter(0)),
        O::Constant(Bits::new(-0.75)),
        O::Constant(Bits::new(0.0)),
        O::Input(Input::Coordinate(0)),
        O::Input(Input::Speed(0)),
        O::Input(Input::Time),
    ];
    let mut random = 1_u64;
    let mut number = |below: u64| {
        random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (random >> 33) % below
    };
    let mut results = Vec::new();
    for _ in 0..400 {
        let mut sum = Value(number(6) as u32);
        for _ in 0..2 + number(6) {
            let [a, b] = [0; 2].map(|_| Value(number(6) as u32));
            operations.push(match number(10) {
                0 => O::Add(sum, a),
                1 => O::Add(a, sum),
                2 => O::Sub(sum, a),
                3 => O::Sub(a, sum),
                4 => O::Mul(a, b),
                5 => O::Mul(a, sum),
                6 => O::MulAdd(a, b, sum),
                7 => O::MulSub(a, b, sum),
                8 => O::NegMulAdd(a, b, sum),
                _ => O::MulAdd(a, sum, b),
            });
            sum = Value(operations.len() as u32 - 1);
        }
        results.push(sum);
    }
    let output = Output { quantity: Quantity::Forcing, rows: results.len(), columns: 1, values: results };
    Program { outputs: vec![output], operations, guards: Vec::new(), structures: Vec::new() }
}

/// States with every kind of failure among states that have results.
fn states(rows: usize) -> [Vec<f64>; 3] {
    let number = |row: usize, step: f64| (row as f64 * step).sin() * 3.0;
    let mut all =
        [0.611, 0.173, 0.377].map(|step| (0..rows).map(|row| number(row + 1, step)).collect::<Vec<_>>());
    let mut set = |row: usize, values: [f64; 3]| {
        if row < rows {
            all.iter_mut().zip(values).for_each(|(column, value)| column[row] = value);
        }
    };
    set(3, [f64::NAN, 1.0, 1.0]);
    set(5, [1.0, f64::NAN, 1.0]);
    set(6, [0.5, 0.0, 1.0]);
    set(7, [0.5, 0.5, 1.0]);
    set(11, [0.5, 0.7, 1e-300]);
    set(12, [0.5, 0.7, f64::INFINITY]);
    set(13, [0.5, 0.7, 1e300]);
    set(14, [1e9, 1e-320, 1.0]);
    set(31, [f64::INFINITY, 1.0, 1.0]);
    set(32, [0.0, 0.0, 0.0]);
    all
}

fn compared(program: &Program, constants: &Constants, quantities: &[Quantity], rows: usize) -> [usize; 2] {
    let prepared = Prepared::new(program, constants, quantities);
    let columns = Columns::new(program, constants, quantities);
    assert_eq!(columns.len(), prepared.len());
    let [q, u, t] = states(rows);
    let column = |numbers| vec![Column::new(numbers)];
    let table = Table {
        rows,
        time: Some(Column::new(&t)),
        coordinates: column(&q),
        speeds: column(&u),
        ..Table::default()
    };
    let mut numbers = vec![0.0; rows * columns.len()];
    let mut failures = vec![None; rows];
    columns.by_rows(&table, 0..rows, &mut numbers, &mut failures);
    let mut stored = vec![vec![0.0; rows]; columns.len()];
    let mut again = vec![None; rows];
    let mut slices: Vec<&mut [f64]> = stored.iter_mut().map(Vec::as_mut_slice).collect();
    columns.by_columns(&table, 0..rows, &mut slices, &mut again);
    assert_eq!(failures, again);
    for row in 0..rows {
        let arguments = Arguments {
            time: t[row],
            coordinates: &q[row..=row],
            speeds: &u[row..=row],
            ..Arguments::default()
        };
        let mut expected = vec![f64::NAN; prepared.len()];
        let outcome = prepared.evaluate(&arguments, |index, number| expected[index] = number);
        assert_eq!(failures[row], outcome.err(), "row {row}");
        for (result, expected) in expected.iter().enumerate() {
            let found = numbers[row * columns.len() + result];
            assert_eq!(found.to_bits(), stored[result][row].to_bits());
            let same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
            assert!(same, "row {row}, result {result}: {found} {expected}");
        }
    }
    [true, false].map(|failed| failures.iter().filter(|failure| failure.is_some() == failed).count())
}

#[test]
fn every_operation_and_every_error_are_those_of_one_state() {
    let program = program();
    let constants = Constants::new(&program, &[1.3]);
    for rows in [0, 1, 7, 8, 9, 63, 64, 65, 150] {
        let [failed, fine] = compared(&program, &constants, &[Quantity::Forcing], rows);
        assert!(rows < 33 || failed == 10 && fine == rows - 10, "{rows}: {failed} {fine}");
    }
}

#[test]
fn sums_have_the_bits_of_their_steps() {
    let program = program_of_sums();
    let constants = Constants::new(&program, &[1.3]);
    let columns = Columns::new(&program, &constants, &[Quantity::Forcing]);
    let chains = columns.runs.iter().filter(|run| run.code == steps::Code::Chain);
    let chains: usize = chains.map(|run| run.steps.len()).sum();
    assert!(chains > 200 && columns.terms.len() > 700, "{chains} {}", columns.terms.len());
    for rows in [1, 33, 150] {
        compared(&program, &constants, &[Quantity::Forcing], rows);
    }
}

#[test]
fn other_parameters() {
    let program = program();
    let constants = Constants::new(&program, &[1.3]);
    let mut columns = Columns::new(&program, &constants, &[Quantity::Forcing]);
    columns.refresh(&Constants::new(&program, &[-0.4]));
    let fresh = Columns::new(&program, &Constants::new(&program, &[-0.4]), &[Quantity::Forcing]);
    let of = |columns: &Columns| {
        let table = Table {
            rows: 1,
            time: Some(Column::new(&[0.2])),
            coordinates: vec![Column::new(&[0.3])],
            speeds: vec![Column::new(&[0.7])],
            ..Table::default()
        };
        let (mut numbers, mut failures) = (vec![0.0; columns.len()], [None]);
        columns.by_rows(&table, 0..1, &mut numbers, &mut failures);
        assert_eq!(failures, [None]);
        numbers
    };
    assert_eq!(of(&columns), of(&fresh));
    assert_ne!(of(&columns)[0], 1.3);
}

#[test]
fn missing_columns_and_rows_are_nan() {
    let artifact = artifact::decode(include_str!("../../../tests/golden/pendulum.derivation")).unwrap();
    let constants = Constants::new(&artifact.program, &[1.3, 0.7, 9.81]);
    let columns = Columns::new(&artifact.program, &constants, &[Quantity::Accelerations]);
    let table = Table { rows: 3, coordinates: vec![Column::new(&[0.1, 0.2])], ..Table::default() };
    let (mut numbers, mut failures) = (vec![0.0; 3], [None; 3]);
    columns.by_rows(&table, 0..3, &mut numbers, &mut failures);
    assert_eq!(failures, [Some(Failed::NotFinite); 3]);
    assert!(numbers.iter().all(|number| number.is_nan()));
    assert!(columns.slots() > 0 && !columns.is_empty());
}

/// The bits do not depend on the instructions that compute them.
#[cfg(target_arch = "x86_64")]
#[test]
fn the_same_bits_by_all_instructions_that_the_processor_has() {
    for program in [program(), program_of_sums()] {
        the_same_bits(&program);
    }
}

#[cfg(target_arch = "x86_64")]
fn the_same_bits(program: &Program) {
    use super::run::{Scratch, Task};
    use pulp::x86::{V3, V4};
    let constants = Constants::new(program, &[1.3]);
    let columns = Columns::new(program, &constants, &[Quantity::Forcing]);
    let [q, u, t] = states(LANES);
    let column = |numbers| vec![Column::new(numbers)];
    let (coordinates, speeds) = (column(&q), column(&u));
    let table = Table { rows: LANES, time: Some(Column::new(&t)), coordinates, speeds, ..Table::default() };
    let by = |way: &dyn Fn(Task<'_>)| {
        let mut scratch = Scratch::new(&columns);
        way(Task { columns: &columns, table: &table, first: 0, count: LANES, scratch: &mut scratch });
        let numbers = scratch.results.iter().flat_map(|slot| slot.0.as_flattened().to_vec());
        let bits = numbers.map(|number| if number.is_nan() { None } else { Some(number.to_bits()) });
        (bits.collect::<Vec<_>>(), scratch.failures)
    };
    let plain = by(&|task| task.execute());
    assert_eq!(by(&|task| task.run()), plain);
    if let Some(instructions) = V3::try_new() {
        assert_eq!(by(&|task| instructions.vectorize(|| task.execute())), plain);
    }
    if let Some(instructions) = V4::try_new() {
        assert_eq!(by(&|task| instructions.vectorize(|| task.execute())), plain);
    }
}
