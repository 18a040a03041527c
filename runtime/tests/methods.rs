//! The paper's methods against the exact solver, on the paper's example (section 5).

mod common;

use common::two_sleds;
use hodograph::{
    Law,
    methods::{Method, solve_by, stability_bound},
    solve,
};

const LAWS: [Law; 3] = [Law::Newton, Law::Poisson, Law::Stronge];

#[test]
fn integration_agrees_with_the_exact_solution_whatever_epsilon_s() {
    for mu in [0.6, 1.1, 1.6] {
        for law in LAWS {
            let (matrix, approach, surface) = two_sleds(mu, law);
            let exact = solve(&matrix, &approach, &surface).expect("an outcome");
            // The paper says that 0.1 .. 0.01 makes no difference. Here the error falls in proportion, from some tenths at 0.1.
            for epsilon_s in [0.01, 1e-3, 1e-5] {
                let within = 20.0 * epsilon_s + 2e-4;
                let method = Method::Integrate { steps: 4000, epsilon_s };
                let hit = solve_by(method, &matrix, &approach, &surface).expect("an outcome");
                let error = (hit.impulse - exact.impulse).amax() / exact.impulse.amax();
                assert!(error < within, "mu {mu} {law:?} epsilon_s {epsilon_s}: {error:e}");
                assert_eq!(hit.path, exact.path);
            }
        }
    }
}

#[test]
fn the_error_of_the_summation_falls_with_k() {
    for mu in [0.6, 1.6] {
        let (matrix, approach, surface) = two_sleds(mu, Law::Poisson);
        let exact = solve(&matrix, &approach, &surface).expect("an outcome");
        let error = |k| {
            let hit = solve_by(Method::PartialSum { k }, &matrix, &approach, &surface).expect("an outcome");
            (hit.velocity.x - exact.velocity.x).abs() / exact.velocity.x
        };
        let (coarse, fine, finest) = (error(1), error(50), error(5000));
        assert!(fine < 0.5 * coarse && finest < 0.05 * fine, "mu {mu}: {coarse:e} {fine:e} {finest:e}");
    }
}

#[test]
fn stable_steps_shrink_with_the_slip() {
    let (matrix, _, surface) = two_sleds(1.6, Law::Newton);
    let phi_bar = 0.5980670;
    let bound = |slip| stability_bound(&matrix, surface.mu, -phi_bar, slip).expect("a stable root of h");
    assert!((bound(0.5) / bound(0.05) - 10.0).abs() < 1e-12);
    assert_eq!(stability_bound(&matrix, surface.mu, 0.36, 1.0), None);
}
