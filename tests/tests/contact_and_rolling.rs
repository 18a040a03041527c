//! A ball, a disc, a torus and an ellipsoid on a contact that sticks move as those that are constrained to roll.
//!
//! The models of `models/`, and `rolling_torus`, roll by constraints; the others of `tests/models` are free bodies with
//! a contact of two shapes, whose force is found by its mode.

use crate::common::random::Random;
use hodograph::nalgebra::Vector3;
use hodograph::{ContactMode, Law, Margins, Selection, Surface};
use hodograph_models::{ball_on_turntable, rattleback, rolling_disc};

#[allow(missing_docs)]
mod emitted {
    hodograph::mechanism!("models/ball_on_contact.mech");
    hodograph::mechanism!("models/disc_on_contact.mech");
    hodograph::mechanism!("models/rattleback_on_contact.mech");
    hodograph::mechanism!("models/rolling_torus.mech");
    hodograph::mechanism!("models/torus_on_contact.mech");
}
use emitted::{ball_on_contact, disc_on_contact, rattleback_on_contact, rolling_torus, torus_on_contact};

const ROUGH: Surface<f64> = Surface { mu: 2.0, e: 0.0, law: Law::Poisson };

/// Largest difference over the largest entry.
fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    let top = theirs.iter().fold(f64::MIN_POSITIVE, |top, x| top.max(x.abs()));
    ours.iter().zip(theirs).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / top
}

/// What ends a contact that sticks.
fn holds(margins: &Margins<f64>) -> bool {
    margins.lambda_n.is_some_and(|force| force > 0.0) && margins.cone.is_some_and(|margin| margin > 0.0)
}

/// Counts the states in which the contact holds by itself, and those in which it is held by more force than
/// it has.
#[derive(Debug, Default)]
struct Met {
    holds: usize,
    lets_go: usize,
    worst: f64,
}

impl Met {
    fn note(&mut self, kept: &Margins<f64>, selected: ContactMode, selection: Selection, worst: f64) {
        self.worst = self.worst.max(worst);
        if holds(kept) {
            self.holds += 1;
            assert!(selected == ContactMode::Stick || selection == Selection::SeveralModes, "{selected:?}");
        } else {
            self.lets_go += 1;
            assert_ne!(selected, ContactMode::Stick);
        }
    }
}

#[test]
fn a_ball_rolls_on_a_contact() {
    let (rolling, free) =
        (ball_on_turntable::BallOnTurntable::<f64>::default(), ball_on_contact::BallOnContact::default());
    let mut random = Random::named("ball");
    let mut met = Met::default();
    for _ in 0..400 {
        let time = 3.0 * random.number();
        let [x, y] = [random.number(), random.number()];
        let turn = [random.number(), random.number(), random.number(), random.number()];
        let length = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
        let [e0, e1, e2, e3] = turn.map(|part| part / length);
        let [w1, w2, w3] = [(); 3].map(|()| 10.0 * random.number());
        let q = ball_on_turntable::Coordinates { x, y, e0, e1, e2, e3 };
        let u = ball_on_turntable::Speeds { w1, w2, w3 };
        let v = rolling.dependent_speeds(time, &q, &u).unwrap();
        let rates = rolling.accelerations(time, &q, &u).unwrap();
        let dependent = rolling.dependent_accelerations(time, &q, &u).unwrap();
        let expected = [rates.w1, rates.w2, rates.w3, dependent.vx, dependent.vy, 0.0];

        let r = rolling.parameters().r;
        let q = ball_on_contact::Coordinates { x, y, z: r, e0, e1, e2, e3 };
        let u = ball_on_contact::Speeds { w1, w2, w3, vx: v.vx, vy: v.vy, vz: 0.0 };
        assert_eq!(free.gap_table(time, &q).unwrap(), 0.0);
        let kept = free.contact_force_table(time, &q, &u, ContactMode::Stick, &ROUGH).unwrap();
        let found: [f64; 6] = kept.accelerations.into();
        let selected = free.contact_mode_table(time, &q, &u, &ROUGH).unwrap();
        met.note(&kept.margins, selected.mode, selected.selection, apart(&found, &expected));
    }
    println!("{met:?}");
    assert!(met.worst < 1e-12 && met.holds > 300, "{met:?}");
}

