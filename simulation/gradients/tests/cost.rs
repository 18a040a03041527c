//! What derivatives cost beside the motion, and backwards by many variables beside few.

use std::time::{Duration, Instant};

use hodograph::{ComponentKind, Law, State};
use hodograph_gradients::By;
use hodograph_simulation::Simulation;

use crate::common::{Task, options, read};

/// Number of runs of two programs in turns.
const TURNS: usize = 60;

/// The least times of many runs of two programs in turns: what disturbs one disturbs the other.
fn in_turns(mut one: impl FnMut(), mut other: impl FnMut()) -> [Duration; 2] {
    let timed = |run: &mut dyn FnMut()| {
        let begin = Instant::now();
        run();
        begin.elapsed()
    };
    let turns = (0..TURNS).map(|_| [timed(&mut one), timed(&mut other)]);
    turns.reduce(|[a, b], [c, d]| [a.min(c), b.min(d)]).unwrap()
}

/// The least time of several runs.
fn least(mut run: impl FnMut()) -> Duration {
    let once = || {
        let begin = Instant::now();
        run();
        begin.elapsed()
    };
    std::iter::repeat_with(once).take(6).min().unwrap()
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
        let alone = || {
            let options = options(task.mu, task.e, task.law);
            Simulation::new(&task.mechanism, &state, options).unwrap().advance_to(until).unwrap();
        };
        let both = || assert!(task.forwards(&by, &[until]).undefined.is_none());
        let [alone, both] = in_turns(alone, both);
        let ratio = both.as_secs_f64() / alone.as_secs_f64();
        println!("{alone:?} and {both:?}: {ratio:.2} times");
        assert!(ratio < 5.0, "{ratio}");
    }
}

/// Backwards the 108 variables of an arm that strikes a plane cost little more than one of them: steps are shorter.
#[test]
fn all_variables_cost_as_much_as_one_backwards() {
    let mechanism = read("models/arm_7dof.mech");
    let count = |kind| hodograph::Mechanism::count(&mechanism, kind);
    let all: Vec<By> = (0..7)
        .map(By::Coordinate)
        .chain((0..7).map(By::Speed))
        .chain((0..count(ComponentKind::Parameter)).map(By::Parameter))
        .chain([By::Friction(None), By::Restitution(None)])
        .collect();
    let q = vec![0.1, 0.9, -0.2, -0.6, 0.3, 0.4, 0.2];
    let task = Task { q, u: vec![0.1; 7], mu: 0.4, e: 0.5, law: Law::Stronge, mechanism };
    let until = 0.65;
    let checked = task.differentiate(&all, &[until]);
    assert!(checked.undefined.is_none(), "{:?}", checked.undefined);
    let collisions = checked.events.iter().filter(|event| event.event.kind.name() == "collision").count();
    println!("{} events, {collisions} collisions", checked.events.len());
    let backwards = |by: &[By]| {
        least(|| {
            let adjoint = task.adjoint(by, &[until]);
            assert!(adjoint.of_states(&[nalgebra::DVector::repeat(14, 1.0)]).is_ok());
        })
    };
    let (one, every) = (backwards(&all[..1]), backwards(&all));
    let forwards = least(|| assert!(task.forwards(&all, &[until]).undefined.is_none()));
    let (ratio, beside) =
        (every.as_secs_f64() / one.as_secs_f64(), forwards.as_secs_f64() / every.as_secs_f64());
    println!("1: {one:?}, {}: {every:?}: {ratio:.2} times; forwards {beside:.1} times that", all.len());
    assert!(ratio < 2.5 && beside > 4.0, "{ratio} {beside}");
}
