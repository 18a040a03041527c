//! What the paper remarks by the way: each remark that is true, held by a test.

use crate::common::{random::Random, two_sleds};
use hodograph::{
    Characteristics, Hodograph, ImpactError, Law, Motion, Path, ReducedMatrix, Snapshot, Surface,
    energy_gained, invariant_directions, phi_bar, rates, snapshot_at, solve,
    structure::{Planar, solve_structured},
};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// A random matrix of full rank, not near a singular one.
fn matrix(random: &mut Random) -> ReducedMatrix<f64> {
    loop {
        let b = Matrix3::from_fn(|_, _| random.number());
        let m = b * b.transpose();
        if m.determinant() > 0.05 * m.m11 * m.m22 * m.m33 && m.m11 > 0.1 {
            return m.into();
        }
    }
}

fn approach(random: &mut Random) -> Vector3<f64> {
    let (sin, cos) = (3.2 * random.number()).sin_cos();
    let slip = random.between(0.3, 1.5);
    Vector3::new(-1.0, slip * cos, slip * sin)
}

/// E_n - I_n (v_n + v_n1) / 2 over the size of its terms.
fn off(at: &Snapshot<f64>, v_n1: f64) -> f64 {
    let mean = at.impulse.x * (at.velocity.x + v_n1) / 2.0;
    (at.normal_work - mean).abs() / (at.impulse.x * (at.velocity.x.abs() + v_n1.abs()))
}

/// After (35): Delta E_n = I_n (v_n + v_n1) / 2 "is not the case with 2D systems, except in sliding", nor
/// with 3D systems.
#[test]
fn normal_work_is_that_of_the_mean_velocity_in_planar_sliding_alone() {
    let mut random = Random::new(1);
    let mut counts = [0; 3];
    for _ in 0..300 {
        let space = matrix(&mut random);
        let planar = ReducedMatrix { ns: 0.0, ts: 0.0, ss: 0.0, ..space };
        let mu = random.between(0.2, 1.5);
        let (v, w) = (approach(&mut random), Vector3::new(-1.0, random.between(0.2, 1.0), 0.0));
        for impulse in [0.3, 1.0, 3.0, 9.0].map(|part| part / space.nn) {
            let plane = snapshot_at(&planar, &w, mu, impulse).unwrap();
            if plane.motion == Motion::Sliding {
                assert!(off(&plane, -1.0) < 1e-14);
                counts[0] += 1;
            } else if mu * planar.nt.abs() > 0.1 {
                // After slip has stopped v_n rises at another rate.
                assert!(off(&plane, -1.0) > 1e-6, "{planar:?} {plane:?}");
                counts[1] += 1;
            }
            let curved = snapshot_at(&space, &v, mu, impulse).unwrap();
            let turned = (curved.direction().unwrap_or(9.0) - v.z.atan2(v.y)).sin().abs();
            if curved.motion == Motion::Sliding && turned > 0.3 && mu * space.nt.hypot(space.ns) > 0.1 {
                counts[2] += usize::from(off(&curved, -1.0) > 1e-6);
                assert!(off(&curved, -1.0) > 1e-12, "{space:?} {curved:?}");
            }
        }
    }
    assert_eq!(counts, [473, 544, 450]);
}

