//! The functions against the generated module, the solver and answers that are known.

use std::sync::Arc;

use crate::sql::{numbers, query, texts};
use datafusion::arrow::array::{Array, AsArray};
use datafusion::arrow::datatypes::{Int32Type, UInt64Type};
use hodograph::nalgebra::Vector3;
use hodograph::{Law, ReducedMatrix, Surface};
use hodograph_sweeps::session::{Engine, Setup};

hodograph::mechanism!("../models/two_sleds.mech");
use two_sleds::{Coordinates, Parameters, Speeds, TwoSleds};

/// Every number of a collision has the bits of the generated module, with the parameters of the file and with
/// others, for all laws.
#[tokio::test]
async fn collisions_have_the_bits_of_generated_code() {
    let state = "'u1', u1, 'u4', u4, 'q3', q3, 'mu', mu, 'e', 0.7, 'law', law";
    let sql = format!(
        "SELECT u1, u4, q3, mu, m, law, c['kind'], c['path'], c['impulse_n'], c['impulse_t'], c['impulse_s'], c['separation_n'],
             c['contact_work'], c['after_u1'], c['after_u6'], p['kind'], p['impulse_n'], p['after_u3'], c['compressions']
         FROM (SELECT *, two_sleds_collide(named_struct({state})) AS c, two_sleds_collide(named_struct({state}, 'm', m)) AS p
               FROM (SELECT 2.0 * uniform(i, 0, 5) - 1.0 AS u1, 2.0 * uniform(i, 1, 5) - 1.0 AS u4, 0.7 + 0.2 * uniform(i, 2, 5) AS q3,
                         1.5 * uniform(i, 3, 5) AS mu, 1.0 + uniform(i / 3, 4, 5) AS m,
                         CASE i % 3 WHEN 0 THEN 'newton' WHEN 1 THEN 'poisson' ELSE 'stronge' END AS law
                     FROM rows(3000)))"
    );
    let found = query(&sql).await;
    assert_eq!(found.num_rows(), 3000);
    let column = |index| numbers(&found, index);
    let [u1, u4, q3, mu, m] = [0, 1, 2, 3, 4].map(column);
    let [laws, kinds, paths, kinds_m] = [5, 6, 7, 15].map(|index| texts(&found, index));
    let compressions = found.column(18).as_primitive::<Int32Type>();
    let (mut solved, mut refused) = (0, 0);
    for row in 0..found.num_rows() {
        let q = Coordinates { q3: q3[row].unwrap(), ..Coordinates::default() };
        let u = Speeds { u1: u1[row].unwrap(), u4: u4[row].unwrap(), ..Speeds::default() };
        let law = Law::named(laws[row].as_deref().unwrap()).unwrap();
        let surface = Surface { mu: mu[row].unwrap(), e: 0.7, law };
        let kind = |index: &Vec<Option<String>>| index[row].clone().unwrap();
        match TwoSleds::<f64>::default().collide_bc_ac(&q, &u, &surface) {
            Ok(hit) => {
                solved += 1;
                let wanted = [
                    hit.impulse.x,
                    hit.impulse.y,
                    hit.impulse.z,
                    hit.separation.x,
                    hit.impact.contact_work,
                    hit.speeds.u1,
                    hit.speeds.u6,
                ];
                let got = [8, 9, 10, 11, 12, 13, 14].map(|index| column(index)[row].unwrap());
                assert_eq!(got.map(f64::to_bits), wanted.map(f64::to_bits), "row {row}");
                assert_eq!(kind(&kinds), "ok");
                assert_eq!(paths[row].as_deref(), Some(hit.path.to_string().as_str()));
                assert_eq!(compressions.value(row), hit.impact.compressions as i32);
            }
            Err(error) => {
                refused += 1;
                assert_eq!(kind(&kinds), error.kind());
                assert!(column(8)[row].is_none() && paths[row].is_none());
            }
        }
        let other = TwoSleds::new(Parameters { m: m[row].unwrap(), ..Parameters::default() }).unwrap();
        match other.collide_bc_ac(&q, &u, &surface) {
            Ok(hit) => {
                let got = [16, 17].map(|index| column(index)[row].unwrap().to_bits());
                assert_eq!(got, [hit.impulse.x.to_bits(), hit.speeds.u3.to_bits()], "row {row}");
            }
            Err(error) => assert_eq!(kind(&kinds_m), error.kind()),
        }
    }
    assert!(solved > 500 && refused > 500, "{solved} {refused}");
}

