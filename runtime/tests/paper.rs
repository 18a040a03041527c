//! The nine outcomes of the paper's example, and its characteristics.

use crate::common::two_sleds;
use hodograph::{Characteristics, Law, Path, rates, solve};

/// mu, law, I_n2, v_n2, v_t2, v_s2 (s = t x n), dE, path.
type Outcome = (f64, Law, f64, f64, f64, f64, f64, Path);

const OUTCOMES: [Outcome; 9] = {
    use Law::{Newton, Poisson, Stronge};
    use Path::{Sliding, SlidingThenRenewal as Renewal, SlidingThenSticking as Sticking};
    [
        (0.6, Newton, 8.971948198, 0.7568864176, -0.3248973871, -0.3281050863, -1.436743011, Sliding),
        (0.6, Poisson, 6.152383187, 0.403583274, -0.1574039107, -0.161284564, -2.491550657, Sliding),
        (0.6, Stronge, 7.013981068, 0.5115321742, -0.2088974513, -0.2119217875, -2.232487328, Sliding),
        (1.1, Newton, 19.45541188, 0.7568864176, -0.1862359917, -0.1799531581, 1.375248751, Renewal),
        (1.1, Poisson, 4.921769084, 0.1397178113, -0.02287165415, -0.02210005895, -2.815883679, Renewal),
        (1.1, Stronge, 7.988210862, 0.2699337265, -0.0573397663, -0.05540535927, -2.375912802, Renewal),
        (1.6, Newton, 32.85398885, 0.7568864176, 0.0, 0.0, 9.162923556, Sticking),
        (1.6, Poisson, 4.037396922, 0.08032111863, 0.0, 0.0, -2.899810409, Sticking),
        (1.6, Stronge, 8.486951889, 0.1847892144, 0.0, 0.0, -2.309998909, Sticking),
    ]
};

#[test]
fn nine_outcomes() {
    for (mu, law, impulse, vn, vt, vs, work, path) in OUTCOMES {
        let (matrix, approach, surface) = two_sleds(mu, law);
        let hit = solve(&matrix, &approach, &surface).expect("an outcome");
        let near =
            |a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs().max(0.1), "mu {mu} {law:?}: {a} {b}");
        near(hit.impulse.x, impulse);
        near(hit.velocity.x, vn);
        near(hit.velocity.y, vt);
        near(hit.velocity.z, -vs);
        near(hit.contact_work, work);
        assert_eq!(hit.path, path);
        assert_eq!(hit.energy_gained().is_some(), law == Law::Newton && mu > 1.0);
    }
}

#[test]
fn characteristics_of_the_example() {
    let (matrix, ..) = two_sleds(1.1, Law::Newton);
    let c = Characteristics::of(&matrix, 1.1);
    assert!((c.mu_c - 1.2147135).abs() < 1e-7);
    assert!((c.mu_s.expect("m_ts is not zero") - 1.0855452).abs() < 1e-7);
    let [n, t, s] = c.sticking.expect("it moves along n");
    assert!((n - 42.592).abs() < 1e-3 && (t - 37.3).abs() < 0.1 && (s + 35.8).abs() < 0.1);
    let renewal = c.renewal.expect("mu < mu_c");
    let [f, g, h] = rates(&matrix, 1.1, renewal.phi_hat).into();
    assert!((renewal.f_hat - f).abs() < 1e-15 && (renewal.g_hat - g).abs() < 1e-15 && h.abs() < 1e-15);
    assert!((renewal.f_hat - 0.0425).abs() < 1e-4);
    // The paper's angle, with its opposite s.
    assert!(
        (renewal.phi_hat + 3.90984 - std::f64::consts::TAU).abs() < 1e-5
            || (renewal.phi_hat + 3.90984).abs() < 1e-5
    );
    assert_eq!(Characteristics::of(&matrix, 1.6).renewal, None);
}
