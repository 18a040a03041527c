//! The moments where phases begin, the course between them, and the flags that say where an outcome is
//! sensitive.

use crate::common::{reference_cases, two_sleds};
use hodograph::{
    Characteristics, Hodograph, Law, Motion, Path, ReducedMatrix, Snapshot, Surface, phi_bar, rates, solve,
};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// What must agree in two moments, over the size of the collision.
fn apart(a: &Snapshot<f64>, b: &Snapshot<f64>, whole: &Hodograph<f64>, v: &Vector3<f64>) -> f64 {
    let (impulse, velocity) = (whole.impact().impulse.amax(), whole.impact().velocity.amax() + v.amax());
    ((a.impulse - b.impulse).amax() / impulse)
        .max((a.velocity - b.velocity).amax() / velocity)
        .max((a.contact_work - b.contact_work).abs() / (impulse * velocity))
        .max((a.normal_work - b.normal_work).abs() / (impulse * velocity))
}

#[test]
fn phases_obey_the_equations_and_the_laws() {
    let mut seen = [0; 4];
    for case in reference_cases() {
        let (m, v, surface) = (&case.matrix, &case.approach, &case.surface);
        let hit = solve(m, v, surface).unwrap();
        let whole = Hodograph::new(m, v, surface).unwrap();
        let complete = *whole.impact();
        let tiny = 4.0 * case.bound();
        let end = whole.at(whole.normal_impulse());
        // The thorough solution is the same one.
        assert_eq!(complete.path, hit.path);
        assert_eq!(complete.compressions, hit.compressions);
        assert!((complete.impulse - hit.impulse).amax() <= tiny * hit.impulse.amax(), "{}", case.line);
        for (fast, full) in [
            (hit.phases.compression_end, complete.phases.compression_end),
            (hit.phases.last_compression_end, complete.phases.last_compression_end),
            (hit.phases.slip_end, complete.phases.slip_end),
        ] {
            if let Some(fast) = fast {
                let full = full.unwrap_or_else(|| panic!("{}", case.line));
                assert!(apart(&fast, &full, &whole, v) <= tiny, "{}", case.line);
            } else {
                assert!(full.is_none() || surface.law == Law::Newton, "{}", case.line);
            }
        }
        let phases = complete.phases;
        let (Some(first), Some(last)) = (phases.compression_end, phases.last_compression_end) else {
            panic!("no end of compression: {}", case.line)
        };
        let size = hit.impulse.amax() * (m.nn + m.tt + m.ss) + v.amax();
        for moment in [Some(first), Some(last), phases.slip_end, Some(end)].into_iter().flatten() {
            // (20)-(22), and the energy (23) of the impulse.
            let left = m.apply(&moment.impulse) - (moment.velocity - v);
            assert!(left.amax() <= tiny * size, "{left} {}", case.line);
            let work = 0.5 * moment.impulse.dot(&(moment.velocity + v));
            assert!((work - moment.contact_work).abs() <= tiny * size * hit.impulse.amax());
            assert!(moment.impulse.x >= 0.0 && moment.impulse.x <= hit.impulse.x * (1.0 + tiny));
        }
        // (47), and the laws (48), (51), (54).
        assert_eq!((first.velocity.x, last.velocity.x), (0.0, 0.0));
        let e = surface.e;
        match surface.law {
            Law::Newton => assert!((hit.velocity.x + e * v.x).abs() <= tiny * v.amax()),
            Law::Poisson => {
                assert!((hit.impulse.x - (1.0 + e) * last.impulse.x).abs() <= tiny * hit.impulse.amax());
            }
            Law::Stronge => {
                let least = first.normal_work.min(last.normal_work);
                let work = (1.0 - e * e) * least;
                assert!((hit.normal_work - work).abs() <= tiny * size * hit.impulse.amax());
            }
            other => panic!("no equation for {other:?}"),
        }
        if complete.compressions == 1 {
            assert_eq!(first, last);
        } else {
            assert!(first.impulse.x < last.impulse.x);
            seen[0] += 1;
        }
        match (hit.path, phases.slip_end) {
            (Path::SlidingThenSticking | Path::SlidingThenRenewal, Some(slip)) => {
                assert_eq!(slip.slip(), 0.0);
                assert_eq!(slip.direction(), None);
                assert_eq!(slip.motion == Motion::Sticking, hit.path == Path::SlidingThenSticking);
                seen[1] += 1;
            }
            (Path::Sticking | Path::Renewal, None) => seen[2] += 1,
            (Path::Sliding, _) => seen[3] += 1,
            (path, _) => panic!("{path:?} {}", case.line),
        }
        // The course passes through all of them.
        for moment in [Some(first), Some(last), phases.slip_end].into_iter().flatten() {
            let there = whole.at(moment.impulse.x);
            assert!(apart(&there, &moment, &whole, v) <= tiny, "{there:?} {moment:?} {}", case.line);
        }
        assert!((end.impulse, end.velocity) == (complete.impulse, complete.velocity));
        let nearly = whole.at(whole.normal_impulse() * (1.0 - 1e-13));
        assert!(apart(&nearly, &end, &whole, v) <= tiny.max(1e-11), "{}", case.line);
        let start = whole.at(0.0);
        assert!((start.velocity - v).amax() <= 1e-15 * v.amax() && start.impulse.amax() == 0.0);
        assert_eq!(whole.at(-1.0), start);
        assert_eq!(whole.at(f64::NAN), start);
    }
    println!("repeated, stopped, without slip, sliding: {seen:?}");
    assert!(seen.iter().all(|&count| count > 0));
}

