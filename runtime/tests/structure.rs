//! Every structure gives what the general solver gives.

use hodograph::{
    Impact, ImpactError, Law, ReducedMatrix, Surface, solve,
    structure::{Balanced, Diagonal, Frictionless, General, Isotropic, Planar, Structure, solve_structured},
};
use nalgebra::{Matrix3, Vector3};
use num_dual::Dual64;

use crate::common::random::Random;
use crate::common::second_road;

fn compare(
    one: &Result<Impact<f64>, ImpactError<f64>>,
    other: &Result<Impact<f64>, ImpactError<f64>>,
    approach: f64,
    trace: f64,
) {
    let (Ok(a), Ok(b)) = (one, other) else {
        let kind = |r: &Result<_, ImpactError<f64>>| r.as_ref().err().map(ImpactError::kind);
        assert_eq!(kind(one), kind(other));
        return;
    };
    assert_eq!((a.path, a.compressions), (b.path, b.compressions));
    // What cancels in the velocity of separation: what the impulse adds to that of approach.
    let impulse = a.impulse.amax();
    let speed = approach + a.velocity.amax() + 1e-2 * trace * impulse;
    assert!((a.impulse - b.impulse).amax() <= 1e-12 * impulse, "{a:?} {b:?}");
    assert!((a.velocity - b.velocity).amax() <= 1e-12 * speed, "{a:?} {b:?}");
    assert!((a.contact_work - b.contact_work).abs() <= 1e-12 * impulse * speed);
    assert!((a.normal_work - b.normal_work).abs() <= 1e-12 * impulse * speed);
}

/// Over random contacts of every rank; `shape` makes them of the structure.
fn agree<S: Structure>(shape: impl Fn(&mut ReducedMatrix<f64>, &mut Vector3<f64>, &mut Surface<f64>)) {
    let mut random = Random::new(11);
    let mut paths = std::collections::HashSet::new();
    for n in 0..1500 {
        let rank = 1 + n % 3;
        let a = Matrix3::from_fn(|_, j| if j < rank { random.number() } else { 0.0 });
        let mut m = ReducedMatrix::from(a * a.transpose());
        let slip = if n % 10 == 0 { 0.0 } else { random.number() };
        let mut v = Vector3::new(-0.1 - random.number().abs(), slip, slip * random.number());
        let e = [0.0, 1.0, 0.5 + 0.5 * random.number()][(n / 3) % 3];
        let law = Law::ALL[(n / 9) % Law::ALL.len()];
        let mut surface = Surface { mu: 3.0 * random.number().abs().powi(2), e, law };
        // Slip that is fast, hardly there, or nearly along an axis; a contact plane that resists nearly alike
        // in all directions, or half as much in one (where the series of the balanced form would
        // resonate).
        match n % 11 {
            1 => (v.y, v.z) = (v.y * 1e4, v.z * 1e4),
            2 => (v.y, v.z) = (v.y * 1e-5, v.z * 1e-5),
            3 => v.z *= 1e-7,
            4 => v.y *= 1e-12,
            5 => (m.ss, m.ts) = (m.tt * (1.0 + 1e-13), 0.0),
            6 => (m.ss, m.ts, m.nt, m.ns) = (m.tt * (1.0 - 1e-6), 0.0, 0.5 * m.nt, 0.5 * m.ns),
            7 => (m.ss, m.ts, m.nt, m.ns) = (0.5 * m.tt, 0.0, 0.5 * m.nt, 0.5 * m.ns),
            _ => {}
        }
        shape(&mut m, &mut v, &mut surface);
        let general = solve(&m, &v, &surface);
        let structured = solve_structured::<S, f64>(&m, &v, &surface);
        paths.insert(match &general {
            Ok(hit) => hit.path.phases().join("+"),
            Err(error) => error.kind().to_owned(),
        });
        compare(&general, &structured, v.amax(), m.nn + m.tt + m.ss);
    }
    println!("{paths:?}");
    assert!(paths.len() >= 2, "{paths:?}");
}

#[test]
fn general() {
    agree::<General>(|_, _, _| {});
}

#[test]
fn planar() {
    agree::<Planar>(|m, v, _| (m.ns, m.ts, v.z) = (0.0, 0.0, 0.0));
}

