//! Every function of every shipped model has the bits of the generated module.

use std::fmt::Write;

use crate::sql::query;
use datafusion::arrow::array::{AsArray, RecordBatch, StructArray};
use datafusion::arrow::datatypes::{Float64Type, Int32Type};
use hodograph::{ComponentKind, Contacts, Law, State, Surface};
use hodograph_sweeps::models::shipped;

const ROWS: usize = 400;

macro_rules! generated {
    ($($name:literal $module:ident $mechanism:ident,)*) => {
        /// The generated modules by the names of their files.
        fn generated() -> Vec<(&'static str, Box<dyn Contacts>)> {
            vec![$(($name, Box::new(hodograph_models::$module::$mechanism::<f64>::default()))),*]
        }
    };
}

hodograph_models::every_mechanism!(generated);

/// What a query gives a function: the struct's fields, and the columns that they are read from.
struct Given {
    fields: String,
    columns: String,
    names: [Vec<String>; 2],
}

impl Given {
    /// Random speeds; in every second row also random coordinates near the model's own, where all of them are
    /// independent.
    fn new(mechanism: &dyn Contacts) -> Self {
        let count = |kind| mechanism.count(kind);
        let names = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| {
            (0..count(kind))
                .map(|index| mechanism.component(kind, index).unwrap().name.to_owned())
                .collect::<Vec<_>>()
        });
        let (mut q, mut u, mut inputs) = (
            vec![0.0; count(ComponentKind::Coordinate)],
            vec![0.0; count(ComponentKind::Speed)],
            vec![0.0; count(ComponentKind::Input)],
        );
        mechanism.initial_state(&mut q, &mut u, &mut inputs).unwrap();
        let free = mechanism.dependent_coordinate(0).is_none();
        let (mut fields, mut columns) = (String::new(), String::new());
        for (index, (name, start)) in names[0].iter().zip(&q).enumerate() {
            let spread = if free { 0.5 } else { 0.0 };
            write!(
                columns,
                ", {start:?} + {spread:?} * (i % 2) * (uniform(i, {index}, 1) - 0.5) AS q_{index}"
            )
            .unwrap();
            write!(fields, ", '{name}', q_{index}").unwrap();
        }
        for (index, name) in names[1].iter().enumerate() {
            write!(columns, ", 2.0 * uniform(i, {index}, 2) - 1.0 AS u_{index}").unwrap();
            write!(fields, ", '{name}', u_{index}").unwrap();
        }
        Given { fields: fields.split_off(2), columns, names }
    }

    fn states(&self, batch: &RecordBatch, row: usize) -> [Vec<f64>; 2] {
        let number =
            |name: String| batch.column_by_name(&name).unwrap().as_primitive::<Float64Type>().value(row);
        let list = |prefix: &str, names: &Vec<String>| {
            (0..names.len()).map(|index| number(format!("{prefix}_{index}"))).collect()
        };
        [list("q", &self.names[0]), list("u", &self.names[1])]
    }
}

fn kind(answers: &StructArray, row: usize) -> &str {
    answers.column_by_name("kind").unwrap().as_string::<i32>().value(row)
}

/// The bits of all numbers of a row.
fn bits(answers: &StructArray, row: usize) -> Vec<u64> {
    answers
        .columns()
        .iter()
        .filter_map(|column| column.as_primitive_opt::<Float64Type>())
        .map(|column| column.value(row).to_bits())
        .collect()
}

fn bits_of<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> Vec<u64> {
    numbers.into_iter().map(|number| number.to_bits()).collect()
}

#[test]
fn every_shipped_model_is_compared() {
    let shipped: Vec<&str> = shipped().iter().map(|model| model.name.as_str()).collect();
    let generated: Vec<&str> = generated().iter().map(|(name, _)| *name).collect();
    assert_eq!(generated, shipped);
}