#[test]
fn a_disc_rolls_on_a_contact() {
    let (rolling, free) =
        (rolling_disc::RollingDisc::<f64>::default(), disc_on_contact::DiscOnContact::default());
    let mut random = Random::named("disc");
    let mut met = Met::default();
    for _ in 0..400 {
        let [q1, q3, q4, q5] = [(); 4].map(|()| 3.0 * random.number());
        let q2 = 1.2 * random.number();
        let [u1, u2, u3] = [(); 3].map(|()| 3.0 * random.number());
        let q = rolling_disc::Coordinates { q1, q2, q3, q4, q5 };
        let u = rolling_disc::Speeds { u1, u2, u3 };
        let rates = rolling.accelerations(&q, &u).unwrap();
        let v = rolling.velocity_g(&q, &u).unwrap();
        let a = rolling.acceleration_g(&q, &u, &rates).unwrap();
        let expected = [rates.u1, rates.u2, rates.u3, a.x, a.y, a.z];

        let g = rolling.position_g(&q).unwrap();
        let q = disc_on_contact::Coordinates { q1, q2, q3, q4: g.x, q5: g.y, q6: g.z };
        let u = disc_on_contact::Speeds { u1, u2, u3, u4: v.x, u5: v.y, u6: v.z };
        assert!(free.gap_ground(&q).unwrap().abs() < 1e-15);
        let kept = free.contact_force_ground(&q, &u, ContactMode::Stick, &ROUGH).unwrap();
        let found: [f64; 6] = kept.accelerations.into();
        let selected = free.contact_mode_ground(&q, &u, &ROUGH).unwrap();
        met.note(&kept.margins, selected.mode, selected.selection, apart(&found, &expected));
    }
    println!("{met:?}");
    assert!(met.worst < 1e-12 && met.holds > 200, "{met:?}");
}

#[test]
fn a_torus_rolls_on_a_contact() {
    let (rolling, free) =
        (rolling_torus::RollingTorus::<f64>::default(), torus_on_contact::TorusOnContact::default());
    let mut random = Random::named("torus");
    let mut met = Met::default();
    for _ in 0..400 {
        let [q1, q3, q4, q5] = [(); 4].map(|()| 3.0 * random.number());
        let q2 = 1.2 * random.number();
        let [u1, u2, u3] = [(); 3].map(|()| 3.0 * random.number());
        let q = rolling_torus::Coordinates { q1, q2, q3, q4, q5 };
        let u = rolling_torus::Speeds { u1, u2, u3 };
        let rates = rolling.accelerations(&q, &u).unwrap();
        let v = rolling.velocity_g(&q, &u).unwrap();
        let a = rolling.acceleration_g(&q, &u, &rates).unwrap();
        let expected = [rates.u1, rates.u2, rates.u3, a.x, a.y, a.z];

        let g = rolling.position_g(&q).unwrap();
        let q = torus_on_contact::Coordinates { q1, q2, q3, q4: g.x, q5: g.y, q6: g.z };
        let u = torus_on_contact::Speeds { u1, u2, u3, u4: v.x, u5: v.y, u6: v.z };
        assert!(free.gap_ground(&q).unwrap().abs() < 1e-15);
        let kept = free.contact_force_ground(&q, &u, ContactMode::Stick, &ROUGH).unwrap();
        let found: [f64; 6] = kept.accelerations.into();
        let selected = free.contact_mode_ground(&q, &u, &ROUGH).unwrap();
        met.note(&kept.margins, selected.mode, selected.selection, apart(&found, &expected));
    }
    println!("{met:?}");
    assert!(met.worst < 1e-12 && met.holds > 150, "{met:?}");
}