/// Between its ends the course obeys (31)-(35): their derivatives by differences, and the reduced equations.
#[test]
fn the_course_obeys_the_differential_equations() {
    for mu in [0.6, 1.1, 1.6] {
        for &law in Law::ALL {
            let (m, v, surface) = two_sleds(mu, law);
            let whole = Hodograph::new(&m, &v, &surface).unwrap();
            let points: Vec<_> = whole.points(41).collect();
            assert_eq!(points.len(), 41);
            assert_eq!(points[0].velocity, v);
            assert_eq!(points[40].velocity, whole.impact().velocity);
            let step = 1e-5 * whole.normal_impulse();
            for point in &points[1..40] {
                let i = point.normal_impulse();
                let (before, after) = (whole.at(i - step), whole.at(i + step));
                if before.motion != after.motion {
                    continue;
                }
                let by = |of: fn(&Snapshot<f64>) -> f64| (of(&after) - of(&before)) / (2.0 * step);
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "mu {mu} {law:?} {i}: {a} {b}");
                near(by(|p| p.normal_work), point.velocity.x);
                let left = m.apply(&point.impulse) - (point.velocity - v);
                assert!(left.amax() < 1e-13);
                let Some(phi) = point.direction() else {
                    assert_eq!(point.motion, Motion::Sticking);
                    continue;
                };
                let [f, g, h] = rates(&m, mu, phi).into();
                near(by(|p| p.velocity.x), f);
                near(by(|p| p.slip()), g);
                near(by(|p| p.impulse.y), -mu * phi.cos());
                near(by(|p| p.impulse.z), -mu * phi.sin());
                near(by(|p| p.direction().unwrap_or(f64::NAN)) * point.slip(), h);
                near(by(|p| p.contact_work), point.velocity.x - mu * point.slip());
            }
        }
    }
}

