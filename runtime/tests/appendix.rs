//! Appendix B: the ellipse g = 0 and the hyperbola h = 0 in the plane of u = mu cos phi and v = mu sin phi,
//! and the run mu = mu_s of section 5.

use crate::common::two_sleds;
use hodograph::{Characteristics, Hodograph, Law, Motion, Path, ReducedMatrix, Surface, rates};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};
use proptest::prelude::*;

prop_compose! {
    /// A matrix of full rank.
    fn matrix()(entries in prop::array::uniform9(-2.0..2.0_f64)) -> ReducedMatrix<f64> {
        let b = Matrix3::from(std::array::from_fn::<_, 3, _>(|i| std::array::from_fn::<_, 3, _>(|j| entries[3 * i + j])));
        ReducedMatrix::from(b * b.transpose())
    }
}

/// The direction from the origin to a point, and its distance: phi and mu.
fn polar(p: &Vector2<f64>) -> (f64, f64) {
    (p.y.atan2(p.x), p.norm())
}

/// The angle between two lines, from 0 to a right angle.
fn between(a: f64, b: f64) -> f64 {
    (a - b).sin().abs().asin()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, max_global_rejects: 20_000, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(40), ..ProptestConfig::default() })]

    #[test]
    fn ellipse_and_hyperbola(m in matrix(), turn in 0.0..6.3_f64, along in 0.1..3.0_f64) {
        let t = Matrix2::new(m.tt, m.ts, m.ts, m.ss);
        let b = Vector2::new(m.nt, m.ns);
        prop_assume!(t.determinant() > 1e-2 && b.norm() > 1e-2);
        let half = (m.tt - m.ss) / 2.0;
        prop_assume!(half.hypot(m.ts) > 1e-2 && m.ts.abs() > 1e-3 && half.abs() > 1e-3);
        let size = t.norm() + b.norm();
        let conic = |form: &Matrix2<f64>, linear: &Vector2<f64>, p: &Vector2<f64>| linear.dot(p) - p.dot(&(form * p));
        // The coefficients of (69) and (70), with the sign of h that (33) has.
        let across = Vector2::new(m.ns, -m.nt);
        let twist = Matrix2::new(m.ts, -half, -half, -m.ts);

        // (69), (70): mu g and mu h are these forms at (mu cos phi, mu sin phi).
        let (sin, cos) = turn.sin_cos();
        let p = Vector2::new(cos, sin) * along;
        let [_, g, h] = rates(&m, along, turn).into();
        let close = 1e-12 * size * (1.0 + along) * (1.0 + along);
        prop_assert!((along * g - conic(&t, &b, &p)).abs() <= close);
        prop_assert!((along * h - conic(&twist, &across, &p)).abs() <= close);

        // (71): the eigenvalues of the ellipse are positive; (72): those of the hyperbola are opposite.
        let trace = m.tt + m.ss;
        let root = (trace * trace - 4.0 * (m.tt * m.ss - m.ts * m.ts)).sqrt();
        let ellipse = SymmetricEigen::new(t);
        let hyperbola = SymmetricEigen::new(twist);
        let sorted = |v: &Vector2<f64>| (v.min(), v.max());
        let (small, large) = sorted(&ellipse.eigenvalues);
        prop_assert!(((trace - root) / 2.0 - small).abs() <= 1e-11 * size && ((trace + root) / 2.0 - large).abs() <= 1e-11 * size);
        prop_assert!(small > 0.0 && root < trace);
        let (low, high) = sorted(&hyperbola.eigenvalues);
        let lambda = m.ts.hypot(half);
        prop_assert!((low + lambda).abs() <= 1e-11 * size && (high - lambda).abs() <= 1e-11 * size);

        // (73): the axes, and the angle of pi/4 between them.
        let phi_e = 0.5 * m.ts.atan2(half);
        let phi_h = 0.5 * (-half).atan2(m.ts);
        prop_assert!(((2.0 * phi_e).tan() - 2.0 * m.ts / (m.tt - m.ss)).abs() <= 1e-9 * (2.0 * phi_e).tan().abs().max(1.0));
        prop_assert!(((2.0 * phi_h).tan() + 0.5 * (m.tt - m.ss) / m.ts).abs() <= 1e-9 * (2.0 * phi_h).tan().abs().max(1.0));
        let axis = |e: &SymmetricEigen<f64, nalgebra::U2>| polar(&e.eigenvectors.column(e.eigenvalues.imax()).into_owned()).0;
        prop_assert!(between(axis(&ellipse), phi_e) <= 1e-6);
        prop_assert!(between(axis(&hyperbola), phi_h) <= 1e-6);
        prop_assert!((between(phi_e, phi_h) - std::f64::consts::FRAC_PI_4).abs() <= 1e-9);

        // (74): both pass through the origin, where they cross at right angles.
        let phi_g = (-m.nt).atan2(m.ns);
        let phi_0 = m.ns.atan2(m.nt);
        prop_assert!(rates(&m, 0.0, phi_g).y.abs() <= close && rates(&m, 0.0, phi_0).z.abs() <= close);
        prop_assert!((between(phi_g, phi_0) - std::f64::consts::FRAC_PI_2).abs() <= 1e-7);

        // They meet again at (mu_c, phi_c) alone: on the ellipse, h changes sign nowhere else.
        let c = Characteristics::of(&m, along);
        let [_, g, h] = rates(&m, c.mu_c, c.phi_c).into();
        let close = 1e-9 * size * (1.0 + c.mu_c);
        prop_assert!(g.abs() <= close && h.abs() <= close);
        let ours = Vector2::new(c.phi_c.cos(), c.phi_c.sin()) * c.mu_c;
        prop_assert!((t * ours - b).amax() <= close);
        // Inside the ellipse g > 0: there lies phi_hat, and it is the only root of h that does.
        if let Some(renewal) = c.renewal.filter(|renewal| renewal.g_hat > 1e-6 * size) {
            prop_assert!(renewal.g_hat > 0.0 && renewal.f_hat > 0.0);
            let mut inside = 0;
            let steps = 500;
            let at = |k: f64| rates(&m, along, renewal.phi_hat + std::f64::consts::TAU * (k + 0.5) / f64::from(steps));
            for k in 0..steps {
                let (mut low, mut high) = (f64::from(k), f64::from(k + 1));
                let rises = at(low).z < 0.0;
                if (at(high).z < 0.0) == rises {
                    continue;
                }
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    if (at(middle).z < 0.0) == rises { low = middle } else { high = middle }
                }
                inside += usize::from(at(low).y > 0.0);
            }
            prop_assert_eq!(inside, 1);
        }
    }

    /// Any contact with mu = m_ns / m_ts and slip along t (section 3.3, at its end): phi = 0 until slip stops, then renewal or sticking.
    #[test]
    fn at_mu_s_slip_keeps_its_direction(m in matrix(), slip in 0.05..1.5_f64, e in 0.0..=1.0_f64) {
        let c = Characteristics::of(&m, 1.0);
        let Some(mu) = c.mu_s else { return Err(TestCaseError::reject("no mu_s")) };
        prop_assume!(mu > 0.05 && mu < 3.0 && m.nn > 1e-2 && Matrix3::from(m).determinant() > 1e-2);
        let v = Vector3::new(-1.0, slip, 0.0);
        prop_assume!((mu / c.mu_c - 1.0).abs() > 1e-3);
        // Where it repels, rounding is enough to turn it.
        let slope = mu * (m.tt - m.ss) - m.nt;
        prop_assume!(slope < 0.0);
        let whole = Hodograph::new(&m, &v, &Surface { mu, e, law: Law::Stronge }).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let stop = whole.impact().phases.slip_end;
        for point in whole.points(21) {
            if point.motion == Motion::Sliding {
                prop_assert!(point.velocity.z.abs() <= 1e-12 && point.velocity.y >= -1e-12);
            }
        }
        let expected = match stop {
            None => Path::Sliding,
            Some(_) if mu < c.mu_c => Path::SlidingThenRenewal,
            Some(_) => Path::SlidingThenSticking,
        };
        prop_assert_eq!(whole.impact().path, expected);
    }
}