#[tokio::test]
async fn accelerations_and_energy_have_the_bits_of_generated_code() {
    let found = query(
        "SELECT q3, u1, a['rate_u1'], a['rate_u6'], e['kinetic'] FROM (SELECT q3, u1,
             two_sleds_accelerations(named_struct('q3', q3, 'u1', u1)) AS a, two_sleds_energy(named_struct('q3', q3, 'u1', u1, 'm', 3.0)) AS e
         FROM (SELECT uniform(i, 0, 2) AS q3, normal(i, 1, 2) AS u1 FROM rows(500)))",
    )
    .await;
    let column = |index: usize| numbers(&found, index);
    let sleds = TwoSleds::<f64>::default();
    for row in 0..found.num_rows() {
        let q = Coordinates { q3: column(0)[row].unwrap(), ..Coordinates::default() };
        let u = Speeds { u1: column(1)[row].unwrap(), ..Speeds::default() };
        let rates = sleds.accelerations(&q, &u).unwrap();
        let wanted = [rates.u1, rates.u6, sleds.kinetic_energy(&q, &u).unwrap()];
        assert_eq!(
            [2, 3, 4].map(|index| column(index)[row].unwrap().to_bits()),
            wanted.map(f64::to_bits),
            "row {row}"
        );
    }
}

#[tokio::test]
async fn solve_has_the_bits_of_the_solver() {
    let found = query(
        "SELECT vt, mu, s['impulse_n'], s['impulse_t'], s['impulse_s'], s['separation_n'], s['normal_work'] FROM (
             SELECT vt, mu, solve(0.25, -0.125, 0.0, 0.5, 0.01, 0.5, -1.0, vt, 0.1, mu, 0.5, 'poisson') AS s
             FROM (SELECT normal(i, 0, 1) AS vt, uniform(i, 1, 1) AS mu FROM rows(2000)))",
    )
    .await;
    let matrix = ReducedMatrix::new(0.25, -0.125, 0.0, 0.5, 0.01, 0.5);
    for row in 0..found.num_rows() {
        let number = |column| numbers(&found, column)[row].unwrap();
        let surface = Surface { mu: number(1), e: 0.5, law: Law::Poisson };
        let hit = hodograph::solve(&matrix, &Vector3::new(-1.0, number(0), 0.1), &surface).unwrap();
        let wanted = [hit.impulse.x, hit.impulse.y, hit.impulse.z, hit.velocity.x, hit.normal_work];
        assert_eq!(
            [2, 3, 4, 5, 6].map(|column| number(column).to_bits()),
            wanted.map(f64::to_bits),
            "row {row}"
        );
    }
}

/// A row that has no answer says why, and its neighbours have theirs.
#[tokio::test]
async fn errors_are_values() {
    let found = query(
        "SELECT c['kind'] AS kind, c['impulse_n'] AS impulse, outcome_hash(c) AS hash FROM (
             SELECT n, two_sleds_collide(named_struct('mu', mu, 'e', e, 'law', law, 'u1', u1, 'm', m, 'contact', contact)) AS c FROM (VALUES
                 (0, 0.5, 0.5, 'newton', 1.0, 3.0, 'BcAc'),
                 (1, NULL, 0.5, 'newton', 1.0, 3.0, 'BcAc'),
                 (2, 'NaN'::double, 0.5, 'newton', 1.0, 3.0, 'BcAc'),
                 (3, -1.0, 0.5, 'newton', 1.0, 3.0, 'BcAc'),
                 (4, 0.5, 2.0, 'newton', 1.0, 3.0, 'BcAc'),
                 (5, 0.5, 0.5, 'hertz', 1.0, 3.0, 'BcAc'),
                 (6, 0.5, 0.5, 'newton', -9.0, 3.0, 'BcAc'),
                 (7, 0.5, 0.5, 'newton', 'NaN'::double, 3.0, 'BcAc'),
                 (8, 0.5, 0.5, 'newton', 1.0, -3.0, 'BcAc'),
                 (9, 0.5, 0.5, 'newton', 1.0, 3.0, 'wall'),
                 (10, 0.5, 0.5, 'newton', 1.0, 3.0, 'BcAc')) AS t (n, mu, e, law, u1, m, contact)) ORDER BY n",
    )
    .await;
    let kinds: Vec<String> = texts(&found, 0).into_iter().flatten().collect();
    let wanted = [
        "ok",
        "null",
        "not_finite",
        "negative_friction",
        "restitution_out_of_range",
        "unknown_law",
        "not_approaching",
        "not_finite",
        "impossible_mass",
        "unknown_name",
        "ok",
    ];
    assert_eq!(kinds, wanted);
    let impulses = numbers(&found, 1);
    assert!(
        impulses.iter().zip(&kinds).all(|(impulse, kind)| impulse.is_some() == (kind == "ok")),
        "{impulses:?}"
    );
    assert_eq!(impulses[0].map(f64::to_bits), impulses[10].map(f64::to_bits));
    let hashes = found.column(2).as_primitive::<UInt64Type>();
    assert_eq!(hashes.value(0), hashes.value(10));
}