/// Section 5: below mu_s the sleds slide throughout; from mu_s on slip is renewed, in a part of the hodograph
/// that becomes shorter as mu rises to mu_c, where it vanishes; above they stick.
#[test]
fn renewed_sliding_becomes_shorter_and_vanishes_at_mu_c() {
    for &law in Law::ALL {
        let at = |mu: f64| {
            let (m, v, surface) = two_sleds(mu, law);
            solve(&m, &v, &surface).unwrap()
        };
        let (m, ..) = two_sleds(1.0, law);
        let Characteristics { mu_c, mu_s, .. } = Characteristics::of(&m, 1.0);
        let mu_s = mu_s.expect("m_ts is not zero");
        for step in 0..400 {
            let mu = mu_s * (f64::from(step) / 400.0);
            assert_eq!(at(mu).path, Path::Sliding, "{mu}");
        }
        let mut last = f64::INFINITY;
        for step in 1..200 {
            let hit = at(mu_s + (mu_c - mu_s) * f64::from(step) / 200.0);
            assert_eq!(hit.path, Path::SlidingThenRenewal);
            let length = hit.velocity.yz().norm();
            assert!(length < last, "{law:?} {step}: {length} {last}");
            last = length;
        }
        let renewed = at(mu_c * (1.0 - 1e-9)).velocity.yz().norm();
        assert!(renewed > 0.0 && renewed < 1e-7, "{renewed}");
        for mu in [mu_c * (1.0 + 1e-12), 1.3, 2.0, 10.0] {
            let hit = at(mu);
            assert_eq!((hit.path, hit.velocity.yz().norm()), (Path::SlidingThenSticking, 0.0));
        }
    }
}

/// The point of a sliding arc where slip has a direction, by bisection over I_n; `None` if the arc has not
/// got there before `most`.
fn slip_at(m: &ReducedMatrix<f64>, v: &Vector3<f64>, mu: f64, turn: f64, most: f64) -> Option<f64> {
    let first = v.z.atan2(v.y);
    let turned = |impulse: f64| {
        let at = snapshot_at(m, v, mu, impulse).ok().filter(|at| at.motion == Motion::Sliding)?;
        let angle = at.direction()? - first;
        Some((angle.sin().atan2(angle.cos()), at.slip()))
    };
    let (sign, wanted) = (turn.signum(), turn.abs());
    let (mut low, mut high) = (0.0, most);
    if turned(high).is_some_and(|(angle, _)| sign * angle < wanted) {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if turned(middle).is_some_and(|(angle, _)| sign * angle < wanted) {
            low = middle
        } else {
            high = middle
        }
    }
    turned(low).map(|(_, slip)| slip)
}

/// (38): s = s(0) exp of the integral of g / h over phi. Battle: hodographs of one system do not intersect.
/// Where two have the same direction, the quotient of their slips is always the same.
#[test]
fn hodographs_of_one_system_do_not_intersect() {
    let mut random = Random::new(2);
    let mut count = 0;
    for _ in 0..60 {
        let m = matrix(&mut random);
        let (v, mu) = (approach(&mut random), random.between(0.2, 1.5));
        let first = v.z.atan2(v.y);
        let h = rates(&m, mu, first).z;
        // How far slip may turn: to the next invariant direction on its way.
        let to = invariant_directions(&m, mu).into_iter().flatten().map(|phi| {
            let ahead = h.signum() * (phi - first);
            ahead.rem_euclid(std::f64::consts::TAU)
        });
        let room = to.fold(f64::INFINITY, f64::min).min(2.5);
        if room < 0.3 || h.abs() < 0.05 * m.nn {
            continue;
        }
        let other = {
            let (sin, cos) = (first + h.signum() * 0.2 * room).sin_cos();
            Vector3::new(-1.0, v.yz().norm() * cos, v.yz().norm() * sin)
        };
        let mut quotients = Vec::new();
        for part in [0.3, 0.5, 0.7, 0.85] {
            let one = slip_at(&m, &v, mu, h.signum() * part * room, 60.0 / m.nn);
            let two = slip_at(&m, &other, mu, h.signum() * (part - 0.2) * room, 60.0 / m.nn);
            let (Some(one), Some(two)) = (one, two) else { continue };
            // What hardly slips any more has lost its digits.
            if one.min(two) < 1e-6 * v.yz().norm() {
                continue;
            }
            quotients.push(one / two);
            // (38) by Gauss's quadrature with three nodes on 400 pieces.
            let pieces = 400;
            let width = h.signum() * part * room / f64::from(pieces);
            let node = 0.6_f64.sqrt() / 2.0;
            let integrand = |phi: f64| {
                let [_, g, h] = rates(&m, mu, phi).into();
                g / h
            };
            let sum: f64 = (0..pieces)
                .map(|k| {
                    let middle = first + width * (f64::from(k) + 0.5);
                    let outer = integrand(middle - node * width) + integrand(middle + node * width);
                    width * (5.0 * outer + 8.0 * integrand(middle)) / 18.0
                })
                .sum();
            let expected = v.yz().norm() * sum.exp();
            assert!((one / expected - 1.0).abs() < 1e-7, "{one} {expected}");
        }
        for pair in quotients.windows(2) {
            assert!((pair[0] / pair[1] - 1.0).abs() < 1e-7, "{quotients:?}");
        }
        if let [quotient, _, ..] = quotients[..] {
            assert!((quotient - 1.0).abs() > 1e-6, "the same hodograph");
            count += 1;
        }
    }
    assert_eq!(count, 46);
}

