//! Fits to motions that were made with known values.

use hodograph::{Law, Mechanism, State};
use hodograph_gradients::{By, FitError, FitTask, Loss, Trajectory, fit, fit_start};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Simulation;
use nalgebra::DMatrix;

use crate::common::{options, read};

/// Throws of the rod with these values of mu, e and the parameters (m, l, g), every 0.02 s: the places and the angle, with
/// errors of this size that are known.
fn throws(values: ([f64; 2], [f64; 3]), error: f64) -> Vec<Trajectory> {
    let mut rod = read("simulation/models/painleve_rod.mech");
    let ([mu, e], parameters) = values;
    rod.set_parameter_values(&parameters).unwrap();
    let starts = [[1.3, 0.7, 1.5, 2.0], [1.4, 1.1, -0.8, -1.0], [1.2, 0.3, 0.6, 3.0], [1.5, -0.4, -1.2, 1.0]];
    let throw = |(number, [z, q, u1, u3]): (usize, [f64; 4])| {
        let (coordinates, speeds) = ([0.0, z, q], [u1, 0.0, u3]);
        let state = State { time: 0.0, coordinates: &coordinates, speeds: &speeds, inputs: &[] };
        let mut simulation = Simulation::new(&rod, &state, options(mu, e, Law::Poisson)).unwrap();
        let times: Vec<f64> = (1..=35).map(|step| 0.02 * f64::from(step)).collect();
        let mut samples = DMatrix::zeros(times.len(), 3);
        for (row, &time) in times.iter().enumerate() {
            simulation.advance_to(time).unwrap();
            for column in 0..3 {
                let off =
                    error * (1e3 * (row as f64 + 0.37) * (column as f64 + 1.7) * (number as f64 + 0.9)).sin();
                samples[(row, column)] = simulation.coordinates()[column] + off;
            }
        }
        let state = [coordinates, speeds].concat();
        Trajectory { name: format!("throw {number}"), start: 0.0, state, times, samples }
    };
    starts.into_iter().enumerate().map(throw).collect()
}

fn task<'a>(trajectories: &'a [Trajectory], variables: &'a [By], bootstrap: usize) -> FitTask<'a> {
    let loss = Loss::Square;
    FitTask {
        trajectories,
        measured: &[0, 1, 2],
        units: &[1e-3; 3],
        variables,
        loss,
        flight: None,
        horizons: &[],
        starts: 1,
        bootstrap,
        seed: 1,
    }
}

fn rod() -> InterpretedMechanism {
    read("simulation/models/painleve_rod.mech")
}

#[test]
fn values_are_found_again() {
    let throws = throws(([0.23, 0.61], [1.0, 1.04, 9.7]), 0.0);
    let variables = [By::Friction(None), By::Restitution(None), By::Parameter(1), By::Parameter(2)];
    let found = fit(&rod(), &options(0.2, 0.55, Law::Poisson), &task(&throws, &variables, 0)).unwrap();
    let exact = [0.23, 0.61, 1.04, 9.7];
    for (found, exact) in found.values.iter().zip(exact) {
        assert!((found - exact).abs() < 1e-9 * exact, "{found} instead of {exact}");
    }
    assert!(found.rms < 1e-6 && found.undetermined.is_empty(), "{found:?}");
    assert_eq!(found.differences, 4 * 35 * 3);
    assert!(found.without_derivatives.is_empty(), "{found:?}");
}

/// The mass of a single body changes nothing of its motion: the fit says so, and finds the rest.
#[test]
fn what_is_not_determined_is_told() {
    let throws = throws(([0.23, 0.61], [1.0, 1.0, 9.81]), 0.0);
    let variables = [By::Restitution(None), By::Parameter(0)];
    let found = fit(&rod(), &options(0.23, 0.55, Law::Poisson), &task(&throws, &variables, 0)).unwrap();
    assert!((found.values[0] - 0.61).abs() < 1e-9);
    assert_eq!(found.undetermined.len(), 1, "{found:?}");
    assert!((found.undetermined[0][1].abs() - 1.0).abs() < 1e-6, "{found:?}");
    assert!(found.errors[1].is_infinite() && found.errors[0].is_finite());
}

/// With errors of measurement: the values lie within some standard errors, and draws of the trajectories spread alike.
#[test]
fn errors_are_those_of_the_data() {
    let throws = throws(([0.23, 0.61], [1.0, 1.0, 9.81]), 1e-3);
    let variables = [By::Friction(None), By::Restitution(None)];
    let found = fit(&rod(), &options(0.2, 0.55, Law::Poisson), &task(&throws, &variables, 12)).unwrap();
    // The root of the mean square of a sine.
    assert!((found.rms - 0.5_f64.sqrt()).abs() < 0.05, "{found:?}");
    for ((value, exact), error) in found.values.iter().zip([0.23, 0.61]).zip(&found.errors) {
        assert!((value - exact).abs() < 4.0 * error && *error < 1e-2, "{found:?}");
    }
    let spread = found.spread.unwrap();
    for (spread, error) in spread.iter().zip(&found.errors) {
        assert!(*spread > 0.02 * error && *spread < 20.0 * error, "{spread} {error}");
    }
    assert!((found.correlations[(0, 0)] - 1.0).abs() < 1e-12 && found.correlations[(0, 1)].abs() < 1.0);
}

