//! What derivatives cost beside the motion.

use std::time::{Duration, Instant};

use hodograph::{Law, State};
use hodograph_gradients::By;
use hodograph_simulation::Simulation;

use crate::common::{Task, options, read};

/// The least time of several runs.
fn least(mut run: impl FnMut()) -> Duration {
    let once = || {
        let begin = Instant::now();
        run();
        begin.elapsed()
    };
    std::iter::repeat_with(once).take(8).min().unwrap()
}

/// Ten variables: the motion and its derivatives take less than five times the motion alone.
#[test]
fn ten_derivatives_cost_less_than_five_motions() {
    let rod = Task {
        mechanism: read("simulation/models/painleve_rod.mech"),
        q: vec![0.0, 1.3, 0.7],
        u: vec![1.5, 0.0, 2.0],
        mu: 0.1,
        e: 0.92,
        law: Law::Poisson,
    };
    let cube = Task {
        mechanism: read("simulation/models/measured_cube.mech"),
        q: vec![0.0, 0.0, 0.25, 0.8, 0.4, -0.4, 0.2],
        u: vec![0.7, -0.4, -0.3, 3.0, -5.0, 4.0],
        mu: 0.18,
        e: 0.35,
        law: Law::Stronge,
    };
    let surface = [By::Friction(None), By::Restitution(None), By::Parameter(1), By::Parameter(2)];
    let of_rod = [0, 1, 2].map(By::Coordinate).into_iter().chain([0, 1, 2].map(By::Speed)).chain(surface);
    let of_cube = [2, 4].map(By::Coordinate).into_iter().chain([0, 1, 2, 4].map(By::Speed)).chain(surface);
    for (task, until, by) in [(rod, 4.7, of_rod.collect::<Vec<By>>()), (cube, 0.2, of_cube.collect())] {
        assert_eq!(by.len(), 10);
        let state = State { time: 0.0, coordinates: &task.q, speeds: &task.u, inputs: &[] };
        let alone = least(|| {
            let options = options(task.mu, task.e, task.law);
            Simulation::new(&task.mechanism, &state, options).unwrap().advance_to(until).unwrap();
        });
        let both = least(|| assert!(task.forwards(&by, &[until]).undefined.is_none()));
        let ratio = both.as_secs_f64() / alone.as_secs_f64();
        println!("{alone:?} and {both:?}: {ratio:.2} times");
        assert!(ratio < 5.0, "{ratio}");
    }
}
