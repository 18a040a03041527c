//! Contact that lasts: modes, forces and accelerations of closed contacts.

use crate::common::random::Random;
use hodograph::{
    ContactError, ContactForce, ContactMode, ReducedMatrix, Selection, contact_force, contact_mode,
    contact_mode_after,
};
use nalgebra::{Matrix3, Vector2, Vector3};

fn vector(random: &mut Random) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.number())
}

/// A positive semidefinite matrix of this rank with m_nn > 0.
fn semidefinite(random: &mut Random, rank: usize) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for _ in 0..rank {
        let row = vector(random);
        matrix += row * row.transpose();
    }
    matrix
}

/// How far an answer is from mechanics: Newton's law, the cone, complementarity, friction against slip. `terms` are those
/// of the free acceleration, whose roundings it holds.
fn wrong(
    m: &Matrix3<f64>,
    (beta, terms): (&Vector3<f64>, f64),
    slip: &Vector2<f64>,
    mu: f64,
    answer: &ContactForce<f64>,
) -> f64 {
    let force = answer.force;
    // Of the terms, for forces of a nearly wedged contact are large.
    let size = terms + (m.abs() * force.abs()).amax();
    let mut worst = (m * force + beta - answer.acceleration).amax() / size;
    // The cone: friction fully used while slipping.
    let friction = Vector2::new(force.y, force.z);
    let pressed = force.amax().max(f64::MIN_POSITIVE);
    let rounding = 1.0 + m.amax() * force.amax() / beta.amax();
    worst = worst.max(-force.x / pressed / rounding);
    worst = worst.max((friction.norm() - mu * force.x) / pressed / rounding / (1.0 + mu));
    let a = answer.acceleration;
    match answer.mode {
        ContactMode::Separate => {
            assert_eq!(force, Vector3::zeros());
            assert!(a.x >= 0.0, "separating bodies approach: {answer:?}");
        }
        ContactMode::Stick => worst = worst.max(a.amax() / size),
        ContactMode::Slide => {
            worst = worst.max(a.x.abs() / size);
            worst = worst.max((friction + slip / slip.norm() * mu * force.x).norm() / pressed / (1.0 + mu));
        }
        ContactMode::BeginSlip => {
            let along = Vector2::new(a.y, a.z);
            worst = worst.max(a.x.abs() / size);
            let d = answer.direction.unwrap();
            worst = worst.max((friction + d * mu * force.x).norm() / pressed / (1.0 + mu));
            assert!(along.dot(&d) > 0.0, "slip does not begin along its direction: {answer:?}");
            // Along the acceleration, as far as rounding lets a small acceleration have a direction.
            worst = worst.max((along - d * along.dot(&d)).norm() / size);
        }
    }
    worst
}