/// One throw was measured wrongly, by centimetres: squares let it decide, the other losses do not.
#[test]
fn wrong_measurements_decide_little_by_robust_losses() {
    let mut throws = throws(([0.23, 0.61], [1.0, 1.0, 9.81]), 1e-3);
    for row in 20..35 {
        throws[2].samples[(row, 0)] += 0.05;
    }
    let variables = [By::Friction(None), By::Restitution(None)];
    let off = |loss: Loss| {
        let task = FitTask { loss, ..task(&throws, &variables, 0) };
        let found = fit(&rod(), &options(0.2, 0.55, Law::Poisson), &task).unwrap();
        assert_eq!(found.differences, 4 * 35 * 3);
        // the errors of measurement are below one unit, the wrong ones above fifty
        let outliers = if loss == Loss::Square { 0 } else { 15 };
        assert_eq!(found.outliers, outliers, "{loss:?}");
        assert!(found.rms > 8.0, "all differences are told: {found:?}");
        (found.values[0] - 0.23).abs()
    };
    let (square, huber, cap) = (off(Loss::Square), off(Loss::Huber(3.0)), off(Loss::Cap(3.0)));
    assert!(huber < 0.2 * square && cap < 0.2 * square, "{square} {huber} {cap}");
    let task = FitTask { loss: Loss::Cap(-1.0), ..task(&throws, &variables, 0) };
    let refused = fit(&rod(), &options(0.2, 0.55, Law::Poisson), &task);
    assert!(matches!(&refused, Err(FitError::BadRequest(what)) if what.contains("positive")), "{refused:?}");
}

#[test]
fn tasks_that_are_wrong_are_refused() {
    let mut throws = throws(([0.2, 0.5], [1.0, 1.0, 9.81]), 0.0);
    throws[1].times[3] = 0.0;
    let found = fit(&rod(), &options(0.2, 0.5, Law::Poisson), &task(&throws, &[By::Friction(None)], 0));
    assert!(matches!(&found, Err(FitError::BadRequest(what)) if what.contains("throw 1")), "{found:?}");
    let found = fit(&rod(), &options(0.2, 0.5, Law::Poisson), &task(&throws[..1], &[By::Speed(0)], 0));
    assert!(matches!(found, Err(FitError::BadRequest(_))), "{found:?}");
    // one trajectory has no spread, and cells that are all empty say nothing
    let found = fit(&rod(), &options(0.2, 0.5, Law::Poisson), &task(&throws[..1], &[By::Friction(None)], 5));
    assert!(matches!(&found, Err(FitError::BadRequest(what)) if what.contains("bootstrap")), "{found:?}");
    throws[0].samples.fill(f64::NAN);
    let found = fit(&rod(), &options(0.2, 0.5, Law::Poisson), &task(&throws[..1], &[By::Friction(None)], 0));
    assert!(matches!(&found, Err(FitError::BadRequest(what)) if what.contains("no value")), "{found:?}");
}

/// Start states that were measured with errors, from the samples in flight: within some standard errors, which are much
/// smaller; speeds that were not measured at all are found.
#[test]
fn start_states_are_fitted_to_flight() {
    let values = ([0.23, 0.61], [1.0, 1.0, 9.81]);
    let exact = throws(values, 0.0);
    let measured = throws(values, 1e-3);
    let mechanism = rod();
    let options = options(0.23, 0.61, Law::Poisson);
    let columns = (&[0, 1, 2][..], &[1e-3; 3][..]);
    for (exact, mut measured) in exact.iter().zip(measured) {
        measured.state[1] += 1e-3;
        measured.state[3..].fill(0.0);
        let found = fit_start(&mechanism, &options, columns, &measured, 0.12).unwrap();
        for ((value, exact), error) in found.trajectory.state.iter().zip(&exact.state).zip(&found.errors) {
            assert!((value - exact).abs() < 5.0 * error && *error < 0.03, "{value} {exact} {error}");
        }
        assert!(found.errors[..3].iter().all(|error| *error < 1.1e-3), "{:?}", found.errors);
        assert!(found.rms < 1.0 && found.covariance[(0, 3)] < 0.0, "{found:?}");
        // Without errors it is the start itself.
        let mut free = exact.clone();
        free.state[3..].fill(0.1);
        let again = fit_start(&mechanism, &options, columns, &free, 0.12).unwrap();
        for (value, exact) in again.trajectory.state.iter().zip(&exact.state) {
            assert!((value - exact).abs() < 1e-9, "{value} {exact}");
        }
        let late = fit_start(&mechanism, &options, columns, &measured, 0.7);
        assert!(
            matches!(&late, Err(FitError::BadRequest(what)) if what.contains("shorter flight")),
            "{late:?}"
        );
        let none = fit_start(&mechanism, &options, columns, &measured, 0.01);
        assert!(matches!(&none, Err(FitError::BadRequest(what)) if what.contains("no sample")), "{none:?}");
    }
}

