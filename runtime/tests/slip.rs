//! Random contacts of rank 1 to 3: the exact solver against integration, Coulomb's law along the arc, and the
//! geometry of section 3 and Appendix B.
#![cfg(feature = "std")]

use hodograph::{
    Characteristics, Impact, ImpactError, Law, Path, ReducedMatrix, Surface,
    methods::{Integration, MethodError, integrate},
    rates, solve,
};
use nalgebra::{Matrix3, Vector2, Vector3};
use proptest::{prelude::*, test_runner::RngSeed};

prop_compose! {
    /// B B^T with a B of one to three columns, and a velocity in its range: no prescribed motion.
    fn contact(ranks: core::ops::Range<usize>)(
        entries in prop::array::uniform9(-2.0..2.0_f64), rank in ranks, speeds in prop::array::uniform3(-1.5..1.5_f64)
    ) -> (ReducedMatrix<f64>, Vector3<f64>) {
        let mut b = Matrix3::from_row_slice(&entries);
        for column in rank..3 {
            b.column_mut(column).fill(0.0);
        }
        let v = b * Vector3::from(speeds);
        (ReducedMatrix::from(b * b.transpose()), if v.x > 0.0 { -v } else { v })
    }
}

fn law() -> impl Strategy<Value = Law> {
    prop::sample::select(Law::ALL)
}

fn seeded(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        max_global_rejects: 100 * cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(20),
        ..ProptestConfig::default()
    }
}

fn apart(a: &Impact<f64>, b: &Impact<f64>, approach: &Vector3<f64>) -> f64 {
    let (impulse, velocity) = (b.impulse.amax(), b.velocity.amax() + approach.amax());
    ((a.impulse - b.impulse).amax() / impulse)
        .max((a.velocity - b.velocity).amax() / velocity)
        .max((a.contact_work - b.contact_work).abs() / (impulse * velocity))
        .max((a.normal_work - b.normal_work).abs() / (impulse * velocity))
}

fn ok<T, E: core::fmt::Display>(answer: Result<T, E>) -> Result<T, TestCaseError> {
    answer.map_err(|error| TestCaseError::fail(error.to_string()))
}