/// (41a) to (41d), (43) from them, and (44): mu_c and phi_c are where g and h vanish.
#[test]
fn sticking_keeps_the_tangential_velocity() {
    let mut random = Random::new(3);
    for _ in 0..500 {
        let m = matrix(&mut random);
        let full = Matrix3::from(m);
        let found = Characteristics::of(&m, 0.5);
        let c = Vector3::from(found.sticking.expect("full rank"));
        let det = full.determinant();
        let printed =
            Vector3::new(m.tt * m.ss - m.ts * m.ts, m.ns * m.ts - m.nt * m.ss, m.nt * m.ts - m.ns * m.tt)
                / det;
        let close = 1e-11 * c.norm();
        assert!((c - printed).norm() < close && c.x > 0.0);
        assert!((full * c - Vector3::x()).norm() < close * full.norm(), "(41d)");
        assert!((found.mu_c - c.y.hypot(c.z) / c.x).abs() < 1e-10 * found.mu_c);
        assert!((found.phi_c - (-c.z).atan2(-c.y)).sin().abs() < 1e-9);
        let [_, g, h] = rates(&m, found.mu_c, found.phi_c).into();
        let size = (m.tt + m.ss) * found.mu_c + m.nt.hypot(m.ns);
        assert!(g.abs() + h.abs() < 1e-12 * size, "(44)");
    }
}

/// (75) and what follows: g falls along every ray from the origin, from inside the ellipse to outside; the
/// remote branch of the hyperbola does not meet the ellipse, and the near one meets it once more, at mu_c.
#[test]
fn the_remote_branch_misses_the_ellipse() {
    let mut random = Random::new(4);
    let mut remote = 0;
    for _ in 0..200 {
        let m = matrix(&mut random);
        let (t, b) = (Matrix2::new(m.tt, m.ts, m.ts, m.ss), Vector2::new(m.nt, m.ns));
        let pull_across = |d: &Vector2<f64>| d.x * b.y - d.y * b.x;
        let drag_across = |d: &Vector2<f64>| d.x * (t * d).y - d.y * (t * d).x;
        let ahead = b / b.norm();
        let near_sign = drag_across(&ahead).signum();
        let begin = b.y.atan2(b.x) - std::f64::consts::FRAC_PI_2;
        let (mut changes, mut last) = (0, None);
        for k in 0..2000 {
            let phi = begin + std::f64::consts::TAU * (f64::from(k) + 0.5) / 2000.0;
            let d = Vector2::new(phi.cos(), phi.sin());
            let drag = d.dot(&(t * d));
            assert!(drag > 0.0);
            let mu_e = b.dot(&d) / drag;
            for mu in [0.0, 0.3, 1.7] {
                let g = rates(&m, mu, phi).y;
                assert!((g - (b.dot(&d) - mu * drag)).abs() < 1e-13 * (m.tt + m.ss + b.norm()), "(75)");
                if mu > 0.0 && mu_e > 0.0 && (mu / mu_e - 1.0).abs() > 1e-9 {
                    assert_eq!(g > 0.0, mu < mu_e);
                }
            }
            // The point of the hyperbola in this direction.
            let mu = pull_across(&d) / drag_across(&d);
            if mu > 0.0 && drag_across(&d).signum() != near_sign {
                assert!(rates(&m, mu, phi).y < 0.0, "the remote branch is outside");
                remote += 1;
            }
            // Along the ellipse, from the origin and back to it, h changes its sign where it meets the
            // hyperbola.
            if mu_e > 0.0 {
                let sign = rates(&m, mu_e, phi).z > 0.0;
                changes += usize::from(last.is_some_and(|last| last != sign));
                last = Some(sign);
            }
        }
        assert_eq!(changes, 1, "{m:?}");
    }
    assert_eq!(remote, 100_000);
}