/// A wrong name or type is told when the query is planned, before any row is computed.
#[tokio::test]
async fn wrong_fields_are_refused_by_name() {
    let setup = Setup { engine: Engine::Embedded, cores: 1, memory: 1 << 30, models: Vec::new() };
    let (context, _) = setup.open().await.unwrap();
    let cases = [
        (
            "two_sleds_energy(named_struct('q9', 1.0))",
            "there is no parameter, number of the state or field `q9`: there are: time, q1, q2",
        ),
        ("two_sleds_energy(named_struct('q3', 'north'))", "the field `q3` is"),
        ("two_sleds_energy(1.0)", "takes one struct of named fields"),
        ("two_sleds_collide(named_struct('mu', 0.5, 'e', 0.5))", "needs the field `law`"),
        ("two_sleds_collide(named_struct('mu', 0.5, 'e', 0.5, 'law', 3))", "it must be text"),
        ("solve(1.0, 2.0)", "solve takes 12 arguments"),
        ("solve(1, 0, 0, 1, 0, 1, -1, 0, 0, 'x', 0.5, 'newton')", "the argument mu is"),
    ];
    for (call, wanted) in cases {
        let error = match context.sql(&format!("SELECT {call} FROM rows(3)")).await {
            Ok(_) => panic!("{call} is accepted"),
            Err(error) => error.strip_backtrace(),
        };
        assert!(error.contains(wanted), "{call}: {error}");
    }
}

/// The histogram counts what GROUP BY counts, and the checksum does not depend on partitions.
#[tokio::test]
async fn aggregates_agree_with_plain_sql() {
    let found = query(
        "SELECT checksum(outcome_hash(x)), count(*), histogram(x, 0.25, 0.75, 4), count(*) FILTER (WHERE x < 0.25),
             count(*) FILTER (WHERE x >= 0.25 AND x < 0.375), count(*) FILTER (WHERE x >= 0.75)
         FROM (SELECT uniform(i, 0, 0) AS x FROM rows(300000))",
    )
    .await;
    let list = found.column(2).as_list::<i32>().value(0);
    let counts = list.as_primitive::<UInt64Type>();
    let count = |column: usize| {
        found.column(column).as_primitive::<datafusion::arrow::datatypes::Int64Type>().value(0) as u64
    };
    assert_eq!(counts.len(), 6);
    assert_eq!([counts.value(0), counts.value(1), counts.value(5)], [count(3), count(4), count(5)]);
    assert_eq!(counts.values().iter().sum::<u64>(), count(1));
    let whole = found.column(0).as_primitive::<UInt64Type>().value(0);
    // the same numbers, in another order and by other partitions
    let again = query("SELECT checksum(outcome_hash(x)) FROM (SELECT uniform(299999 - i, 0, 0) AS x FROM rows(300000) ORDER BY x)").await;
    assert_eq!(again.column(0).as_primitive::<UInt64Type>().value(0), whole);
    let _: Arc<dyn Array> = Arc::clone(again.column(0));
}