#[tokio::test]
async fn collisions_have_the_bits_of_generated_code() {
    for (model, mechanism) in generated() {
        let given = Given::new(mechanism.as_ref());
        for contact in 0..mechanism.count(ComponentKind::Contact) {
            let name = mechanism.component(ComponentKind::Contact, contact).unwrap().name;
            let sql = format!(
                "SELECT *, {model}_collide(named_struct({}, 'mu', mu, 'e', 0.7, 'law', law, 'contact', '{name}')) AS answer
                 FROM (SELECT 1.5 * uniform(i, 0, 3) AS mu, CASE i % 3 WHEN 0 THEN 'newton' WHEN 1 THEN 'poisson' ELSE 'stronge' END AS law{}
                     FROM rows({ROWS}))",
                given.fields, given.columns
            );
            let found = query(&sql).await;
            let answers = found.column_by_name("answer").unwrap().as_struct();
            let (mut solved, mut speeds) = (0, vec![0.0; mechanism.count(ComponentKind::Speed)]);
            let mut inputs = vec![0.0; mechanism.count(ComponentKind::Input)];
            mechanism
                .initial_state(
                    &mut vec![0.0; mechanism.count(ComponentKind::Coordinate)],
                    &mut speeds.clone(),
                    &mut inputs,
                )
                .unwrap();
            for row in 0..ROWS {
                let [q, u] = given.states(&found, row);
                let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
                let mu = found.column_by_name("mu").unwrap().as_primitive::<Float64Type>().value(row);
                let law =
                    Law::named(found.column_by_name("law").unwrap().as_string::<i32>().value(row)).unwrap();
                match mechanism.collide(contact, &state, &Surface { mu, e: 0.7, law }, &mut speeds) {
                    Ok(outcome) => {
                        solved += 1;
                        let impact = &outcome.impact;
                        let works = [impact.contact_work, impact.normal_work, outcome.energy_change];
                        let vectors = outcome.approach.iter().chain(&impact.impulse).chain(&impact.velocity);
                        let wanted = bits_of(vectors.chain(&works).chain(&speeds));
                        assert_eq!(
                            (kind(answers, row), bits(answers, row)),
                            ("ok", wanted),
                            "{model}, {name}, row {row}"
                        );
                        let texts = answers.column_by_name("path").unwrap().as_string::<i32>();
                        assert_eq!(texts.value(row), impact.path.to_string());
                        let counts =
                            answers.column_by_name("compressions").unwrap().as_primitive::<Int32Type>();
                        assert_eq!(counts.value(row), impact.compressions as i32);
                    }
                    Err(error) => assert_eq!(kind(answers, row), error.kind(), "{model}, {name}, row {row}"),
                }
            }
            assert!(solved > ROWS / 8, "{model}, {name}: {solved} solved");
        }
    }
}

/// The states of `tests/data/doors`: every door gives the same bits.
#[tokio::test]
async fn twenty_states_have_the_bits_of_every_door() {
    let table = include_str!("../../tests/data/doors/planar_double_pendulum.csv");
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 20);
    let values: Vec<String> =
        rows.iter().map(|row| format!("({:?}, {:?}, {:?}, {:?})", row[0], row[1], row[2], row[3])).collect();
    let state = "named_struct('q1', q1, 'q2', q2, 'u1', u1, 'u2', u2)";
    let model = "planar_double_pendulum";
    let found = query(&format!(
        "SELECT {model}_accelerations({state}) AS rates, {model}_energy({state}) AS energy
         FROM (VALUES {}) AS t(q1, q2, u1, u2)",
        values.join(", ")
    ))
    .await;
    let [rates, energy] = ["rates", "energy"].map(|name| found.column_by_name(name).unwrap().as_struct());
    for (place, row) in rows.iter().enumerate() {
        assert_eq!((kind(rates, place), bits(rates, place)), ("ok", bits_of(&row[4..6])));
        assert_eq!(bits(energy, place)[..1], bits_of(&row[6..7])[..]);
    }
}

#[tokio::test]
async fn accelerations_and_energy_have_the_bits_of_generated_code() {
    for (model, mechanism) in generated() {
        let given = Given::new(mechanism.as_ref());
        let sql = format!(
            "SELECT *, {model}_accelerations(named_struct({})) AS rates, {model}_energy(named_struct({})) AS energy
             FROM (SELECT i{} FROM rows({ROWS}))",
            given.fields, given.fields, given.columns
        );
        let found = query(&sql).await;
        let [rates, energy] = ["rates", "energy"].map(|name| found.column_by_name(name).unwrap().as_struct());
        let mut wanted = vec![0.0; mechanism.count(ComponentKind::Speed)];
        let mut inputs = vec![0.0; mechanism.count(ComponentKind::Input)];
        mechanism
            .initial_state(
                &mut vec![0.0; mechanism.count(ComponentKind::Coordinate)],
                &mut wanted,
                &mut inputs,
            )
            .unwrap();
        for row in 0..ROWS {
            let [q, u] = given.states(&found, row);
            let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
            match mechanism.accelerations(&state, &mut wanted) {
                Ok(()) => assert_eq!(
                    (kind(rates, row), bits(rates, row)),
                    ("ok", bits_of(&wanted)),
                    "{model}, row {row}"
                ),
                Err(error) => assert_eq!(kind(rates, row), error.kind(), "{model}, row {row}"),
            }
            let energies = mechanism
                .kinetic_energy(&state)
                .and_then(|kinetic| Ok((kinetic, mechanism.potential_energy(&state)?)));
            match energies {
                Ok((kinetic, potential)) => {
                    let wanted = [kinetic, potential.unwrap_or(0.0)];
                    assert_eq!(
                        (kind(energy, row), bits(energy, row)),
                        ("ok", bits_of(&wanted)),
                        "{model}, row {row}"
                    );
                }
                Err(error) => assert_eq!(kind(energy, row), error.kind(), "{model}, row {row}"),
            }
        }
    }
}