/// 100 000 random states of all ranks from each of two seeds, with and without slip: each has an answer or a reason, and
/// each answer obeys mechanics. Among those of seed 8 is a contact with little friction that wedges.
#[test]
fn every_state_has_an_answer_or_a_reason() {
    for (seed, numbers) in [
        (1, ([49_978, 20_051, 14_460, 10_605], [4906, 0])),
        (8, ([49_629, 20_289, 14_572, 10_619], [4891, 0])),
    ] {
        let mut random = Random::new(seed);
        let (mut reasons, mut modes) = ([0; 2], [0; 4]);
        for case in 0..100_000 {
            let rank = 1 + case % 3;
            let m = semidefinite(&mut random, rank) * 10f64.powf(random.between(-6.0, 6.0));
            let slips = case % 2 == 0;
            // A contact of rank 1 or 2 has motions only that its matrix reaches.
            let reach = |v: Vector3<f64>| if rank < 3 { m * v / m.amax() } else { v };
            let slip = if slips {
                let v = reach(vector(&mut random));
                Vector2::new(v.y, v.z)
            } else {
                Vector2::zeros()
            };
            let (free, power) = (vector(&mut random), 10f64.powf(random.between(-3.0, 3.0)));
            let beta = reach(free) * power;
            let terms = if rank < 3 { (m.abs() * free.abs()).amax() / m.amax() } else { free.amax() };
            let mu = if case % 7 == 0 { 0.0 } else { random.between(0.0, 2.5) };
            match contact_mode(&ReducedMatrix::from(m), &beta, &slip, mu) {
                Ok(answer) => {
                    modes[answer.mode as usize] += 1;
                    let worst = wrong(&m, (&beta, terms * power), &slip, mu, &answer);
                    assert!(
                        worst < 1e-12,
                        "seed {seed} case {case}: {worst:e}: {answer:?} of {m} {beta} {slip} {mu}"
                    );
                    assert_eq!(
                        slips,
                        matches!(answer.mode, ContactMode::Slide)
                            || (slips && answer.mode == ContactMode::Separate)
                    );
                }
                Err(ContactError::ImpactWithoutCollision { f, free_acceleration }) => {
                    reasons[0] += 1;
                    assert!(slips && f < 0.0 && free_acceleration < 0.0);
                }
                Err(ContactError::Jam { .. }) => reasons[1] += 1,
                Err(other) => panic!("seed {seed} case {case}: {other:?} of {m} {beta} {slip} {mu}"),
            }
        }
        println!("{seed}: {modes:?} {reasons:?}");
        assert_eq!((modes, reasons), numbers, "{seed}");
    }
}

/// How many modes fit, by enumeration with a fine search for the direction in which slip begins: a second
/// road.
fn fitting(m: &Matrix3<f64>, beta: &Vector3<f64>, mu: f64) -> usize {
    let mut count = usize::from(beta.x > 0.0);
    let t = m.fixed_view::<2, 2>(1, 1).into_owned();
    let b = Vector2::new(m.m21, m.m31);
    let stuck = -m.try_inverse().unwrap() * beta;
    count += usize::from(stuck.x >= 0.0 && stuck.yz().norm() <= mu * stuck.x);
    let at = |phi: f64| {
        let d = Vector2::new(phi.cos(), phi.sin());
        let f = m.m11 - mu * b.dot(&d);
        // Times f, so that it stays finite.
        let rate = (b - t * d * mu) * -beta.x + beta.yz() * f;
        (d.x * rate.y - d.y * rate.x, rate.dot(&d) / f, -beta.x / f)
    };
    let steps = 4000_i32;
    let phi = |k: usize| (k as f64 + 0.123) * std::f64::consts::TAU / f64::from(steps);
    for k in 0..steps as usize {
        let (here, there) = (at(phi(k)), at(phi(k + 1)));
        if (here.0 < 0.0) != (there.0 < 0.0) && here.1 > 0.0 && there.1 > 0.0 && here.2 > 0.0 && there.2 > 0.0
        {
            count += 1;
        }
    }
    count
}

/// Whether (17.7) holds: sufficient for one mode of a contact without slip that is pressed together.
fn has_one(m: &Matrix3<f64>, beta: &Vector3<f64>) -> bool {
    let (b, tangential) = (Vector2::new(m.m21, m.m31), beta.yz());
    let least = m.fixed_view::<2, 2>(1, 1).symmetric_eigenvalues().min();
    beta.x > 0.0 || tangential.norm() * b.norm() - tangential.dot(&b) < -2.0 * beta.x * least
}