/// A positive work counts as a gain beyond its rounding only: Stronge's hypothesis gains nothing for e = 1 without
/// friction, Newton's much. The one function of the runtime decides.
#[tokio::test]
async fn rounding_is_no_gain_of_energy() {
    let found = query(
        "SELECT law, mu, c['contact_work'], energy_gained(c), energy_gained(s, c['approach_n'], c['approach_t'], c['approach_s'])
         FROM (SELECT law, mu, c, solve(1.0, 0.1, 0.2, 1.0, 0.1, 1.0, c['approach_n'], c['approach_t'], c['approach_s'], 0.0, 1.0, law) AS s
               FROM (SELECT law, mu, two_sleds_collide(named_struct('mu', mu, 'e', 1.0, 'law', law, 'u1', 1.0 + uniform(i, 0, 1),
                       'u3', 0.2 * uniform(i, 1, 1), 'u4', 1.0 + uniform(i, 2, 1), 'u6', 0.2 * uniform(i, 3, 1))) AS c
                   FROM (SELECT i, CASE i % 2 WHEN 0 THEN 'newton' ELSE 'stronge' END AS law, CASE i % 4 WHEN 2 THEN 1.6 ELSE 0.0 END AS mu
                       FROM rows(4000))))",
    )
    .await;
    let laws = texts(&found, 0);
    let [mu, works, gains, others] = [1, 2, 3, 4].map(|index| numbers(&found, index));
    let (mut positive, mut gained) = (0, 0);
    for row in 0..found.num_rows() {
        let (work, gain) = (works[row].unwrap(), gains[row].unwrap());
        assert_eq!(others[row], Some(0.0));
        if mu[row] == Some(0.0) {
            positive += u32::from(work > 0.0);
            assert_eq!(gain, 0.0, "{:?}: {work:e}", laws[row]);
        } else {
            assert!(gain == work || (gain == 0.0 && work < 1e-12));
            gained += u32::from(gain > 0.0);
        }
    }
    assert!(positive > 50 && gained > 500, "{positive} {gained}");
}

/// Bad input has the errors that every door has: those of rows by their kind, those of queries in words.
#[tokio::test]
async fn bad_input_has_the_errors_of_every_door() {
    let models = vec!["../tests/data/doors/errors.mech".into()];
    let setup = Setup { engine: Engine::Embedded, cores: 1, memory: 1 << 30, models };
    let (context, _) = setup.open().await.unwrap();
    let mistakes: Vec<serde_json::Value> =
        serde_json::from_str(include_str!("../../tests/data/doors/errors.json")).unwrap();
    let (mut rows, mut queries) = (0, 0);
    for mistake in &mistakes {
        if !mistake["doors"].as_array().unwrap().iter().any(|door| door == "sql") {
            continue;
        }
        let mut fields = Vec::new();
        for section in ["q", "u", "parameters"] {
            for (name, value) in mistake[section].as_object().into_iter().flatten() {
                let text = value.as_str().map(|text| text.replace("nan", "NaN"));
                let value = text.map_or(value.to_string(), |text| format!("'{text}'"));
                fields.push(format!("'{name}', {value}::double"));
            }
        }
        let call = mistake["call"].as_str().unwrap();
        for name in ["mu", "e", "tolerance"] {
            fields.extend(mistake[name].as_f64().map(|value| format!("'{name}', {value:?}::double")));
        }
        fields.extend(mistake["law"].as_str().map(|law| format!("'law', '{law}'")));
        match call {
            "simulate" => fields.push("'until', 0.1".to_owned()),
            "collide" => {
                let contact = mistake["contact"].as_str().unwrap_or("floor");
                fields.push(format!("'contact', '{contact}'"));
            }
            _ => {}
        }
        let sql = format!("SELECT errors_{call}(named_struct({}))['kind'] AS kind", fields.join(", "));
        let found = match context.sql(&sql).await {
            Ok(frame) => frame.collect().await,
            Err(error) => Err(error),
        };
        match found {
            Ok(batches) => {
                assert_eq!(texts(&batches[0], 0)[0].as_deref(), mistake["kind"].as_str(), "{mistake}");
                rows += 1;
            }
            Err(error) => {
                let said = error.strip_backtrace();
                assert!(said.contains(mistake["words"].as_str().unwrap()), "{mistake}: {said}");
                queries += 1;
            }
        }
    }
    assert!(rows > 12 && queries > 1, "{rows} {queries}");
}
