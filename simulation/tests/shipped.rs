//! Every shipped model with a gap runs for ten seconds from random starts.
//!
//! 300 starts of each: `HODOGRAPH_STARTS=300 cargo test --release -p hodograph-simulation --test all shipped:: --
//! --nocapture`

use crate::common::names;
use hodograph::{CollisionError, ComponentKind, Contacts, ImpactError, Law, State, StateError, Surface};
use hodograph_random::{Random, starts};
use hodograph_simulation::{ErrorKind, Event, Options, Progress, Simulation, SimulationError};

/// What became of the starts of a model.
#[derive(Debug, Default)]
struct Count {
    whole: u64,
    events: usize,
    poles: u64,
    wedged: u64,
}

/// How a motion ends.
enum End {
    /// at the time asked for
    Whole,
    /// at a pole of the model's angles
    Pole,
    /// at an impact that nothing ends
    Wedged,
    /// by an error that the model does not explain: which
    Failed(String),
}

/// A start at which all contacts that have a gap are open.
fn open_start(model: &dyn Contacts<f64>, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let count = |kind| model.count(kind);
    let (mut q, mut u) =
        (vec![0.0; count(ComponentKind::Coordinate)], vec![0.0; count(ComponentKind::Speed)]);
    let mut inputs = vec![0.0; count(ComponentKind::Input)];
    model.initial_state(&mut q, &mut u, &mut inputs).unwrap();
    let (middle, rates) = (q, u);
    for _ in 0..10_000 {
        let mut q: Vec<f64> = middle.iter().map(|q| q + random.between(-0.4, 0.4)).collect();
        let u: Vec<f64> = rates.iter().map(|u| u + random.between(-1.0, 1.0)).collect();
        if model.normalise(&mut q).is_err() {
            continue;
        }
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
        let open = |contact| !matches!(model.gap(contact, &state), Ok(Some(gap)) if gap < 1e-3);
        if (0..count(ComponentKind::Contact)).all(open) && model.kinetic_energy(&state).is_ok() {
            return (q, u);
        }
    }
    panic!("no start of {}", model.name());
}

/// Runs one start.
///
/// A ball that rolls on a table and meets a wall with mu >= 1 has no outcome: to roll on it must slip up the
/// wall, which friction forbids, and sticking it cannot move away from the wall (mu_c = 1, and the reduced
/// matrix of the wall is singular in that direction).
fn run(model: &dyn Contacts<f64>, seed: u64, events: &mut usize) -> End {
    let mut random = Random::new(seed);
    let (q, u) = open_start(model, &mut random);
    let law = Law::ALL[random.below(Law::ALL.len())];
    let surface = Surface { mu: random.between(0.0, 1.2), e: random.between(0.0, 0.9), law };
    let options = Options { surface: Some(surface), ..Options::default() };
    let inputs = vec![0.0; model.count(ComponentKind::Input)];
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
    let mut simulation = Simulation::new(model, &state, options).unwrap();
    let mut seen: Vec<Event> = Vec::new();
    let what = |error: &SimulationError, seen: &[Event]| {
        format!(
            "{} start {seed}, {surface:?}: {error} after {:?}",
            model.name(),
            names(&seen[seen.len().saturating_sub(8)..])
        )
    };
    for k in 1..=100 {
        loop {
            match simulation.advance(0.1 * f64::from(k)) {
                Ok(Progress::Event(event)) => seen.push(event),
                Ok(Progress::Reached) => break,
                // The angles of the model have poles, as its text says.
                Err(SimulationError { kind: ErrorKind::State(StateError::Singular { .. }), .. }) => {
                    *events += seen.len();
                    return End::Pole;
                }
                Err(SimulationError {
                    kind: ErrorKind::Collision(CollisionError::Impact(ImpactError::Wedged { .. })),
                    ..
                }) if model.name() == "BallOnTurntable" && surface.mu >= 1.0 => {
                    *events += seen.len();
                    return End::Wedged;
                }
                Err(error) => return End::Failed(what(&error, &seen)),
            }
        }
        let numbers = simulation.coordinates().iter().chain(simulation.speeds());
        assert!(numbers.clone().all(|x| x.is_finite()), "{} start {seed}", model.name());
        // Nothing sinks in, and what is closed stays so.
        let state = State {
            time: simulation.time(),
            coordinates: simulation.coordinates(),
            speeds: simulation.speeds(),
            inputs: &inputs,
        };
        for contact in 0..model.count(ComponentKind::Contact) {
            if let Some(gap) = model.gap(contact, &state).unwrap() {
                assert!(
                    gap > -1e-10,
                    "{} start {seed}, t = {}: gap {gap:e}",
                    model.name(),
                    simulation.time()
                );
            }
        }
    }
    *events += seen.len();
    End::Whole
}

#[test]
fn shipped_models_run_from_random_starts() {
    let models: Vec<Box<dyn Contacts<f64>>> = vec![
        Box::new(hodograph_models::ball_on_turntable::BallOnTurntable::<f64>::default()),
        Box::new(hodograph_models::free_box_corner::FreeBoxCorner::<f64>::default()),
        Box::new(hodograph_models::free_box_quaternion::FreeBoxQuaternion::<f64>::default()),
        Box::new(hodograph_models::slender_rod_5dof::SlenderRod5dof::<f64>::default()),
        Box::new(hodograph_models::stanford_arm::StanfordArm::<f64>::default()),
    ];
    let count = starts(1);
    let mut failed = Vec::new();
    for model in models {
        let mut result = Count::default();
        for seed in count.clone() {
            match run(&*model, seed, &mut result.events) {
                End::Whole => result.whole += 1,
                End::Pole => result.poles += 1,
                End::Wedged => result.wedged += 1,
                End::Failed(why) => failed.push(why),
            }
        }
        println!("{}: {result:?} of {count:?}", model.name());
        let started = result.whole + result.poles + result.wedged;
        assert!(10 * result.poles <= started, "{}: {result:?}", model.name());
        // one surface in six has mu >= 1
        assert!(4 * result.wedged <= started, "{}: {result:?}", model.name());
    }
    assert!(failed.is_empty(), "{} starts:\n{}", failed.len(), failed.join("\n"));
}

/// The slip of this arm's hand ends where its direction, at 1e-10 m/s, has turned so far that it seems to
/// grow: its end was passed by, and the motion stopped with an error that made no sense of it.
#[test]
fn slip_that_turns_at_its_end_ends() {
    let arm = hodograph_models::stanford_arm::StanfordArm::<f64>::default();
    let mut events = 0;
    match run(&arm, 87, &mut events) {
        End::Whole => assert!(events >= 9),
        End::Failed(why) => panic!("{why}"),
        End::Pole | End::Wedged => panic!("the arm has no poles and no walls"),
    }
}