/// Every zero of h, in order, and none else.
#[test]
fn all_invariant_directions_are_found() {
    let mut random = Random::new(5);
    let mut counts = [0; 5];
    for index in 0..400 {
        let mut m = matrix(&mut random);
        match index % 8 {
            // Symmetric to t, planar, isotropic.
            1 => (m.ns, m.ts) = (0.0, 0.0),
            2 => (m.ns, m.ts, m.ss) = (0.0, 0.0, 0.0),
            3 => (m.ts, m.ss) = (0.0, m.tt),
            _ => {}
        }
        let mu = random.logarithmic(0.01, 10.0);
        let found: Vec<f64> = invariant_directions(&m, mu).into_iter().flatten().collect();
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
        assert!(found.iter().all(|phi| phi.abs() <= std::f64::consts::PI));
        let size = m.nt.hypot(m.ns) + mu * (m.tt + m.ss);
        assert!(found.iter().all(|&phi| rates(&m, mu, phi).z.abs() < 1e-13 * size), "{found:?}");
        let steps = 7919;
        let h =
            |k: i32| rates(&m, mu, 0.0777 + std::f64::consts::TAU * f64::from(k) / f64::from(steps)).z > 0.0;
        let changes = (0..steps).filter(|&k| h(k) != h((k + 1) % steps)).count();
        assert_eq!(found.len(), changes, "{m:?} {mu}");
        counts[changes] += 1;
        // phi_bar and phi_hat are among them.
        let near = |phi: f64| found.iter().any(|other| (other - phi).sin().abs() < 1e-9);
        assert!(phi_bar(&m, mu, 0.3).is_none_or(near));
        assert!(Characteristics::of(&m, mu).renewal.is_none_or(|renewal| near(renewal.phi_hat)));
    }
    assert_eq!(counts, [0, 0, 259, 0, 141]);
}

/// phi_hat is stable: h' there is below -g_hat, and slip beside it turns back as s^(h' / g).
#[test]
fn renewed_slip_is_stable() {
    let mut random = Random::new(6);
    let mut count = 0;
    for _ in 0..500 {
        let m = matrix(&mut random);
        let mu = random.between(0.0, 1.0) * Characteristics::of(&m, 0.0).mu_c;
        let Some(renewal) = Characteristics::of(&m, mu).renewal else { continue };
        let step = 1e-6;
        let h = |by: f64| rates(&m, mu, renewal.phi_hat + by).z;
        let slope = (h(step) - h(-step)) / (2.0 * step);
        assert!((slope - renewal.dh_hat).abs() < 1e-7 * (m.tt + m.ss + m.nt.hypot(m.ns)) * (1.0 + mu));
        assert!(renewal.dh_hat <= -renewal.g_hat && renewal.g_hat > 0.0);
        // A small deviation while slip doubles.
        let small = 1e-4;
        let (sin, cos) = (renewal.phi_hat + small).sin_cos();
        let start = Vector3::new(-1.0, cos, sin);
        let at = snapshot_at(&m, &start, mu, 1.0 / renewal.g_hat).unwrap();
        let left = (at.direction().expect("it slips") - renewal.phi_hat).sin();
        let expected = small * at.slip().powf(renewal.dh_hat / renewal.g_hat);
        assert!((left - expected).abs() < 1e-2 * small, "{left} {expected}");
        count += 1;
    }
    assert_eq!(count, 500);
}

