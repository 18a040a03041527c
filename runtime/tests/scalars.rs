//! The solver in other number types.

use crate::common::{reference_cases, two_sleds};
use hodograph::{Law, ReducedMatrix, Surface, solve};
use nalgebra::Vector3;
use num_dual::Dual64;

#[test]
fn single_precision() {
    for case in reference_cases().iter().filter(|c| c.family == "random" && c.condition < 20.0) {
        let entries: [f64; 6] = case.matrix.into();
        let matrix = ReducedMatrix::from(entries.map(|x| x as f32));
        let surface = Surface { mu: case.surface.mu as f32, e: case.surface.e as f32, law: case.surface.law };
        let hit = solve(&matrix, &case.approach.map(|x| x as f32), &surface).expect("an outcome");
        let error = (hit.impulse.map(f64::from) - case.impulse).amax() / case.impulse.amax();
        assert!(error < 1e-5 * case.condition.max(1.0), "{error:e}: {}", case.line);
    }
}

#[test]
fn dual_numbers_give_the_derivative_by_friction() {
    for mu in [0.6, 1.1, 1.6] {
        for &law in Law::ALL {
            let (m, v, s) = two_sleds(mu, law);
            let entries: [f64; 6] = m.into();
            let matrix = ReducedMatrix::from(entries.map(Dual64::from_re));
            let surface = Surface { mu: Dual64::from_re(mu).derivative(), e: Dual64::from_re(s.e), law };
            let hit = solve(&matrix, &v.map(Dual64::from_re), &surface).expect("an outcome");
            let at = |mu| solve(&m, &v, &Surface { mu, ..s }).expect("an outcome");
            let step = 1e-6;
            let (up, down) = (at(mu + step), at(mu - step));
            let difference = (up.impulse - down.impulse) / (2.0 * step);
            let dual = Vector3::new(hit.impulse.x.eps, hit.impulse.y.eps, hit.impulse.z.eps);
            assert!(
                (dual - difference).amax() < 1e-6 * (difference.amax() + hit.impulse.amax().re),
                "mu {mu} {law:?}: {dual} {difference}"
            );
        }
    }
}

/// Slip that stops just before compression ends: what is left of v_n is no rounding in single precision
/// either.
#[test]
fn slip_that_stops_before_compression_ends_in_single_precision() {
    let m = [0.7980910561809162, 0.0, 0.0, 1.5008655574994163, -0.3919651410907144, 0.4638920694939901];
    let v = Vector3::new(-1.0048982696933053, -0.16438534974234997, -0.09064043543938438);
    let surface = Surface { mu: 0.344617768447986, e: 0.592074453926204, law: hodograph::Law::Newton };
    let exact = solve(&ReducedMatrix::from(m), &v, &surface).expect("an outcome").impulse;
    let single = Surface { mu: surface.mu as f32, e: surface.e as f32, law: surface.law };
    let hit =
        solve(&ReducedMatrix::from(m.map(|x| x as f32)), &v.cast::<f32>(), &single).expect("an outcome");
    let error = (hit.impulse.cast::<f64>() - exact).amax() / exact.amax();
    assert!(error < 1e-6, "{error:e}");
}