/// Another way to the middle of a collision: integration (55) of the same collision that Poisson's law ends
/// there.
#[cfg(feature = "std")]
#[test]
fn integration_meets_the_course_on_its_way() {
    use hodograph::methods::{Integration, integrate};
    let mut met = 0;
    for case in reference_cases().iter().filter(|case| case.condition < 1e4) {
        let whole = Hodograph::new(&case.matrix, &case.approach, &case.surface).unwrap();
        let Some(compression) = whole.impact().phases.compression_end else { panic!("{}", case.line) };
        if whole.impact().compressions > 1 {
            continue;
        }
        for e in [0.0, 0.1, 0.35, 0.7] {
            let i = (1.0 + e) * compression.impulse.x;
            if i >= whole.normal_impulse() {
                continue;
            }
            let surface = Surface { mu: case.surface.mu, e, law: Law::Poisson };
            let options = Integration::with_tolerance(1e-11);
            let theirs = integrate(&case.matrix, &case.approach, &surface, &options).unwrap().impact;
            let ours = whole.at(theirs.impulse.x);
            let size = whole.impact().impulse.amax();
            let speed = whole.impact().velocity.amax() + case.approach.amax();
            let close = 1e-8_f64.max(1e-10 * case.condition);
            assert!((ours.impulse - theirs.impulse).amax() <= close * size, "{}", case.line);
            assert!((ours.velocity - theirs.velocity).amax() <= close * speed, "{}", case.line);
            assert!((ours.contact_work - theirs.contact_work).abs() <= close * size * speed);
            assert!((ours.normal_work - theirs.normal_work).abs() <= close * size * speed);
            // The methods tell the phases too.
            let phases = theirs.phases;
            let slip = phases.slip_end.map(|moment| moment.impulse.x);
            let expected = whole.impact().phases.slip_end.map(|moment| moment.impulse.x);
            if let (Some(slip), Some(expected)) = (slip, expected) {
                assert!((slip - expected).abs() <= close * size, "{}", case.line);
            }
            let end = phases.compression_end.map(|moment| moment.impulse.x).unwrap_or(f64::NAN);
            assert!((end - compression.impulse.x).abs() <= close * size, "{}", case.line);
            met += 1;
        }
    }
    println!("{met} moments compared");
    assert_eq!(met, 293);
}

#[test]
fn quantities_of_the_paper_at_the_start_of_each_phase() {
    let near = |a: f64, b: f64, digits: f64| assert!((a - b).abs() <= digits, "{a} {b}");
    for &law in Law::ALL {
        let (m, v, surface) = two_sleds(1.1, law);
        let phases = Hodograph::new(&m, &v, &surface).unwrap().impact().phases;
        near(phases.compression_end.unwrap().normal_work, -1.295, 6e-4);
        near(phases.slip_end.unwrap().normal_work, -1.291, 6e-4);
        near(phases.slip_end.unwrap().velocity.x, 0.0533, 6e-5);
        let (m, v, surface) = two_sleds(1.6, law);
        let phases = Hodograph::new(&m, &v, &surface).unwrap().impact().phases;
        near(phases.compression_end.unwrap().normal_work, -1.085, 6e-4);
        near(phases.slip_end.unwrap().normal_work, -1.083, 6e-4);
        near(phases.slip_end.unwrap().velocity.x, 0.0402, 6e-5);
        near(phases.slip_end.unwrap().impulse.x, 2.3280193257638, 1e-12);
    }
    // The axes have the other sign of s.
    let (m, ..) = two_sleds(1.1, Law::Newton);
    near(Characteristics::phi_bar(&m, 1.1).unwrap(), -0.4323866, 1e-7);
    near(Characteristics::phi_bar(&m, 1.6).unwrap(), -0.5980670, 1e-7);
}

