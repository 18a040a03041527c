//! Laws of mechanics that every outcome obeys, over random contacts of rank 1 to 3.

use hodograph::{ImpactError, Law, Path, ReducedMatrix, Surface, solve};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

prop_compose! {
    /// B B^T with a B of one to three columns, and a velocity in its range: no prescribed motion.
    fn contact()(entries in prop::array::uniform9(-2.0..2.0_f64), rank in 1..4_usize, speeds in prop::array::uniform3(-1.5..1.5_f64))
        -> (ReducedMatrix<f64>, Vector3<f64>)
    {
        let mut b = Matrix3::from(std::array::from_fn::<_, 3, _>(|i| std::array::from_fn::<_, 3, _>(|j| entries[3 * i + j])));
        for column in rank..3 {
            b.column_mut(column).fill(0.0);
        }
        let mut v = b * Vector3::from(speeds);
        if v.x > 0.0 {
            v = -v;
        }
        (ReducedMatrix::from(b * b.transpose()), v)
    }
}

fn surface() -> impl Strategy<Value = Surface<f64>> {
    (0.0..3.0_f64, 0.0..=1.0_f64, prop::sample::select(Law::ALL)).prop_map(|(mu, e, law)| Surface {
        mu,
        e,
        law,
    })
}

/// Size of the terms that cancel in the checks.
fn scale(m: &ReducedMatrix<f64>, v: &Vector3<f64>, impulse: &Vector3<f64>) -> f64 {
    v.amax() + impulse.amax() * (m.nn + m.tt + m.ss)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, max_global_rejects: 20_000, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(10), ..ProptestConfig::default() })]

    #[test]
    fn mechanics_holds((m, v) in contact(), surface in surface()) {
        prop_assume!(m.nn > 1e-3 && v.x < -1e-3);
        let hit = match solve(&m, &v, &surface) {
            Ok(hit) => hit,
            // Only a singular contact may wedge.
            Err(ImpactError::Wedged { .. }) => {
                let det = Matrix3::from(m).determinant();
                prop_assert!(det < 1e-3 * m.nn * (m.tt + m.ss).powi(2), "wedged with det {}", det);
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let tiny = 1e-11 * scale(&m, &v, &hit.impulse);
        // (20)-(22)
        prop_assert!((m.apply(&hit.impulse) - (hit.velocity - v)).amax() <= tiny);
        // Coulomb
        let rubbed = hit.impulse.y.hypot(hit.impulse.z);
        prop_assert!(rubbed <= surface.mu * hit.impulse.x * (1.0 + 1e-10) || matches!(hit.path, Path::SlidingThenSticking | Path::Sticking));
        if matches!(hit.path, Path::SlidingThenSticking | Path::Sticking) {
            prop_assert_eq!((hit.velocity.y, hit.velocity.z), (0.0, 0.0));
        }
        // Separation, and work
        prop_assert!(hit.velocity.x >= -tiny);
        let work_scale = tiny * hit.impulse.amax();
        prop_assert!(hit.contact_work <= hit.normal_work + work_scale);
        if surface.law != Law::Newton {
            prop_assert!(hit.contact_work <= work_scale, "energy gained: {}", hit.contact_work);
        }
        if surface.law == Law::Newton {
            prop_assert!((hit.velocity.x + surface.e * v.x).abs() <= tiny);
        }
        if surface.e == 0.0 {
            prop_assert!(hit.velocity.x.abs() <= tiny);
        }
    }

    #[test]
    fn axes_and_units_do_not_matter((m, v) in contact(), surface in surface(), angle in 0.0..6.3_f64, mass in -6..6_i32, speed in -6..6_i32) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2 && Matrix3::from(m).determinant() > 1e-2);
        let (sin, cos) = angle.sin_cos();
        let (mass, speed) = (10.0_f64.powi(mass), 10.0_f64.powi(speed));
        let turned = m.turned(cos, sin);
        let entries: [f64; 6] = turned.into();
        let other = ReducedMatrix::from(entries.map(|x| x * mass));
        let w = Vector3::new(v.x, v.y * cos + v.z * sin, v.z * cos - v.y * sin) * speed;
        let a = solve(&m, &v, &surface).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let b = solve(&other, &w, &surface).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let i = b.impulse * (mass / speed);
        let back = Vector3::new(i.x, i.y * cos - i.z * sin, i.z * cos + i.y * sin);
        // Where a target grazes a maximum of v_n the outcome jumps, and no tolerance would do.
        prop_assume!(a.compressions == 1 && b.compressions == 1);
        prop_assert!((back - a.impulse).amax() <= 1e-6 * a.impulse.amax(), "{} {}", back, a.impulse);
    }

    #[test]
    fn laws_agree_without_friction_and_when_balanced((m, v) in contact(), mu in 0.0..2.0_f64, e in 0.0..=1.0_f64, balanced in any::<bool>()) {
        prop_assume!(m.nn > 1e-3 && v.x < -1e-3);
        let (m, mu) = if balanced { (ReducedMatrix { nt: 0.0, ns: 0.0, ..m }, mu) } else { (m, 0.0) };
        let hits: Result<Vec<_>, _> = Law::ALL.iter().map(|&law| solve(&m, &v, &Surface { mu, e, law })).collect();
        let Ok(hits) = hits else { return Err(TestCaseError::fail("no outcome")) };
        let tiny = 1e-11 * hits[0].impulse.amax();
        prop_assert!(hits.iter().all(|hit| (hit.impulse - hits[0].impulse).amax() <= tiny));
    }

    #[test]
    fn outcomes_are_continuous_across_mu_c((m, v) in contact(), e in 0.0..=1.0_f64, law in prop::sample::select(Law::ALL)) {
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2 && Matrix3::from(m).determinant() > 1e-1);
        let mu_c = hodograph::Characteristics::of(&m, 1.0).mu_c;
        let at = |mu: f64| solve(&m, &v, &Surface { mu, e, law });
        let (Ok(a), Ok(b)) = (at(mu_c * (1.0 - 1e-9)), at(mu_c * (1.0 + 1e-9))) else {
            return Err(TestCaseError::fail("no outcome"));
        };
        prop_assume!(a.compressions == 1 && b.compressions == 1);
        prop_assert!((a.impulse - b.impulse).amax() <= 1e-4 * a.impulse.amax());
    }
}