/// Section 3.1 supposes that I_n2 is known. A law with more restitution passes every state that one with less
/// has; beyond any end (45) and (46) go on, and (20) to (23) hold everywhere.
#[test]
fn the_state_at_any_impulse_does_not_depend_on_a_law() {
    let mut random = Random::new(8);
    let mut beyond = 0;
    for _ in 0..300 {
        let m = matrix(&mut random);
        let (v, mu) = (approach(&mut random), random.between(0.0, 2.0));
        let with = |e: f64| Hodograph::new(&m, &v, &Surface { mu, e, law: Law::Poisson }).unwrap();
        let (short, long) = (with(0.1), with(1.0));
        for part in [0.0, 0.2, 0.6, 0.9, 1.0] {
            let impulse = part * long.normal_impulse();
            let (ours, theirs) = (snapshot_at(&m, &v, mu, impulse).unwrap(), long.at(impulse));
            let size = long.normal_impulse();
            assert!((ours.impulse - theirs.impulse).amax() < 1e-12 * size * (1.0 + mu));
            assert!((ours.velocity - theirs.velocity).amax() < 1e-12 * (1.0 + size * (m.nn + m.tt + m.ss)));
            assert!((ours.normal_work - theirs.normal_work).abs() < 1e-12 * size * (1.0 + size * m.nn));
            beyond += usize::from(impulse > short.normal_impulse());
        }
        let impulse = 3.0 * long.normal_impulse();
        let at = snapshot_at(&m, &v, mu, impulse).unwrap();
        let close = 1e-11 * (1.0 + impulse * (m.nn + m.tt + m.ss) * (1.0 + mu));
        assert!((m.apply(&at.impulse) + v - at.velocity).amax() < close, "(20)-(22)");
        assert!((at.contact_work - 0.5 * at.impulse.dot(&(v + at.velocity))).abs() < close * impulse, "(23)");
        // The rate of v_n by (34c), (45c) or (46c).
        let later = snapshot_at(&m, &v, mu, impulse * (1.0 + 1e-6)).unwrap();
        let rate = (later.velocity.x - at.velocity.x) / (later.impulse.x - at.impulse.x);
        let found = Characteristics::of(&m, mu);
        let expected = match at.motion {
            Motion::Sticking => 1.0 / found.sticking.expect("full rank")[0],
            Motion::Renewal => found.renewal.expect("mu < mu_c").f_hat,
            Motion::Sliding => rates(&m, mu, at.direction().expect("it slips")).x,
        };
        assert!((rate - expected).abs() < 1e-4 * m.nn * (1.0 + mu), "{rate} {expected}");
    }
    assert_eq!(beyond, 900);
    let (m, v, _) = two_sleds(0.6, Law::Newton);
    assert_eq!(snapshot_at(&m, &v, 0.6, -1.0).unwrap().velocity, v);
    let refused = |mu: f64, impulse: f64| snapshot_at(&m, &v, mu, impulse).unwrap_err().kind();
    assert_eq!((refused(0.6, f64::NAN), refused(-0.6, 1.0)), ("not_finite", "negative_friction"));
    // The law wedges here; the state at an impulse exists.
    let wedge = ReducedMatrix::new(1.0, 1.0, 0.0, 1.0, 0.0, 0.0);
    let (w, surface) = (Vector3::new(-1.0, -0.1, 1.0), Surface { mu: 2.0, e: 0.5, law: Law::Newton });
    assert!(matches!(solve(&wedge, &w, &surface), Err(ImpactError::Wedged { .. })));
    assert!((snapshot_at(&wedge, &w, 2.0, 500.0).unwrap().velocity.x + 0.3226_f64).abs() < 1e-3);
}