/// Random contacts without slip (theory, section 17.3): where mu |b| < m_nn and (17.7) holds one mode fits, and without
/// (17.7) rarely several; elsewhere at least one fits, and rarely several. A search tells the same.
#[test]
fn one_mode_fits_where_friction_is_moderate() {
    for (seed, numbers) in [(7, [2347, 0, 1653, 114]), (11, [2288, 1, 1712, 93])] {
        let mut random = Random::new(seed);
        let (mut moderate, mut rare, mut strong, mut several) = (0, 0, 0, 0);
        for case in 0..4000 {
            let m = semidefinite(&mut random, 3);
            let beta = vector(&mut random);
            let mu = random.between(0.0, 2.5);
            let answer = contact_mode(&ReducedMatrix::from(m), &beta, &Vector2::zeros(), mu).unwrap();
            let one = answer.selection == Selection::Unique;
            if mu * Vector2::new(m.m21, m.m31).norm() < m.m11 {
                moderate += 1;
                rare += usize::from(!one);
                assert!(one || !has_one(&m, &beta), "seed {seed} case {case}");
            } else {
                strong += 1;
                several += usize::from(!one);
            }
            // The search is slow: a share of the cases.
            if !one || case % 40 == 0 {
                let found = fitting(&m, &beta, mu);
                assert_eq!(found == 1, one, "seed {seed} case {case}: {found}");
            }
        }
        println!("{seed}: {moderate} moderate, several in {rare}, {strong} strong, several in {several}");
        assert_eq!([moderate, rare, strong, several], numbers, "{seed}");
    }
}

fn turned(m: &Matrix3<f64>, angle: f64) -> (Matrix3<f64>, Matrix3<f64>) {
    let (s, c) = angle.sin_cos();
    let turn = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c);
    (turn * m * turn.transpose(), turn)
}

#[test]
fn units_and_axes_do_not_matter() {
    let mut random = Random::new(3);
    for case in 0..1500 {
        let m = semidefinite(&mut random, 3 - case % 2);
        let beta = m * vector(&mut random);
        let slip = if case % 3 == 0 { (m * vector(&mut random)).yz() } else { Vector2::zeros() };
        let mu = random.between(0.05, 1.5);
        let ask = |m: &Matrix3<f64>, beta: &Vector3<f64>, slip: &Vector2<f64>| {
            contact_mode(&ReducedMatrix::from(*m), beta, slip, mu)
        };
        let Ok(answer) = ask(&m, &beta, &slip) else { continue };
        let same = |other: &ContactForce<f64>, force: Vector3<f64>, what: &str| {
            // Close to an edge between modes either will do.
            let near = [answer.margins.lambda_n, answer.margins.cone, answer.margins.f]
                .into_iter()
                .flatten()
                .any(|margin| margin.abs() < 1e-9 * answer.force.amax());
            assert!(near || other.mode == answer.mode, "case {case} {what}: {answer:?} and {other:?}");
            let size = answer.force.amax() * (1.0 + m.amax() * answer.force.amax() / beta.amax());
            let apart = (force - answer.force).amax();
            assert!(near || apart <= 1e-10 * size, "case {case} {what}: {apart:e} of {size:e}");
        };
        // Mass in another unit, then time.
        let other = ask(&(m * 1e-9), &beta, &slip).unwrap();
        same(&other, other.force * 1e-9, "mass");
        let other = ask(&m, &(beta * 1e7), &(slip * 1e-5)).unwrap();
        same(&other, other.force * 1e-7, "time");
        // Axes turned.
        let (there, turn) = turned(&m, random.between(-3.1, 3.1));
        let other = ask(&there, &(turn * beta), &(turn * Vector3::new(0.0, slip.x, slip.y)).yz()).unwrap();
        same(&other, turn.transpose() * other.force, "axes");
    }
}