#[test]
fn bad_input_is_named() {
    let m = ReducedMatrix::new(1.0, 0.0, 0.0, 1.0, 0.0, 1.0);
    let v = Vector3::new(-1.0, 0.5, 0.0);
    let s = Surface { mu: 0.5, e: 0.5, law: Law::Poisson };
    let kind = |m: &ReducedMatrix<f64>, v: &Vector3<f64>, s: &Surface<f64>| {
        solve(m, v, s).map_err(|e| e.kind()).err()
    };
    assert_eq!(kind(&m, &v, &s), None);
    assert_eq!(kind(&m, &Vector3::new(f64::NAN, 0.0, 0.0), &s), Some("not_finite"));
    assert_eq!(kind(&m, &v, &Surface { mu: -1.0, ..s }), Some("negative_friction"));
    assert_eq!(kind(&m, &v, &Surface { e: 1.2, ..s }), Some("restitution_out_of_range"));
    assert_eq!(kind(&m, &-v, &s), Some("not_approaching"));
    assert_eq!(kind(&ReducedMatrix { nt: 2.0, ..m }, &v, &s), Some("not_positive_semidefinite"));
    assert_eq!(kind(&ReducedMatrix { nn: 0.0, ..m }, &v, &s), Some("no_normal_mobility"));
    // Sliding for ever along a direction without mobility.
    let wedge = ReducedMatrix::new(1.0, 1.0, 0.0, 1.0, 0.0, 0.0);
    let answer = solve(&wedge, &Vector3::new(-1.0, -0.1, 1.0), &Surface { mu: 2.0, ..s });
    let Err(ImpactError::Wedged { normal_velocity, .. }) = answer else { panic!("{answer:?}") };
    assert!((normal_velocity + 0.3226).abs() < 1e-4);
}

/// Minors and diagonal entries may be negative by what rounding explains, in any units, and by no more
/// (theory, 18.1).
#[test]
fn matrices_of_no_mechanism_are_refused_from_half_the_digits_on() {
    let (v, s) = (Vector3::new(-1.0, 0.5, 0.25), Surface { mu: 0.5, e: 0.5, law: Law::Poisson });
    let base = ReducedMatrix::<f64>::new(1.0, 0.0, 0.0, 1.0, 0.0, 1.0);
    let beyond = [
        |base: ReducedMatrix<f64>, x: f64| ReducedMatrix { nt: 1.0 + x, ..base },
        |base: ReducedMatrix<f64>, x: f64| ReducedMatrix { ns: -1.0 - x, ..base },
        |base: ReducedMatrix<f64>, x: f64| ReducedMatrix { ts: 1.0 + x, ..base },
        // All minors of two rows are positive; the determinant is -4.5 x.
        |base: ReducedMatrix<f64>, x: f64| ReducedMatrix { nt: 0.5 + x, ns: 0.5 + x, ts: -0.5 - x, ..base },
    ];
    let kind = |m: ReducedMatrix<f64>| solve(&m, &v, &s).map_err(|error| error.kind()).err();
    for unit in [1e-5, 1.0, 1e5] {
        let scaled = |m: ReducedMatrix<f64>| {
            ReducedMatrix::new(unit * m.nn, unit * m.nt, unit * m.ns, unit * m.tt, unit * m.ts, unit * m.ss)
        };
        for beyond in beyond {
            assert_eq!(kind(scaled(beyond(base, 1e-10))), None);
            for x in [1e-9, 1e-6, 1e-2] {
                assert_eq!(kind(scaled(beyond(base, x))), Some("not_positive_semidefinite"), "{x}");
            }
        }
        let impulse = |tt: f64| solve(&scaled(ReducedMatrix { tt, ..base }), &v, &s).map(|hit| hit.impulse);
        assert_eq!(impulse(-1e-14), impulse(0.0));
        assert!(impulse(0.0).is_ok());
        for place in 0..3 {
            let mut diagonal = [1.0; 3];
            diagonal[place] = -1e-12;
            let [nn, tt, ss] = diagonal;
            let wrong = kind(scaled(ReducedMatrix { nn, tt, ss, ..base }));
            assert_eq!(wrong, Some("not_positive_semidefinite"), "{place}");
        }
    }
}