/// Gravity decides what start the samples of a flight tell: the start follows the value that is tried, whether it was
/// measured or not, and both are found. One that depends on no value is the same as before.
#[test]
fn start_states_follow_the_values_that_are_fitted() {
    let mut throws = throws(([0.23, 0.61], [1.0, 1.04, 9.7]), 0.0);
    let exact: Vec<Vec<f64>> = throws.iter().map(|throw| throw.state.clone()).collect();
    for throw in &mut throws {
        throw.state[3..].fill(0.0);
    }
    let variables = [By::Friction(None), By::Restitution(None), By::Parameter(1), By::Parameter(2)];
    let task = FitTask { flight: Some(0.12), units: &[1e-3; 3], ..task(&throws, &variables, 0) };
    let found = fit(&rod(), &options(0.2, 0.55, Law::Poisson), &task).unwrap();
    for (found, exact) in found.values.iter().zip([0.23, 0.61, 1.04, 9.7]) {
        assert!((found - exact).abs() < 1e-8 * exact, "{found} instead of {exact}");
    }
    for (start, exact) in found.starts.iter().zip(&exact) {
        for (value, exact) in start.trajectory.state.iter().zip(exact) {
            assert!((value - exact).abs() < 1e-7, "{value} {exact}");
        }
    }
    assert!(found.rms < 1e-5 && found.undetermined.is_empty(), "{found:?}");
    // Friction and restitution alone: gravity has to be right.
    let mut mechanism = rod();
    mechanism.set_parameter_values(&[1.0, 1.04, 9.7]).unwrap();
    let task = FitTask { variables: &variables[..2], ..task };
    let found = fit(&mechanism, &options(0.2, 0.55, Law::Poisson), &task).unwrap();
    assert!((found.values[0] - 0.23).abs() < 1e-9 && (found.values[1] - 0.61).abs() < 1e-9, "{found:?}");
    assert_eq!(found.starts.len(), throws.len());
    let twice = [By::Restitution(Some(0)), By::Restitution(None)];
    let twice = fit(&mechanism, &options(0.2, 0.55, Law::Poisson), &FitTask { variables: &twice, ..task });
    assert!(matches!(&twice, Err(FitError::BadRequest(what)) if what.contains("all contacts")), "{twice:?}");
}

/// With little friction a descent ends in another minimum, mu = 0.037, e = 0.486; one of several starts leads to the values.
#[test]
fn starts_lead_out_of_other_minima() {
    let throws = throws(([0.23, 0.61], [1.0, 1.0, 9.81]), 0.0);
    let variables = [By::Friction(None), By::Restitution(None)];
    let count = |horizons: &[f64], starts| {
        let mut ends = 0;
        for (mu, e) in [(0.04, 0.3), (0.05, 0.5), (0.02, 0.1), (0.8, 0.95)] {
            let task = FitTask { horizons, starts, ..task(&throws, &variables, 0) };
            let found = fit(&rod(), &options(mu, e, Law::Poisson), &task).unwrap();
            println!("{horizons:?} {starts} from {mu} {e}: {:?}", found.minima.first());
            assert!(
                found.minima.windows(2).all(|pair| pair[0].1 <= pair[1].1 + 1e-9)
                    && found.minima.len() <= starts
            );
            ends += usize::from(found.rms < 1e-6);
        }
        ends
    };
    let (alone, by_horizons, by_starts) = (count(&[], 1), count(&[0.3, 0.45], 1), count(&[], 12));
    println!("{alone} {by_horizons} {by_starts} of 4");
    assert!(alone < by_starts && by_horizons > 0, "{alone} {by_horizons} {by_starts}");
    for (horizons, starts) in [(&[0.3, 0.2][..], 1), (&[-1.0][..], 1), (&[][..], 0)] {
        let wrong = FitTask { horizons, starts, ..task(&throws, &variables, 0) };
        let wrong = fit(&rod(), &options(0.2, 0.5, Law::Poisson), &wrong);
        assert!(matches!(wrong, Err(FitError::BadRequest(_))), "{wrong:?}");
    }
}