/// A planar contact in closed form: one tangential direction, and none that the second axis moves.
#[test]
fn planar_contacts_follow_the_textbook() {
    let mut random = Random::new(11);
    for case in 0..5000 {
        let a = random.between(0.1, 2.0);
        let t = random.between(0.1, 2.0);
        let b = random.between(-1.0, 1.0) * (a * t).sqrt();
        let m = ReducedMatrix::new(a, b, 0.0, t, 0.0, 0.0);
        let (beta_n, beta_t) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let mu = random.between(0.0, 0.9) * a / b.abs();
        let v = if case % 2 == 0 { random.between(-1.0, 1.0) } else { 0.0 };
        let answer = contact_mode(&m, &Vector3::new(beta_n, beta_t, 0.0), &Vector2::new(v, 0.0), mu).unwrap();
        assert_eq!(answer.selection, Selection::Unique);
        let expected = if beta_n > 0.0 && (v != 0.0 || answer.mode == ContactMode::Separate) {
            (ContactMode::Separate, 0.0, 0.0)
        } else if v != 0.0 {
            let n = -beta_n / (a - mu * b * v.signum());
            (ContactMode::Slide, n, -mu * n * v.signum())
        } else {
            let n = -(beta_n - b * beta_t / t) / (a - b * b / t);
            let tangential = -(b * n + beta_t) / t;
            if n >= 0.0 && tangential.abs() <= mu * n {
                (ContactMode::Stick, n, tangential)
            } else {
                let sign = -tangential.signum();
                let n = -beta_n / (a - mu * b * sign);
                (ContactMode::BeginSlip, n, -mu * n * sign)
            }
        };
        assert_eq!(answer.mode, expected.0, "case {case}");
        let off = (answer.force - Vector3::new(expected.1, expected.2, 0.0)).amax();
        assert!(off <= 1e-11 * (1.0 + answer.force.amax()), "case {case}: {off:e}");
        assert_eq!(answer.force.z, 0.0);
    }
}

/// A block on an incline sticks exactly up to tan alpha = mu.
#[test]
fn a_block_sticks_up_to_the_angle_of_friction() {
    let m = ReducedMatrix::new(2.0, 0.0, 0.0, 2.0, 0.0, 2.0);
    let mode = |alpha: f64, mu: f64| {
        let beta = Vector3::new(-alpha.cos(), -alpha.sin(), 0.0) * 9.81;
        contact_mode(&m, &beta, &Vector2::zeros(), mu).unwrap()
    };
    for k in 1..200 {
        let alpha = f64::from(k) * 0.007;
        for (mu, expected) in [
            (alpha.tan(), ContactMode::Stick),
            (alpha.tan() * (1.0 + 1e-12), ContactMode::Stick),
            (alpha.tan() * (1.0 - 1e-12), ContactMode::BeginSlip),
        ] {
            assert_eq!(mode(alpha, mu).mode, expected, "{alpha} {mu}");
        }
    }
}

/// Contacts of rank 1, as the tip of a pendulum on a wall: they stick or separate; where wedged the least
/// force in the cone is given.
#[test]
fn contacts_with_one_freedom_stick() {
    let mut random = Random::new(5);
    let mut wedged = 0;
    for case in 0..4000 {
        let row = vector(&mut random);
        let m = row * row.transpose();
        let pull = random.between(-1.0, 1.0);
        let beta = row * pull;
        let mu = random.between(0.0, 2.0);
        let answer = contact_mode(&ReducedMatrix::from(m), &beta, &Vector2::zeros(), mu).unwrap();
        let separates = beta.x > 0.0;
        // Friction may hold what would open.
        if answer.mode == ContactMode::Separate {
            assert!(separates, "case {case}");
        } else {
            assert_eq!(answer.mode, ContactMode::Stick, "case {case}");
            wedged += usize::from(!answer.force_is_unique);
        }
    }
    assert_eq!(wedged, 1971);
}