proptest! {
    #![proptest_config(seeded(400))]

    /// The second road: the work by (35a) rather than (23), phi and s rather than series.
    #[test]
    fn integration_agrees((m, v) in contact(1..4), mu in 0.0..3.0_f64, e in 0.0..=1.0_f64, law in law()) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2);
        let surface = Surface { mu, e, law };
        let exact = match solve(&m, &v, &surface) {
            Ok(exact) => exact,
            Err(error) => {
                let theirs = integrate(&m, &v, &surface, &Integration::default());
                let agrees = matches!(error, ImpactError::Wedged { .. })
                    && matches!(theirs, Err(MethodError::Impact(ImpactError::Wedged { .. }) | MethodError::Unfinished { .. }));
                prop_assert!(agrees, "{} {:?}", error, theirs);
                return Ok(());
            }
        };
        let ours = ok(integrate(&m, &v, &surface, &Integration::with_tolerance(1e-11)))?.impact;
        // What a small change of the input does to the exact answer, for it may be ill-conditioned.
        let mut moved = 0.0_f64;
        for change in [1.0 - 1e-7, 1.0 + 1e-7] {
            for other in [Surface { mu: mu * change, ..surface }, Surface { e: (e * change).min(1.0), ..surface }] {
                match solve(&m, &v, &other) {
                    Ok(near) => moved = moved.max(apart(&near, &exact, &v)),
                    Err(_) => moved = f64::INFINITY,
                }
            }
        }
        let apart = apart(&ours, &exact, &v);
        prop_assert!(apart <= 1e-8 + 0.01 * moved, "{:e}, moved {:e}", apart, moved);
    }

    /// (29): |I_tan| <= mu I_n, and along the arc dI_tan = -mu d dI_n, where d is the direction of slip. Restitution under Poisson's hypothesis makes
    /// the end of the collision a point of the arc.
    #[test]
    fn friction_opposes_slip((m, v) in contact(1..4), mu in 0.0..3.0_f64, e in 0.05..0.95_f64, law in law()) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2);
        if let Ok(hit) = solve(&m, &v, &Surface { mu, e, law }) {
            prop_assert!(hit.impulse.yz().norm() <= mu * hit.impulse.x * (1.0 + 1e-9) + 1e-13);
        }
        let at = |e| solve(&m, &v, &Surface { mu, e, law: Law::Poisson });
        let d = 1e-5;
        let (Ok(a), Ok(middle), Ok(b)) = (at(e - d), at(e), at(e + d)) else { return Ok(()) };
        let slides = |hit: &Impact<f64>| hit.compressions == 1
            && matches!(hit.path, Path::Sliding | Path::SlidingThenRenewal | Path::Renewal);
        prop_assume!(slides(&a) && slides(&middle) && slides(&b) && a.path == b.path && a.path == middle.path);
        let slip: Vector2<f64> = middle.velocity.yz();
        let ends = [a, b].map(|hit| hit.velocity.yz());
        let turn = (ends[0].normalize() - ends[1].normalize()).norm();
        prop_assume!(slip.norm() > 1e-3 && turn < 1e-3);
        let change = b.impulse - a.impulse;
        let rubbed = change.yz() / change.x;
        prop_assert!((rubbed + slip.normalize() * mu).norm() <= 1e-6 + mu * turn, "{} {}", rubbed, slip);
    }

    /// f constant to the end: no slip at the start, or e = 0, where every law ends with compression.
    #[test]
    fn laws_agree_where_they_must((m, v) in contact(3..4), mu in 0.0..3.0_f64, e in 0.0..=1.0_f64, still in any::<bool>()) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2 && Matrix3::from(m).determinant() > 1e-3);
        let (v, e) = if still { (Vector3::new(v.x, 0.0, 0.0), e) } else { (v, 0.0) };
        let first = ok(solve(&m, &v, &Surface { mu, e, law: Law::ALL[0] }))?;
        for &law in &Law::ALL[1..] {
            let other = ok(solve(&m, &v, &Surface { mu, e, law }))?;
            prop_assert!(apart(&first, &other, &v) <= 1e-10);
        }
        if still {
            prop_assert!(matches!(first.path, Path::Sticking | Path::Renewal));
        } else {
            prop_assert!(first.velocity.x.abs() <= 1e-10 * (v.amax() + first.impulse.amax()));
        }
    }

    /// Reflection of the tangential axes: (t, s) to (t, -s).
    #[test]
    fn reflection_does_not_matter((m, v) in contact(1..4), mu in 0.0..3.0_f64, e in 0.0..=1.0_f64, law in law()) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2);
        let surface = Surface { mu, e, law };
        let mirrored = ReducedMatrix { ns: -m.ns, ts: -m.ts, ..m };
        let w = Vector3::new(v.x, v.y, -v.z);
        match (solve(&m, &v, &surface), solve(&mirrored, &w, &surface)) {
            (Ok(a), Ok(mut b)) => {
                prop_assume!(a.compressions == 1 && b.compressions == 1);
                b.impulse.z = -b.impulse.z;
                b.velocity.z = -b.velocity.z;
                prop_assert!(apart(&b, &a, &v) <= 1e-7, "{:e}", apart(&b, &a, &v));
            }
            (a, b) => prop_assert_eq!(a.map_err(|e| e.kind()).err(), b.map_err(|e| e.kind()).err()),
        }
    }

    /// Stronge's hypothesis never gains energy.
    #[test]
    fn stronge_gains_no_energy((m, v) in contact(1..4), mu in 0.0..3.0_f64, e in 0.0..=1.0_f64) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2);
        if let Ok(hit) = solve(&m, &v, &Surface { mu, e, law: Law::Stronge }) {
            let rounding = 1e-12 * hit.impulse.amax() * (v.amax() + hit.velocity.amax());
            prop_assert!(hit.contact_work <= rounding && hit.normal_work <= rounding);
        }
    }

    /// mu = mu_s (end of 3.3): phi = 0 throughout; then renewal along phi_hat if mu_s < mu_c.
    #[test]
    fn slip_stays_straight_at_mu_s((m, v) in contact(3..4), e in 0.0..=1.0_f64, law in law()) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2 && Matrix3::from(m).determinant() > 1e-3 && v.y.abs() > 1e-3);
        // With the sign of t that makes mu_s positive; s may be chosen freely.
        let m = if m.ns * m.ts < 0.0 { ReducedMatrix { nt: -m.nt, ns: -m.ns, ..m } } else { m };
        prop_assume!(m.ts.abs() > 1e-2);
        let mu = m.ns / m.ts;
        prop_assume!(mu < 5.0);
        let v = Vector3::new(v.x, v.y.abs(), 0.0);
        prop_assert!(rates(&m, mu, 0.0).z.abs() <= 1e-14 * (m.ns.abs() + m.ts.abs()));
        let contact = Characteristics::of(&m, mu);
        let hit = ok(solve(&m, &v, &Surface { mu, e, law }))?;
        let size = v.amax() + hit.velocity.amax();
        match hit.path {
            Path::Sliding => {
                prop_assert!(hit.velocity.z.abs() <= 1e-9 * size && hit.velocity.y >= -1e-9 * size);
                prop_assert!(hit.impulse.z.abs() <= 1e-9 * hit.impulse.x);
            }
            Path::SlidingThenSticking => prop_assert!(contact.mu_c <= mu && hit.velocity.yz() == Vector2::zeros()),
            Path::SlidingThenRenewal => {
                let Some(renewal) = contact.renewal else { return Err(TestCaseError::fail("mu >= mu_c")) };
                let across = hit.velocity.z * renewal.phi_hat.cos() - hit.velocity.y * renewal.phi_hat.sin();
                prop_assert!(across.abs() <= 1e-9 * size);
            }
            other => return Err(TestCaseError::fail(format!("{other:?}"))),
        }
    }

    /// Appendix B: the ellipse g = 0 and the hyperbola h = 0 in u = mu cos phi, v = mu sin phi.
    #[test]
    fn ellipse_and_hyperbola((m, _) in contact(3..4), phi in 0.0..6.3_f64, part in 0.01..0.99_f64) {
        prop_assume!(m.nn > 1e-2 && Matrix3::from(m).determinant() > 1e-2 && m.ts.abs() > 1e-2);
        let tiny = 1e-10 * (m.nn + m.tt + m.ss);
        // The quadratic parts of g and h in a direction.
        let quadratic = |phi: f64| (rates(&m, 0.0, phi) - rates(&m, 1.0, phi)).yz();
        let half = (m.tt - m.ss) / 2.0;
        // (71) and (73): the extremes of the quadratic part of g are the eigenvalues of T, along and across phi_e.
        let phi_e = m.ts.atan2(half) / 2.0;
        prop_assert!(((2.0 * phi_e).tan() - 2.0 * m.ts / (m.tt - m.ss)).abs() <= 1e-8 * (1.0 + (2.0 * phi_e).tan().abs().powi(2)));
        let root = ((m.tt + m.ss).powi(2) - 4.0 * (m.tt * m.ss - m.ts * m.ts)).sqrt();
        let lambda = [((m.tt + m.ss) + root) / 2.0, ((m.tt + m.ss) - root) / 2.0];
        let right = core::f64::consts::FRAC_PI_2;
        prop_assert!((quadratic(phi_e).x - lambda[0]).abs() <= tiny && (quadratic(phi_e + right).x - lambda[1]).abs() <= tiny);
        prop_assert!(quadratic(phi_e).y.abs() <= tiny && lambda[1] > 0.0);
        prop_assert!(quadratic(phi).x <= lambda[0] + tiny && quadratic(phi).x >= lambda[1] - tiny);
        // (72) and (73): those of h are of opposite sign, at pi / 4 from phi_e.
        let size = m.ts.hypot(half);
        let phi_h = phi_e + right / 2.0;
        prop_assert!((quadratic(phi_h).y.abs() - size).abs() <= tiny && (quadratic(phi_h + right).y + quadratic(phi_h).y).abs() <= tiny);
        prop_assert!(((2.0 * phi_h).tan() + half / m.ts).abs() <= 1e-8 * (1.0 + (2.0 * phi_h).tan().abs().powi(2)));
        // (74): at the origin they are perpendicular.
        prop_assert!(rates(&m, 0.0, (-m.nt).atan2(m.ns)).y.abs() <= tiny && rates(&m, 0.0, m.ns.atan2(m.nt)).z.abs() <= tiny);
        // (75): g > 0 inside the ellipse, g < 0 outside.
        let mu_e = rates(&m, 0.0, phi).y / quadratic(phi).x;
        if mu_e > 1e-6 {
            prop_assert!(rates(&m, mu_e, phi).y.abs() <= tiny);
            prop_assert!(rates(&m, mu_e * part, phi).y > 0.0 && rates(&m, mu_e / part, phi).y < 0.0);
        }
        // (43), (44): the curves meet at (mu_c, phi_c).
        let contact = Characteristics::of(&m, 0.0);
        let meet = rates(&m, contact.mu_c, contact.phi_c);
        let tiny = tiny * (1.0 + contact.mu_c);
        prop_assert!(meet.y.abs() <= tiny && meet.z.abs() <= tiny);
        // Below mu_c exactly one root of h lies inside the ellipse: phi_hat.
        let mu = contact.mu_c * part;
        let Some(renewal) = Characteristics::of(&m, mu).renewal else { return Err(TestCaseError::fail("no renewal")) };
        let found = rates(&m, mu, renewal.phi_hat);
        prop_assert!(found.z.abs() <= tiny && found.y > 0.0);
        let steps = 2000;
        let angle = |i: i32| 2.0 * core::f64::consts::PI * f64::from(i) / f64::from(steps);
        let roots = (0..steps).filter(|&i| {
            let (a, b) = (rates(&m, mu, angle(i)), rates(&m, mu, angle(i + 1)));
            (a.z > 0.0) != (b.z > 0.0) && a.y > 0.0 && b.y > 0.0
        });
        prop_assert!(roots.count() <= 1);
    }
}