#[test]
fn a_rattleback_rolls_on_a_contact() {
    let (rolling, free) =
        (rattleback::Rattleback::<f64>::default(), rattleback_on_contact::RattlebackOnContact::default());
    let parameters = rolling.parameters();
    let mut random = Random::named("rattleback");
    let mut met = Met::default();
    for _ in 0..400 {
        let [q1, q4, q5] = [(); 3].map(|()| 3.0 * random.number());
        let [q2, q3] = [(); 2].map(|()| 0.3 * random.number());
        let [u1, u2] = [(); 2].map(|()| 2.0 * random.number());
        let u3 = 8.0 * random.number();
        // The celt stands on its lowest point.
        let up = free.orientation_r(&rattleback_on_contact::Coordinates { q1, q2, q3, ..Default::default() });
        let up: Vector3<f64> = up.unwrap().row(2).transpose();
        let rattleback::Parameters { a, b, c, h, .. } = *parameters;
        let height = Vector3::new(a * up.x, b * up.y, c * up.z).norm() - h * up.z;
        let q = rattleback::Coordinates { q1, q2, q3, q4, q5, q6: height };
        let u = rattleback::Speeds { u1, u2, u3 };
        assert!(rolling.configuration_residual(&q).unwrap().amax() < 1e-15);
        let rates = rolling.accelerations(&q, &u).unwrap();
        let v = rolling.velocity_g(&q, &u).unwrap();
        let a = rolling.acceleration_g(&q, &u, &rates).unwrap();
        let expected = [rates.u1, rates.u2, rates.u3, a.x, a.y, a.z];

        let q = rattleback_on_contact::Coordinates { q1, q2, q3, q4, q5, q6: height };
        let u = rattleback_on_contact::Speeds { u1, u2, u3, u4: v.x, u5: v.y, u6: v.z };
        let kept = free.contact_force_ground(&q, &u, ContactMode::Stick, &ROUGH).unwrap();
        let found: [f64; 6] = kept.accelerations.into();
        let selected = free.contact_mode_ground(&q, &u, &ROUGH).unwrap();
        met.note(&kept.margins, selected.mode, selected.selection, apart(&found, &expected));
    }
    println!("{met:?}");
    assert!(met.worst < 1e-12 && met.holds > 100, "{met:?}");
}

/// Mode and force in single precision, and with derivatives by the lean of the disc: against differences of
/// fourth order.
#[test]
fn the_force_is_as_generic_as_the_module() {
    use num_dual::Dual64;
    let mut random = Random::named("duals");
    let mut modes = [0; 4];
    for case in 0..300 {
        let numbers: [f64; 6] = std::array::from_fn(|_| random.number());
        let speeds: [f64; 6] = std::array::from_fn(|_| 0.3 * random.number());
        // Slip, or none: then the force has derivatives along states without slip only, and all speeds rest.
        let speeds = if case % 3 == 0 { [0.0; 6] } else { speeds };
        let mu = 0.3 + 0.25 * random.number();
        let disc = disc_on_contact::DiscOnContact::<f64>::default();
        let ask = |h: f64| {
            let mut q = numbers;
            q[1] += h;
            disc.contact_mode_ground(&q.into(), &speeds.into(), &Surface { mu, ..ROUGH })
        };
        let Ok(answer) = ask(0.0) else { continue };
        let h = 1e-4;
        let near = [-2.0, -1.0, 1.0, 2.0].map(|k| ask(k * h));
        if near.iter().any(|near| near.as_ref().map(|near| near.mode) != Ok(answer.mode)) {
            continue;
        }
        let [a, b, c, d] = near.map(|near| near.unwrap().force_on_point);
        let difference = ((c - b) * 8.0 - (d - a)) / (12.0 * h);

        let lift = |x: f64| Dual64::from_re(x);
        let mut q = numbers.map(lift);
        q[1].eps = 1.0;
        let surface = Surface { mu: lift(mu), e: lift(0.0), law: Law::Poisson };
        let dual = disc_on_contact::DiscOnContact::<Dual64>::default();
        let dual = dual.contact_mode_ground(&q.into(), &speeds.map(lift).into(), &surface).unwrap();
        assert_eq!(dual.mode, answer.mode);
        let derivative = dual.force_on_point.map(|x| x.eps);
        let size = 1.0 + answer.force.amax() + derivative.amax();
        assert!((derivative - difference).amax() <= 1e-6 * size, "{case}: {derivative} {difference}");

        let single = disc_on_contact::DiscOnContact::<f32>::default();
        let surface = Surface { mu: mu as f32, e: 0.0, law: Law::Poisson };
        let single = single.contact_mode_ground(
            &numbers.map(|x| x as f32).into(),
            &speeds.map(|x| x as f32).into(),
            &surface,
        );
        let single = single.unwrap();
        let off = (single.force_on_point.cast::<f64>() - answer.force_on_point).amax();
        assert!(single.mode != answer.mode || off <= 1e-4 * size, "{case}: {off:e}");
        modes[answer.mode as usize] += 1;
    }
    println!("{modes:?}");
    assert!(modes[1] > 50 && modes[2] + modes[3] > 50, "{modes:?}");
}