/// Appendix C: in planar systems slip cannot leave its line, c_n has the limit m_tt / (m_nn m_tt - m_nt^2),
/// c_t = -m_nt / (..), c_s = 0, and phi_hat is 0 or pi by the sign of m_nt. Recognised from the numbers: no
/// flag, no quadrature, and the bits of the closed form; the same, but for the bits, in turned axes.
#[test]
fn planar_contacts_are_recognised_from_their_numbers() {
    let mut random = Random::new(9);
    let (mut unstable, mut renewed, mut straight) = (0, 0, 0);
    for index in 0..600 {
        let full = matrix(&mut random);
        let m = ReducedMatrix { ns: 0.0, ts: 0.0, ss: 0.0, ..full };
        let v = Vector3::new(-1.0, if index % 2 == 0 { 1.0 } else { -1.0 } * random.between(0.1, 2.0), 0.0);
        let surface =
            Surface { mu: random.between(0.05, 2.0), e: random.between(0.0, 1.0), law: Law::Poisson };
        let hit = solve(&m, &v, &surface.with_budget(0)).unwrap();
        let closed = solve_structured::<Planar, f64>(&m, &v, &surface).unwrap();
        assert_eq!(hit, closed);
        assert!(!hit.sensitivity.unstable_direction);
        let det = m.nn * m.tt - m.nt * m.nt;
        let found = Characteristics::of(&m, surface.mu);
        let [c_n, c_t, c_s] = found.sticking.expect("it moves along n");
        assert!((c_n * det / m.tt - 1.0).abs() < 1e-11 && c_s == 0.0);
        assert!((c_t * det + m.nt).abs() < 1e-11 * m.nn);
        if let Some(renewal) = found.renewal {
            let expected = if m.nt > 0.0 { 0.0 } else { std::f64::consts::PI };
            assert!((renewal.phi_hat.abs() - expected).abs() < 1e-15);
            renewed += 1;
        }
        // The same in turned axes, where rounding makes the matrix nearly planar, and with mobility across.
        let (sin, cos) = (0.1 + 0.01 * f64::from(index)).sin_cos();
        let turned = m.turned(cos, sin);
        let w = Vector3::new(v.x, v.y * cos, -v.y * sin);
        let other = solve(&turned, &w, &surface).unwrap();
        straight += usize::from(solve(&turned, &w, &surface.with_budget(0)).is_ok());
        assert!(!other.sensitivity.unstable_direction, "{turned:?}");
        assert!((other.velocity.x - hit.velocity.x).abs() < 1e-10);
        let mobile = ReducedMatrix { ss: 0.1 * m.tt, ..m };
        unstable += usize::from(solve(&mobile, &v, &surface).unwrap().sensitivity.unstable_direction);
    }
    // Next to an axis a small diagonal entry has lost digits, and the couplings follow it.
    assert_eq!((unstable, renewed, straight), (523, 132, 598));
}

/// Rounding of the work (23) is no gain of energy: without friction and for e = 1 nothing is lost.
#[test]
fn rounding_is_no_gain() {
    let mut random = Random::new(10);
    for &law in Law::ALL {
        let mut positive = 0;
        for _ in 0..3000 {
            let (m, v) = (matrix(&mut random), approach(&mut random));
            let hit = solve(&m, &v, &Surface { mu: 0.0, e: 1.0, law }).unwrap();
            positive += u32::from(hit.contact_work > 0.0);
            assert_eq!(hit.energy_gained(), None, "{law:?} {:e}", hit.contact_work);
        }
        assert!(law == Law::Newton || positive > 100, "{law:?} {positive}");
    }
    // A gain is one in all units, and its amount is the work.
    for (mass, speed) in [(1.0, 1.0), (1e9, 1e-6), (1e-12, 1e8)] {
        let (m, v, surface) = two_sleds(1.1, Law::Newton);
        let m = ReducedMatrix::from(<[f64; 6]>::from(m).map(|entry| entry / mass));
        let hit = solve(&m, &(v * speed), &surface).unwrap();
        assert_eq!(hit.energy_gained(), Some(hit.contact_work));
        assert_eq!(energy_gained(&hit.impulse, &hit.approach, &hit.velocity), Some(hit.contact_work));
        assert!((hit.contact_work / (mass * speed * speed) - 1.375248751).abs() < 1e-8);
    }
}
