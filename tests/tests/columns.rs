//! Many states at once: generated modules, the interpreter and columns answer with the same bits, whatever
//! the size of the batch, and a state without an answer fails alone.

use crate::common::Model;
use crate::common::emitted::{Emitted, emitted, routine};
use crate::common::random::samples;
use hodograph::{CollisionError, ComponentKind, Law, Mechanism, State, StateError, Surface};
use hodograph_generator::interpret::{Arguments, Prepared};
use hodograph_generator::program::{Inputs, Quantity};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Column, Impacts, Table, evaluate_rows, over_rows};

/// States of a model at the parameters of the first, one of them without numbers.
fn states(model: &Model) -> Vec<Inputs> {
    let mut states: Vec<Inputs> = samples(model, 5).into_iter().map(|sample| sample.inputs).collect();
    let parameters = states[0].parameters.clone();
    for state in &mut states {
        state.parameters.clone_from(&parameters);
        state.tangent = vec![0.3; model.mechanism.independent_states() + model.mechanism.inputs.len()];
    }
    let mut broken = states[1].clone();
    broken.speeds.iter_mut().for_each(|speed| *speed = f64::NAN);
    broken.coordinates.iter_mut().for_each(|coordinate| *coordinate = f64::NAN);
    states.insert(2, broken);
    states
}

/// States in the form of columns; they come again and again.
struct Batch {
    rows: usize,
    numbers: [Vec<f64>; 6],
    widths: [usize; 5],
}

impl Batch {
    fn of(states: &[Inputs], rows: usize) -> Self {
        let at = |row: usize| &states[row % states.len()];
        let lists = |at: &Inputs| {
            [&at.coordinates, &at.speeds, &at.inputs, &at.accelerations, &at.tangent].map(Clone::clone)
        };
        let gathered = |list: usize| (0..rows).flat_map(|row| lists(at(row))[list].clone()).collect();
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(gathered);
        Batch {
            rows,
            numbers: [a, b, c, d, e, (0..rows).map(|row| at(row).time).collect()],
            widths: lists(&states[0]).map(|list| list.len()),
        }
    }

    fn table(&self) -> Table<'_> {
        let of = |list: usize| Column::of_rows(&self.numbers[list], self.widths[list]);
        Table {
            rows: self.rows,
            time: Some(Column::new(&self.numbers[5])),
            coordinates: of(0),
            speeds: of(1),
            inputs: of(2),
            accelerations: of(3),
            tangent: of(4),
        }
    }
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// What one state gives: by the interpreter and, where there is a routine, by the generated module.
fn expected(
    module: &dyn Emitted,
    (model, mechanism): (&Model, &InterpretedMechanism),
    quantity: Quantity,
    states: &[Inputs],
) -> Vec<Result<Vec<f64>, StateError>> {
    let prepared = Prepared::new(&model.program, mechanism.constants(), &[quantity]);
    let routine = routine(&model.mechanism, quantity);
    let of = |at: &Inputs| {
        let arguments = Arguments {
            time: at.time,
            coordinates: &at.coordinates,
            speeds: &at.speeds,
            inputs: &at.inputs,
            accelerations: &at.accelerations,
            tangent: &at.tangent,
        };
        let mut numbers = vec![0.0; prepared.len()];
        let outcome = prepared.evaluate(&arguments, |index, number| numbers[index] = number);
        let interpreted = outcome.map(|()| numbers).map_err(|failed| mechanism.state_error(failed));
        if let Some(generated) = routine.as_ref().and_then(|routine| module.call(routine, at)) {
            let generated = generated.map(|numbers| bits(&numbers));
            let here = interpreted.as_ref().map(|numbers| bits(numbers)).map_err(StateError::to_string);
            assert_eq!(generated, here, "{} {quantity}", model.name);
        }
        interpreted
    };
    states.iter().map(of).collect()
}

fn compare(
    mechanism: &InterpretedMechanism,
    quantity: Quantity,
    batch: &Batch,
    expected: &[Result<Vec<f64>, StateError>],
) {
    let columns = mechanism.columns(&[quantity]);
    let rows = batch.rows;
    let (mut numbers, mut failures) = (vec![0.0; rows * columns.len()], vec![None; rows]);
    evaluate_rows(&columns, &batch.table(), &mut numbers, &mut failures);
    for (row, (failure, found)) in failures.iter().zip(numbers.chunks(columns.len())).enumerate() {
        let place = || format!("{} {quantity}, row {row} of {rows}", mechanism.name());
        match (failure, &expected[row % expected.len()]) {
            (None, Ok(numbers)) => assert_eq!(bits(found), bits(numbers), "{}", place()),
            (Some(failed), Err(error)) => {
                assert_eq!(mechanism.state_error(*failed), *error, "{}", place());
                assert!(found.iter().all(|number| number.is_nan()), "{}", place());
            }
            (failure, expected) => panic!("{}: {failure:?}, {expected:?}", place()),
        }
    }
}