/// Entries are uncertain by rounding of the largest diagonal entry, however small they are: a singular matrix
/// with such noise is one of a mechanism.
#[test]
fn noise_of_small_entries_is_no_reason_to_refuse() {
    let (v, s) = (Vector3::new(-1.0, 0.5, 0.25), Surface { mu: 0.5, e: 0.5, law: Law::Poisson });
    let mut indefinite = 0;
    for k in 1..400 {
        let [p, q, r] =
            [0.754_877_666, 0.569_840_291, 0.324_717_957].map(|step: f64| (f64::from(k) * step).fract());
        // Rank two, with the tangential rows small.
        let (size, (sin, cos)) = (1e-6 + 1e-5 * p, (core::f64::consts::TAU * q).sin_cos());
        let rows = [[1.0, 0.5 - r], [size * cos, size * sin], [size * r, size * (1.0 - r)]];
        let dot = |i: usize, j: usize| rows[i][0] * rows[j][0] + rows[i][1] * rows[j][1];
        let noise = 60.0 * f64::EPSILON * (2.0 * p - 1.0);
        let m = ReducedMatrix::new(dot(0, 0), dot(0, 1), dot(0, 2), dot(1, 1), dot(1, 2) + noise, dot(2, 2));
        let det = 1.0
            - (m.ts * m.ts) / (m.tt * m.ss)
            - (m.nt * m.nt) / (m.nn * m.tt)
            - (m.ns * m.ns) / (m.nn * m.ss)
            + 2.0 * m.nt * m.ns * m.ts / (m.nn * m.tt * m.ss);
        indefinite += u32::from(det < -1e-8);
        let answer = solve(&m, &v, &s).map_err(|error| error.kind()).err();
        assert_ne!(answer, Some("not_positive_semidefinite"), "{k}: {det:e} {m:?}");
    }
    assert_eq!(indefinite, 223);
}

#[test]
fn bodies_may_approach_twice() {
    let m = ReducedMatrix::new(2.1, -2.1, -1.35, 2.3, 1.15, 4.3);
    let v = Vector3::new(-0.22, -0.2, 1.0);
    for (law, expected) in [(Law::Poisson, 0.15700905_f64), (Law::Stronge, 0.14009101)] {
        let hit = solve(&m, &v, &Surface { mu: 1.95, e: 0.5, law }).expect("an outcome");
        assert!((hit.velocity.x - expected).abs() < 1e-8, "{law:?} {}", hit.velocity.x);
        assert_eq!(hit.compressions, 2);
    }
}

/// Steep friction on ill-conditioned contacts: where f changes sign it is known to mu |b| times the rounding
/// only, and the arc must pass on all the same. The velocities are those of the integration (55).
#[test]
fn steep_friction_does_not_stop_the_arc_where_v_n_turns() {
    let cases = [
        (
            [
                0.3223414691164295,
                -0.34342119009889105,
                0.26490407549053085,
                0.4224080478250662,
                -0.35330814811247846,
                0.3074049344324396,
            ],
            [-0.7079075719093231, -0.41982493158764256, 0.28679393103426165],
            Surface { mu: 3.0346090856486168, e: 1.0, law: Law::Poisson },
            0.99123_f64,
        ),
        (
            [
                6.268007035639618,
                -3.2192551243982894,
                5.370087709905249,
                2.3941255607594942,
                -4.081729864415486,
                6.966477306335962,
            ],
            [-0.47557321732719365, -1.1152963858659208, 1.4171651645157413],
            Surface { mu: 32.120212433742296, e: 1.0, law: Law::Stronge },
            1.658955,
        ),
    ];
    for ([nn, nt, ns, tt, ts, ss], v, surface, separation) in cases {
        let matrix = ReducedMatrix { nn, nt, ns, tt, ts, ss };
        let impact = solve(&matrix, &Vector3::from(v), &surface).expect("no wedge");
        assert!((impact.velocity.x - separation).abs() < 1e-5, "{}", impact.velocity.x);
    }
}