/// The run mu = mu_s of the example: phi = 0 throughout, then renewal in the direction phi_hat, since mu_s <
/// mu_c.
#[test]
fn at_mu_s_the_sleds_slip_straight_and_then_in_another_direction() {
    for &law in Law::ALL {
        let (m, v, surface) = two_sleds(1.0, law);
        let mu = Characteristics::of(&m, 1.0).mu_s.expect("m_ts is not zero");
        let c = Characteristics::of(&m, mu);
        assert!(mu < c.mu_c && rates(&m, mu, 0.0).z.abs() < 1e-16);
        let whole = Hodograph::new(&m, &v, &Surface { mu, ..surface }).unwrap();
        assert_eq!(whole.impact().path, Path::SlidingThenRenewal);
        let stop = whole.impact().phases.slip_end.expect("slip stops").impulse.x;
        let phi_hat = c.renewal.expect("mu < mu_c").phi_hat;
        let mut counts = [0, 0];
        for point in whole.points(201) {
            if point.impulse.x < stop {
                assert!(point.velocity.z.abs() < 1e-13 && point.velocity.y > 0.0);
                counts[0] += 1;
            } else {
                assert!((point.direction().expect("it slips") - phi_hat).abs() < 1e-9);
                counts[1] += 1;
            }
        }
        assert!(counts[0] > 5 && counts[1] > 5, "{counts:?}");
        // Along t everything is linear: slip stops after v_t1 / -g(mu_s, 0).
        assert!((stop + v.y / rates(&m, mu, 0.0).y).abs() < 1e-12 * stop);
    }
}