/// While sliding beyond Painleve's bound no force exists, or several futures do.
#[test]
fn sliding_without_a_force_has_a_name() {
    let m = ReducedMatrix::new(1.0, 0.8, 0.0, 1.0, 0.0, 1.0);
    let slip = Vector2::new(1.0, 0.0);
    let ask = |mu: f64, beta_n: f64| contact_mode(&m, &Vector3::new(beta_n, 0.0, 0.0), &slip, mu);
    assert!(
        matches!(ask(1.5, -1.0), Err(ContactError::ImpactWithoutCollision { f, .. }) if (f + 0.2).abs() < 1e-15)
    );
    assert!(matches!(ask(1.25, -1.0), Err(ContactError::Jam { .. })));
    let open = ask(1.5, 1.0).unwrap();
    assert_eq!((open.mode, open.selection), (ContactMode::Separate, Selection::Indeterminate));
    assert_eq!(ask(0.5, -1.0).unwrap().mode, ContactMode::Slide);
    for (mu, beta) in [(-1.0, -1.0), (f64::NAN, -1.0), (0.5, f64::INFINITY)] {
        assert!(matches!(ask(mu, beta), Err(ContactError::Input(_))), "{mu} {beta}");
    }
    let flat = ReducedMatrix::new(0.0, 0.0, 0.0, 1.0, 0.0, 1.0);
    let none = contact_mode(&flat, &Vector3::new(-1.0, 0.0, 0.0), &slip, 0.5);
    assert!(matches!(none, Err(ContactError::Input(_))));
}

/// A mode that is kept has the force that would keep it; its margins change sign where it ends. Where several modes fit
/// the one that is selected after a force is that with this force.
#[test]
fn kept_modes_tell_their_margins() {
    for (seed, numbers) in [(13, [4386, 123, 0]), (20, [4383, 104, 1])] {
        let mut random = Random::new(seed);
        let (mut ends, mut stays, mut several) = (0, 0, 0);
        for case in 0..5000 {
            let m = semidefinite(&mut random, 3);
            let (beta, mu) = (vector(&mut random), random.between(0.1, 1.0));
            if mu * Vector2::new(m.m21, m.m31).norm() >= m.m11 {
                continue;
            }
            let matrix = ReducedMatrix::from(m);
            let selected = contact_mode(&matrix, &beta, &Vector2::zeros(), mu).unwrap();
            let kept = contact_force(ContactMode::Stick, &matrix, &beta, &Vector2::zeros(), mu).unwrap();
            let holds = kept.margins.lambda_n.unwrap() >= 0.0 && kept.margins.cone.unwrap() >= 0.0;
            let one = selected.selection == Selection::Unique;
            several += usize::from(!one);
            let sticks = selected.mode == ContactMode::Stick;
            assert!(if one { holds == sticks } else { holds || !sticks }, "seed {seed} case {case}");
            assert!(kept.acceleration.amax() < 1e-10 * (1.0 + kept.force.amax() * m.amax()));
            if holds {
                stays += 1
            } else {
                ends += 1
            }
            let after = contact_mode_after(&matrix, &beta, &Vector2::zeros(), mu, &kept.force).unwrap();
            assert!(
                after.mode == if holds { ContactMode::Stick } else { selected.mode } || !(one || holds),
                "seed {seed} case {case}"
            );
        }
        println!("{seed}: {ends} end, {stays} stay, several in {several}");
        assert_eq!([ends, stays, several], numbers, "{seed}");
    }
}