/// A rank of two to rounding, and friction so great that it holds what hardly resists: what the rounding of
/// the entries leaves of the mobility along n means nothing, and depends on the axes. Poisson's and Stronge's
/// laws end before slip stops.
#[test]
fn mobility_below_rounding_is_none_in_any_axes() {
    let m = ReducedMatrix::new(
        3.852970302730755,
        -0.23837615420540645,
        -0.8503755802810522,
        0.2139100892518178,
        0.7374727477468874,
        2.542725653445507,
    );
    let v = Vector3::new(-0.9309556048390211, 1.029104814813254, 3.5462059466068716);
    for k in 0..64 {
        let (sin, cos) = (0.1 * f64::from(k)).sin_cos();
        let turned = m.turned(cos, sin);
        let w = Vector3::new(v.x, v.y * cos + v.z * sin, v.z * cos - v.y * sin);
        let [newton, poisson, stronge] = [Law::Newton, Law::Poisson, Law::Stronge]
            .map(|law| solve(&turned, &w, &Surface { mu: 554.76, e: 1.0, law }));
        assert!(matches!(newton, Err(ImpactError::Wedged { .. })), "{newton:?}");
        let (poisson, stronge) = (poisson.expect("an outcome"), stronge.expect("an outcome"));
        assert!((poisson.impulse.x - 0.003770801929870645_f64).abs() < 1e-14);
        assert!((stronge.impulse.x - 0.0055326172078848_f64).abs() < 1e-12);
    }
}

/// Whatever has an outcome in the range of the numbers is solved, denormal or huge; what leaves the range is
/// said to be not finite.
#[test]
fn magnitudes_do_not_matter() {
    let of = |mass: f64, speed: f64| {
        let m = ReducedMatrix::new(mass, 0.1 * mass, 0.2 * mass, mass, 0.1 * mass, mass);
        let v = Vector3::new(-speed, 0.5 * speed, 0.2 * speed);
        solve(&m, &v, &Surface { mu: 0.3, e: 0.5, law: Law::Stronge })
    };
    let one = of(1.0, 1.0).expect("an outcome");
    for (mass, speed) in [
        (1e-310, 1e-310),
        (1e-310, 1e-160),
        (1e-300, 1.0),
        (1e-160, 1e-300),
        (1e160, 1.0),
        (1e160, 1e160),
        (1e300, 1e300),
    ] {
        let hit = of(mass, speed).unwrap_or_else(|e| panic!("{mass:e} {speed:e}: {e}"));
        // A denormal has some ten digits left.
        let digits = if mass < 1e-307 || speed < 1e-307 { 1e-12 } else { 1e-14 };
        let separation = hit.velocity.x / speed;
        assert!((separation - one.velocity.x).abs() < digits, "{mass:e} {speed:e}: {separation}");
        assert!((hit.impulse.x * mass / speed - one.impulse.x).abs() < digits);
    }
    for (mass, speed) in [(1e-310, 1.0), (1e-160, 1e160), (1e160, 1e300)] {
        assert_eq!(of(mass, speed).expect_err("an impulse or work beyond the range").kind(), "not_finite");
    }
    // A matrix whose entries lie 36 orders apart, without friction.
    let m = ReducedMatrix::new(2e-18, -1.08e-11, 3.127, 0.8585, -3.378e7, 9.78e18);
    for v in [[-1.0_f64, 0.5, 0.3], [-0.1, 0.0, 3.0], [-1e-9, 1e3, 1.0], [-1.0, 0.0, 0.0]] {
        for &law in Law::ALL {
            let hit = solve(&m, &Vector3::from(v), &Surface { mu: 0.0, e: 0.5, law }).expect("an outcome");
            let expected = -1.5 * v[0] / m.nn;
            assert!((hit.impulse.x - expected).abs() < 1e-14 * expected && hit.impulse.yz().norm() == 0.0);
        }
    }
}

/// Advice must not be what has just failed.
#[test]
fn poissons_wedge_does_not_advise_poisson() {
    let wedge = ReducedMatrix::new(1.0, 1.0, 0.0, 1.0, 0.0, 0.0);
    for &law in Law::ALL {
        let error = solve(&wedge, &Vector3::new(-1.0, -0.1, 1.0), &Surface { mu: 2.0, e: 0.5, law })
            .expect_err("wedged")
            .to_string();
        assert_eq!(error.contains("use Poisson's"), law != Law::Poisson, "{error}");
    }
}
