//! Motions as a function of columns: the bits of the simulation, and errors as answers of their rows.

use crate::sql::{numbers, query, texts};
use datafusion::arrow::array::{Array, AsArray};
use datafusion::arrow::datatypes::Int64Type;
use hodograph::{ComponentKind, Law, Mechanism, Surface};
use hodograph_models::free_box_corner::FreeBoxCorner;
use hodograph_simulation::{Batch, Case, ContactLaw, Options, simulate_many};

#[tokio::test]
async fn motions_have_the_bits_of_the_simulation() {
    let found = query(
        "SELECT mu, s['kind'], s['time'], s['rest'], s['closed'], s['energy'], s['collisions'], s['end_u1'], m['end_u1']
         FROM (SELECT mu, free_box_corner_simulate(named_struct('until', 0.3, 'mu', mu, 'e', 0.4, 'law', 'poisson')) AS s,
                   free_box_corner_simulate(named_struct('until', 0.3, 'mu', mu, 'e', 0.4, 'law', 'poisson', 'mu_impact', 0.1,
                       'restitution', 'power(1, 0.25)')) AS m
               FROM (SELECT linspace(i, -0.125, 1.0, 10) AS mu FROM rows(10)))
         ORDER BY mu",
    )
    .await;
    assert_eq!(found.num_rows(), 10);
    let [mu, time, rest, energy, after, after_law] = [0, 2, 3, 5, 7, 8].map(|index| numbers(&found, index));
    let (kinds, closed) = (texts(&found, 1), texts(&found, 4));
    let collisions = found.column(6).as_primitive::<Int64Type>();
    let machine = FreeBoxCorner::<f64>::default();
    let count = |kind| vec![0.0; machine.count(kind)];
    let (mut q, mut u, mut inputs) =
        (count(ComponentKind::Coordinate), count(ComponentKind::Speed), count(ComponentKind::Input));
    machine.initial_state(&mut q, &mut u, &mut inputs).unwrap();
    for row in 1..10 {
        let with = |law: Option<ContactLaw>| {
            let surface = Surface { mu: mu[row].unwrap(), e: 0.4, law: Law::Poisson };
            let case = |_| {
                let (coordinates, speeds, inputs) = (q.clone(), u.clone(), inputs.clone());
                let options = Options { surface: Some(surface), law: law.clone(), ..Options::default() };
                Ok(Case { mechanism: &machine, time: 0.0, coordinates, speeds, inputs, options, until: 0.3 })
            };
            simulate_many(1, case, &Batch::default()).remove(0).unwrap()
        };
        let outcome = with(None);
        assert_eq!(kinds[row].as_deref(), Some(outcome.kind()));
        assert_eq!((time[row], rest[row]), (Some(outcome.time), outcome.rest));
        assert_eq!(closed[row].as_deref().unwrap().is_empty(), outcome.closed.is_empty());
        assert_eq!(energy[row], outcome.energy.total());
        assert_eq!(collisions.value(row), outcome.collisions as i64);
        assert_eq!(after[row], Some(outcome.speeds[0]));
        let restitution = "power(1, 0.25)".parse().unwrap();
        let law = ContactLaw { mu_impact: Some(0.1), restitution, ..ContactLaw::default() };
        assert_eq!(after_law[row], Some(with(Some(law)).speeds[0]));
    }
    // mu = -0.125: an answer of its own.
    assert_eq!(kinds[0].as_deref(), Some("negative_friction"));
    assert!(time[0].is_none() && collisions.is_null(0));
}