/// The force is differentiated as the impact is: numbers that carry derivatives give those of the force.
#[test]
fn forces_carry_derivatives() {
    type Number = num_dual::Dual64;
    let mut random = Random::new(17);
    let mut begun = 0;
    for case in 0..600 {
        let m = semidefinite(&mut random, 3);
        let (beta, change) = (vector(&mut random), vector(&mut random));
        let mu = random.between(0.1, 0.8);
        let ask = |h: f64| {
            contact_mode(&ReducedMatrix::from(m), &(beta + change * h), &Vector2::zeros(), mu).unwrap()
        };
        let answer = ask(0.0);
        let step = 1e-4;
        let near = [-2.0, -1.0, 1.0, 2.0].map(|k| ask(k * step));
        if near.iter().any(|other| other.mode != answer.mode) {
            continue;
        }
        let lift = |x: f64, dx: f64| Number::new(x, dx);
        let dual = contact_mode(
            &ReducedMatrix::from(m.map(|x| lift(x, 0.0))),
            &beta.zip_map(&change, lift),
            &Vector2::new(lift(0.0, 0.0), lift(0.0, 0.0)),
            lift(mu, 0.0),
        )
        .unwrap();
        assert_eq!(dual.mode, answer.mode);
        begun += usize::from(answer.mode == ContactMode::BeginSlip);
        let [a, b, c, d] = near.map(|answer| answer.force);
        let difference = ((c - b) * 8.0 - (d - a)) / (12.0 * step);
        // Of fourth order; what is left of the truncation is far below that of second order.
        let truncation = ((d - a) / (4.0 * step) - difference).amax();
        let derivative = dual.force.map(|x| x.eps);
        let size = difference.amax() + answer.force.amax();
        let off = (difference - derivative).amax();
        assert!(off <= 1e-8 * size + 0.1 * truncation, "case {case}: {off:e} {difference} {derivative}");
        if answer.mode == ContactMode::Stick {
            // M lambda = -beta.
            let exact = -m.try_inverse().unwrap() * change;
            let condition = m.amax() * m.try_inverse().unwrap().amax();
            assert!(
                (exact - derivative).amax() <= 1e-13 * condition * size,
                "case {case}: {exact} {derivative}"
            );
        }
    }
    assert_eq!(begun, 323);
}

/// Slip has a direction however fast or slow it is.
#[test]
fn the_force_of_slip_does_not_depend_on_its_size() {
    let m = ReducedMatrix { nn: 1.0, nt: 0.1, ns: 0.0, tt: 1.2, ts: 0.05, ss: 0.9 };
    let (beta, mu) = (Vector3::new(-9.81, 0.3, -0.2), 0.5);
    let at = |size: f64| contact_mode(&m, &beta, &Vector2::new(2.0 * size, -size), mu).unwrap();
    let one = at(1.0);
    assert_eq!(one.mode, ContactMode::Slide);
    for exponent in [-1000, -600, -520, 520, 600, 1000] {
        let other = at(2f64.powi(exponent));
        assert_eq!(other.mode, ContactMode::Slide, "{exponent}");
        assert!((other.force - one.force).norm() < 1e-14 * one.force.norm(), "{exponent}: {:?}", other.force);
    }
    let single = ReducedMatrix { nn: 1.0_f32, nt: 0.1, ns: 0.0, tt: 1.2, ts: 0.05, ss: 0.9 };
    for size in [1e-30_f32, 1.0, 1e30] {
        let slip = Vector2::new(2.0 * size, -size);
        let answer = contact_mode(&single, &Vector3::new(-9.81, 0.3, -0.2), &slip, 0.5).unwrap();
        assert_eq!(answer.mode, ContactMode::Slide, "{size:e}");
        assert!((f64::from(answer.force.y) - one.force.y).abs() < 1e-5 * one.force.norm(), "{size:e}");
    }
}

/// Whether a body has an inertia does not depend on its unit.
#[test]
fn inertias_of_any_size_are_judged_alike() {
    use hodograph::generated::check_inertia;
    for size in [1e-300, 1e-160, 1.0, 1e110, 1e300] {
        let scaled = |parts: [f64; 6]| check_inertia(parts.map(|part| part * size), "Body");
        assert!(scaled([1.0, 1.0, 1.0, 0.01, 0.01, 0.01]).is_ok(), "{size:e}");
        assert!(scaled([1.0, 1.0, 2.5, 0.0, 0.0, 0.0]).is_err(), "{size:e}");
        // numbers that are stated are rounded: `hodograph check` takes as much
        assert!(scaled([1.0, 1.0, 2.0 + 1e-10, 0.0, 0.0, 0.0]).is_ok(), "{size:e}");
        assert!(scaled([1.0, 1.0, 2.0 + 1e-7, 0.0, 0.0, 0.0]).is_err(), "{size:e}");
        assert!(scaled([1.0, 1.0, 1.0, 0.9, 0.0, 0.0]).is_err(), "{size:e}");
    }
}