#[test]
fn balanced() {
    agree::<Balanced>(|m, _, _| (m.nt, m.ns) = (0.0, 0.0));
}

#[test]
fn diagonal() {
    agree::<Diagonal>(|m, _, _| (m.nt, m.ns, m.ts) = (0.0, 0.0, 0.0));
}

#[test]
fn isotropic() {
    agree::<Isotropic>(|m, _, _| {
        m.tt += m.ss;
        (m.ts, m.ss) = (0.0, m.tt);
    });
}

#[test]
fn frictionless() {
    agree::<Frictionless>(|_, _, surface| surface.mu = 0.0);
}

/// What the closed forms give against a second road that knows nothing of structure.
#[test]
fn closed_forms_are_right() {
    let mut random = Random::new(5);
    let mut worst = [0.0_f64; 3];
    for n in 0..480 {
        let a = Matrix3::from_fn(|_, _| random.number());
        let mut m = ReducedMatrix::from(a * a.transpose());
        let v = Vector3::new(-0.1 - random.number().abs(), 2.0 * random.number(), 2.0 * random.number());
        let law = Law::ALL[n % Law::ALL.len()];
        // Little restitution is what Stronge's hypothesis loses first.
        let e = 0.1 + 0.9 * random.number().abs();
        let e = if n % 2 == 0 { e } else { e * 10.0_f64.powf(-15.0 * random.number().abs()) };
        let surface = Surface { mu: 0.02 + 2.0 * random.number().abs(), e, law };
        let kind = (n / 3) % 3;
        let hit = match kind {
            0 => {
                (m.nt, m.ns) = (0.0, 0.0);
                solve_structured::<Balanced, f64>(&m, &v, &surface)
            }
            1 => {
                (m.nt, m.ns, m.ts) = (0.0, 0.0, 0.0);
                solve_structured::<Diagonal, f64>(&m, &v, &surface)
            }
            _ => {
                m.tt += m.ss;
                (m.ts, m.ss) = (0.0, m.tt);
                solve_structured::<Isotropic, f64>(&m, &v, &surface)
            }
        };
        let (hit, road) =
            (hit.expect("an outcome"), second_road::solve(&m, &v, &surface).expect("an outcome"));
        if road.margin < 1e-6 {
            continue;
        }
        let error = road.error(&hit, &v);
        assert!(
            error <= 1e-12_f64.max(second_road::condition(&m) * 1e-15),
            "{error:e} {m:?} {v:?} {surface:?}"
        );
        worst[kind] = worst[kind].max(error);
    }
    println!("{worst:?}");
}

/// Closed forms differentiate like the general solver: by friction, with dual numbers.
#[test]
fn closed_forms_can_be_differentiated() {
    let dual = |m: &ReducedMatrix<f64>| ReducedMatrix::from(<[f64; 6]>::from(*m).map(Dual64::from_re));
    let v = Vector3::new(-1.0, 0.7, 0.4);
    for &law in Law::ALL {
        for mu in [0.1, 0.4, 1.1] {
            let balanced = ReducedMatrix::new(1.0, 0.0, 0.0, 1.7, 0.3, 0.8);
            let diagonal = ReducedMatrix { ts: 0.0, ..balanced };
            let isotropic = ReducedMatrix::new(1.0, 0.5, -0.3, 1.2, 0.0, 1.2);
            let surface = Surface { mu: Dual64::from_re(mu).derivative(), e: Dual64::from_re(0.6), law };
            let w = v.map(Dual64::from_re);
            let general = |m| solve(&dual(m), &w, &surface).expect("an outcome");
            let pairs = [
                (general(&balanced), solve_structured::<Balanced, _>(&dual(&balanced), &w, &surface)),
                (general(&diagonal), solve_structured::<Diagonal, _>(&dual(&diagonal), &w, &surface)),
                (general(&isotropic), solve_structured::<Isotropic, _>(&dual(&isotropic), &w, &surface)),
            ];
            for (one, other) in pairs {
                let other = other.expect("an outcome");
                let slope = |hit: &Impact<Dual64>| hit.impulse.map(|x| x.eps);
                assert!(
                    (slope(&one) - slope(&other)).amax() <= 1e-10 * (1.0 + slope(&one).amax()),
                    "{law:?} {mu}"
                );
            }
        }
    }
}