#[test]
fn generated_modules_the_interpreter_and_columns_compute_the_same_bits() {
    let mut failed = 0;
    for module in &emitted() {
        let model = Model::load(module.name());
        let states = states(&model);
        let mechanism = InterpretedMechanism::with_parameters(
            model.mechanism.clone(),
            model.program.clone(),
            &states[0].parameters,
        )
        .expect("a mechanism");
        for output in model.program.outputs.iter().filter(|output| !output.values.is_empty()) {
            let expected = expected(&**module, (&model, &mechanism), output.quantity, &states);
            failed += expected.iter().filter(|numbers| numbers.is_err()).count();
            let whole = matches!(output.quantity, Quantity::Accelerations | Quantity::MassMatrix);
            let sizes: &[usize] = if whole { &[1, 8, 63, 64, 65, 1000] } else { &[1, 65] };
            for &rows in sizes {
                compare(&mechanism, output.quantity, &Batch::of(&states, rows), &expected);
            }
        }
    }
    assert!(failed > 24, "of every model a state without numbers fails: {failed}");
}

#[test]
fn collisions_of_many_states_are_those_of_one() {
    let (mut solved, mut refused) = (0, 0);
    for module in &emitted() {
        let model = Model::load(module.name());
        let states = states(&model);
        let mechanism = InterpretedMechanism::with_parameters(
            model.mechanism.clone(),
            model.program.clone(),
            &states[0].parameters,
        )
        .expect("a mechanism");
        let surface = |row: usize| Surface {
            mu: (row % 5) as f64 * 0.3,
            e: (row % 7) as f64 / 6.0,
            law: Law::ALL[row % Law::ALL.len()],
        };
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            let collisions = mechanism.collisions(contact).expect("collisions");
            let batch = Batch::of(&states, 67);
            let table = batch.table();
            let mut next = 0;
            collisions.solve(&table, &surface, 0..batch.rows, &mut |row, found| {
                assert_eq!(row, next);
                next += 1;
                let at = &states[row % states.len()];
                let state = State {
                    time: at.time,
                    coordinates: &at.coordinates,
                    speeds: &at.speeds,
                    inputs: &at.inputs,
                };
                let mut speeds = vec![0.0; at.speeds.len()];
                let one = module.by_slices(at).collide(contact, &state, &surface(row), &mut speeds);
                match (found, one) {
                    (Ok((outcome, after)), Ok(one)) => {
                        assert_eq!(outcome, one, "{} row {row}", model.name);
                        assert_eq!(bits(after), bits(&speeds), "{} row {row}", model.name);
                        solved += 1;
                    }
                    (Err(error), Err(one)) => {
                        // a number that is not one differs from itself
                        assert_eq!(format!("{error:?}"), format!("{one:?}"), "{} row {row}", model.name);
                        refused += 1;
                    }
                    (found, one) => panic!("{} row {row}: {found:?}, {one:?}", model.name),
                }
            });
            assert_eq!(next, batch.rows);
        }
        let missing = mechanism.count(ComponentKind::Contact);
        let error = mechanism.collisions(missing).expect_err("no such contact");
        assert_eq!(error, StateError::Missing { kind: ComponentKind::Contact, index: missing });
    }
    assert!(solved > 200 && refused > 200, "{solved} {refused}");
}

#[test]
fn impacts_by_rows_are_those_one_by_one() {
    let rows = 2500;
    let number = |row: usize, column: usize| ((row * 31 + column * 17) as f64 * 0.7).sin();
    // the matrix of a mass point with arms: positive definite
    let matrix = |row: usize| {
        let [a, b, c] = [1, 2, 3].map(|column| number(row, column));
        [1.0 + b * b + c * c, -a * b, -a * c, 1.0 + a * a + c * c, -b * c, 1.0 + a * a + b * b]
    };
    let matrices: Vec<f64> = (0..rows).flat_map(matrix).collect();
    let velocities: Vec<f64> = (0..rows)
        .flat_map(|row| [-0.3 - number(row, 4), number(row, 5), if row % 97 == 3 { f64::NAN } else { 0.5 }])
        .collect();
    let [matrix, velocity] = [(&matrices, 6), (&velocities, 3)].map(|(all, n)| Column::of_rows(all, n));
    let impacts = Impacts { matrix: matrix.try_into().unwrap(), velocity: velocity.try_into().unwrap() };
    let surface =
        |row: usize| Surface { mu: 0.1 * (row % 9) as f64, e: 0.5, law: Law::ALL[row % Law::ALL.len()] };
    let parts = over_rows(rows, |range| {
        let mut found = Vec::new();
        impacts.solve(&surface, range, &mut |row, impact| found.push((row, format!("{impact:?}"))));
        found
    });
    assert!(parts.len() > 1, "more than one task");
    let found = parts.concat();
    assert_eq!(found.len(), rows);
    let mut kinds = std::collections::BTreeSet::new();
    for (place, (row, found)) in found.iter().enumerate() {
        assert_eq!(place, *row);
        let [nn, nt, ns, tt, ts, ss] = std::array::from_fn(|i| matrices[6 * row + i]);
        let matrix = hodograph::ReducedMatrix::new(nn, nt, ns, tt, ts, ss);
        let velocity = hodograph::nalgebra::Vector3::from_row_slice(&velocities[3 * row..3 * row + 3]);
        let one = hodograph::solve(&matrix, &velocity, &surface(*row));
        assert_eq!(*found, format!("{one:?}"), "row {row}");
        kinds.insert(one.map_or_else(|error| CollisionError::from(error).kind(), |_| "solved"));
    }
    assert!(
        kinds.contains("solved") && kinds.contains("not_finite") && kinds.contains("not_approaching"),
        "{kinds:?}"
    );
}