/// phi_bar is where slip ends, seen from any direction before.
#[test]
fn slip_stops_in_the_direction_phi_bar() {
    let (m, v, surface) = two_sleds(1.6, Law::Stronge);
    for degrees in (0..360).step_by(15) {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let approach = Vector3::new(v.x, cos, sin);
        let whole = Hodograph::new(&m, &approach, &surface).unwrap();
        let Some(end) = whole.impact().phases.slip_end else { continue };
        let expected = phi_bar(&m, 1.6, f64::from(degrees).to_radians()).unwrap();
        let last = whole.at(end.impulse.x * (1.0 - 1e-9)).direction().unwrap();
        // Slip approaches the direction at its own rate.
        let off = (last - expected + 7.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        assert!(off.abs() < 1e-2, "{degrees}: {last} {expected}");
        assert!(rates(&m, 1.6, expected).z.abs() < 1e-14);
    }
}

#[test]
fn flags_fire_where_an_outcome_is_sensitive() {
    let flags = |m: &ReducedMatrix<f64>, v: &Vector3<f64>, mu, e, law| {
        solve(m, v, &Surface { mu, e, law }).unwrap().sensitivity
    };
    let (m, v, _) = two_sleds(1.1, Law::Newton);
    for &law in Law::ALL {
        for mu in [0.6, 1.1, 1.6] {
            assert!(!flags(&m, &v, mu, 0.8, law).any(), "{mu} {law:?}");
        }
        let mu_c = Characteristics::of(&m, 1.1).mu_c;
        for (factor, expected) in [(0.99, false), (0.9995, true), (1.0, true), (1.0005, true), (1.01, false)]
        {
            let found = flags(&m, &v, mu_c * factor, 0.8, law);
            assert_eq!(found.near_mu_c, expected, "{factor} {law:?}");
            assert!(!found.grazing && !found.unstable_direction && !found.no_slip);
        }
        let none = flags(&m, &Vector3::new(-1.0, 0.0, 0.0), 1.1, 0.8, law);
        assert!(none.no_slip && none.any() && !none.near_mu_c && !none.grazing);
        assert!(flags(&m, &Vector3::new(-1.0, 1e-9, 0.0), 1.1, 0.8, law).no_slip);
        // The unstable direction of a balanced contact: across the axis in which it yields most.
        let plate = ReducedMatrix::new(1.0, 0.0, 0.0, 1.0, 0.0, 3.0);
        for (angle, expected) in [(0.0, [false, true]), (5e-4, [false, true]), (0.01, [false, false])] {
            let (sin, cos) = f64::sin_cos(angle);
            let along = [Vector3::new(-1.0, cos, sin), Vector3::new(-1.0, sin, cos)];
            assert_eq!(
                along.map(|v| flags(&plate, &v, 0.3, 0.5, law).unstable_direction),
                expected,
                "{angle}"
            );
        }
    }
    // Isotropic without coupling: no direction is preferred.
    let ball = ReducedMatrix::new(1.0, 0.0, 0.0, 3.5, 0.0, 3.5);
    assert!(!flags(&ball, &Vector3::new(-1.0, 0.3, 0.4), 0.1, 0.5, Law::Stronge).any());
}

/// v_n rises, falls and rises again: where the law's end passes the maximum, or the minimum passes zero, the
/// outcome jumps, and the flag is up on both sides of the jump.
#[test]
fn grazing_is_flagged_where_the_outcome_jumps() {
    let m = ReducedMatrix::new(2.1, -2.1, -1.35, 2.3, 1.15, 4.3);
    let v = Vector3::new(-0.22, -0.2, 1.0);
    for &law in Law::ALL {
        let at = |e: f64| solve(&m, &v, &Surface { mu: 1.95, e, law }).unwrap();
        // Finds the jump by bisection between one compression and two.
        let (mut low, mut high) = (1e-3, 1.0);
        assert!(at(low).compressions == 1 && at(high).compressions == 2, "{law:?}");
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle).compressions == 1 { low = middle } else { high = middle }
        }
        assert!(at(high).impulse.x - at(low).impulse.x > 0.05, "{law:?}");
        assert!(at(low).sensitivity.grazing, "{law:?} {:?}", at(low));
        // Below: far from the jump nothing is said.
        assert!(!at(0.2 * low).sensitivity.grazing, "{law:?}");
        println!("{law:?}: e {low}, above {}", at(high).sensitivity.grazing);
        assert!(at(high).sensitivity.grazing, "{law:?} {:?}", at(high));
        assert!(!at(1.0).sensitivity.grazing || law == Law::Newton && high > 0.99, "{law:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, max_global_rejects: 20_000, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(30), ..ProptestConfig::default() })]

    /// What is not flagged does not jump.
    #[test]
    fn outcomes_without_a_flag_are_steady(
        entries in prop::array::uniform9(-2.0..2.0_f64),
        v in prop::array::uniform2(-1.5..1.5_f64),
        mu in 0.0..3.0_f64,
        e in 0.0..=0.999_f64,
        law in prop::sample::select(Law::ALL),
    ) {
        let b = Matrix3::from(std::array::from_fn::<_, 3, _>(|i| std::array::from_fn::<_, 3, _>(|j| entries[3 * i + j])));
        let m = ReducedMatrix::from(b * b.transpose());
        prop_assume!(m.nn > 1e-2 && Matrix3::from(m).determinant() > 1e-2);
        let v = Vector3::new(-1.0, v[0], v[1]);
        let at = |mu: f64, e: f64| solve(&m, &v, &Surface { mu, e, law });
        let hit = at(mu, e).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assume!(!hit.sensitivity.any());
        for [by_mu, by_e] in [[1.0, 0.0], [0.0, 1.0]] {
            let change = |size: f64| {
                let near = at(mu * (1.0 + size * by_mu), e * (1.0 + size * by_e));
                let near = near.map_err(|e| TestCaseError::fail(e.to_string()))?;
                prop_assert_eq!(near.compressions, hit.compressions);
                Ok((near.impulse - hit.impulse).amax() / hit.impulse.amax())
            };
            // next to a jam impulses are large and change fast, but in proportion: a jump does not
            let (near, nearer) = (change(1e-7)?, change(1e-9)?);
            prop_assert!(near <= 1e-4 || nearer <= 0.1 * near, "{near} {nearer} {hit:?}");
        }
    }

    /// The course is continuous, its impulse is what was asked for, and everything holds at any of its points.
    #[test]
    fn any_point_of_the_course_obeys_the_reduced_equations(
        entries in prop::array::uniform9(-2.0..2.0_f64),
        rank in 1..4_usize,
        speeds in prop::array::uniform3(-1.5..1.5_f64),
        mu in 0.0..3.0_f64,
        e in 0.0..=1.0_f64,
        law in prop::sample::select(Law::ALL),
        part in 0.0..=1.0_f64,
    ) {
        let mut b = Matrix3::from(std::array::from_fn::<_, 3, _>(|i| std::array::from_fn::<_, 3, _>(|j| entries[3 * i + j])));
        for column in rank..3 {
            b.column_mut(column).fill(0.0);
        }
        let mut v = b * Vector3::from(speeds);
        if v.x > 0.0 {
            v = -v;
        }
        let m = ReducedMatrix::from(b * b.transpose());
        prop_assume!(m.nn > 1e-2 && v.x < -1e-2);
        let Ok(whole) = Hodograph::new(&m, &v, &Surface { mu, e, law }) else { return Ok(()) };
        let i = part * whole.normal_impulse();
        let moment = whole.at(i);
        let size = v.amax() + moment.impulse.amax() * (m.nn + m.tt + m.ss);
        prop_assert!((moment.impulse.x - i).abs() <= 1e-12 * whole.normal_impulse(), "{} {}", moment.impulse.x, i);
        prop_assert!((m.apply(&moment.impulse) - (moment.velocity - v)).amax() <= 1e-11 * size);
        prop_assert!(moment.impulse.y.hypot(moment.impulse.z) <= mu * i * (1.0 + 1e-9) + 1e-12 * whole.normal_impulse() * (1.0 + mu)
            || moment.motion == Motion::Sticking);
        if moment.motion == Motion::Sticking {
            prop_assert_eq!(moment.slip(), 0.0);
        }
    }
}
