//! The derivative of the outcome against central differences, and where it does not exist.

use crate::common::random::Random;
use hodograph::{Law, NonSmoothness, ReducedMatrix, Surface, derivative, saltation, solve, speed_derivative};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type Inputs = [f64; 11];

fn outcome(x: &Inputs, law: Law) -> Option<(hodograph::Impact<f64>, SVector<f64, 6>)> {
    let [vn, vt, vs, nn, nt, ns, tt, ts, ss, mu, e] = *x;
    let hit = solve(
        &ReducedMatrix::new(nn, nt, ns, tt, ts, ss),
        &Vector3::new(vn, vt, vs),
        &Surface { mu, e, law },
    )
    .ok()?;
    let (i, v) = (hit.impulse, hit.velocity);
    Some((hit, SVector::from([i.x, i.y, i.z, v.x, v.y, v.z])))
}

fn exact(x: &Inputs, law: Law) -> (hodograph::ImpactDerivative<f64>, SMatrix<f64, 6, 11>) {
    let [vn, vt, vs, nn, nt, ns, tt, ts, ss, mu, e] = *x;
    let d = derivative(
        &ReducedMatrix::new(nn, nt, ns, tt, ts, ss),
        &Vector3::new(vn, vt, vs),
        &Surface { mu, e, law },
    )
    .expect("solved");
    let mut all = SMatrix::<f64, 6, 11>::zeros();
    all.fixed_rows_mut::<3>(0).copy_from(&d.impulse);
    all.fixed_rows_mut::<3>(3).copy_from(&d.velocity);
    (d, all)
}

/// A central difference of fourth order; nothing where the path changes within its reach.
fn difference(x: &Inputs, law: Law, input: usize) -> Option<SVector<f64, 6>> {
    let here = outcome(x, law)?.0;
    let h = 1e-4 * x[input].abs().max(0.1);
    let at = |k: f64| {
        let mut y = *x;
        y[input] += k * h;
        let (hit, values) = outcome(&y, law)?;
        (hit.path == here.path && hit.compressions == here.compressions).then_some(values)
    };
    Some(((at(1.0)? - at(-1.0)?) * 8.0 - (at(2.0)? - at(-2.0)?)) / (12.0 * h))
}

#[test]
fn agrees_with_central_differences() {
    let mut random = Random::new(7);
    let mut compared = 0;
    let mut worst: f64 = 0.0;
    for n in 0..300 {
        let a = Matrix3::from_fn(|_, _| random.number());
        let m = a * a.transpose() + Matrix3::identity() * 0.1;
        let mu = 1.0 + random.number() * 0.99;
        let e = 0.5 + random.number() * 0.45;
        let x = [
            -1.0 + 0.8 * random.number(),
            random.number(),
            random.number(),
            m.m11,
            m.m21,
            m.m31,
            m.m22,
            m.m32,
            m.m33,
            mu,
            e,
        ];
        let law = Law::ALL[n % Law::ALL.len()];
        let (d, all) = exact(&x, law);
        if d.non_smoothness.is_some() {
            continue;
        }
        for input in 0..11 {
            let Some(numeric) = difference(&x, law, input) else { continue };
            let column = all.column(input);
            let error = (numeric - column).amax() / (1.0 + all.amax());
            assert!(error <= 2e-7, "input {input}, {law:?}, {x:?}: {error:e}\n{numeric}{column}");
            worst = worst.max(error);
            compared += 1;
        }
    }
    println!("{compared} columns, worst {worst:e}");
    assert_eq!(compared, 3299);
}

/// Slip that keeps its direction: the derivative across it is what it turns into.
#[test]
fn straight_hodographs_bend() {
    for &law in Law::ALL {
        for (mu, e, vt) in [(0.3, 0.6, 2.0), (0.9, 0.5, 0.3), (0.2, 0.7, 0.1)] {
            let x = [-1.0, vt, 0.0, 1.0, 0.3, 0.0, 1.7, 0.0, 0.8, mu, e];
            let (d, all) = exact(&x, law);
            assert_eq!(d.non_smoothness, None);
            for input in 0..11 {
                let numeric = difference(&x, law, input).expect("one path");
                let error = (numeric - all.column(input)).amax();
                assert!(
                    error <= 1e-6,
                    "input {input}, {law:?}, mu {mu}: {error:e}\n{numeric}{}",
                    all.column(input)
                );
            }
        }
    }
}

#[test]
fn no_restitution_has_a_right_hand_derivative() {
    for &law in Law::ALL {
        for mu in [0.2, 0.6, 1.5] {
            let x = [-1.0, 0.4, 0.1, 1.0, 0.3, -0.2, 1.7, 0.1, 1.2, mu, 0.0];
            let (_, all) = exact(&x, law);
            let h = 1e-4;
            let at = |k: f64| {
                let mut y = x;
                y[10] = k * h;
                outcome(&y, law).expect("solved").1
            };
            let numeric = (at(1.0) * 4.0 - at(2.0) - at(0.0) * 3.0) / (2.0 * h);
            let error = (numeric - all.column(10)).amax();
            assert!(error <= 1e-6, "{law:?} {mu}: {error:e}\n{numeric}{}", all.column(10));
        }
    }
}

#[test]
fn says_where_there_is_none() {
    // The two sleds of the paper: slip stops in a direction other than that in which it is renewed.
    let m: ReducedMatrix<f64> =
        ReducedMatrix::new(0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211);
    let det = m.tt * m.ss - m.ts * m.ts;
    let critical = ((m.ss * m.nt - m.ts * m.ns) / det).hypot((m.tt * m.ns - m.ts * m.nt) / det);
    for &law in Law::ALL {
        let at = |mu: f64| {
            let surface = Surface { mu, e: 0.8, law };
            derivative(&m, &Vector3::new(-0.946108022, 1.06306701, 0.0), &surface)
                .expect("solved")
                .non_smoothness
        };
        assert_eq!(at(critical), Some(NonSmoothness::CriticalFriction));
        assert_eq!([at(0.6), at(1.1), at(1.6)], [None; 3]);
    }
    let surface = Surface { mu: 0.5, e: 0.5, law: Law::Poisson };
    let still = derivative(&m, &Vector3::new(-1.0, 0.0, 0.0), &surface).expect("solved");
    assert_eq!(still.non_smoothness, Some(NonSmoothness::NoSlip));
    // Slip that stops just when the collision ends: mu I_n2 = v_t.
    let m = ReducedMatrix::new(1.0, 0.0, 0.0, 1.0, 0.0, 1.0);
    let surface = Surface { mu: 0.5, e: 0.5, law: Law::Poisson };
    let last = derivative(&m, &Vector3::new(-1.0, 0.75, 0.0), &surface).expect("solved");
    assert_eq!(last.non_smoothness, Some(NonSmoothness::PathChange));
}

/// The example at mu = mu_s: slip along t stays along t, and v_n would feel it turn.
#[test]
fn straight_hodographs_are_not_smooth() {
    let m: ReducedMatrix<f64> =
        ReducedMatrix::new(0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211);
    let surface = |law| Surface { mu: m.ns / m.ts, e: 0.8, law };
    for &law in Law::ALL {
        let d = derivative(&m, &Vector3::new(-0.946108022, 1.06306701, 0.0), &surface(law)).expect("solved");
        assert_eq!(d.non_smoothness, Some(NonSmoothness::Straight), "{law:?}");
        // A little to the side there is one again.
        let d = derivative(&m, &Vector3::new(-0.946108022, 1.06306701, 0.01), &surface(law)).expect("solved");
        assert_eq!(d.non_smoothness, None, "{law:?}");
    }
}

/// Where restitution ends just before the bodies approach again, or just after: the outcome jumps between the
/// two.
#[test]
fn grazing_is_not_smooth() {
    let m = ReducedMatrix::new(2.1, -2.1, -1.35, 2.3, 1.15, 4.3);
    let v = Vector3::new(-0.22, -0.2, 1.0);
    for law in [Law::Poisson, Law::Stronge] {
        let at = |e: f64| solve(&m, &v, &Surface { mu: 1.95, e, law }).expect("solved");
        let (mut once, mut twice) = (0.01, 0.5);
        assert_eq!((at(once).compressions, at(twice).compressions), (1, 2));
        for _ in 0..60 {
            let e = 0.5 * (once + twice);
            if at(e).compressions == 1 { once = e } else { twice = e }
        }
        let jump = (at(once).impulse - at(twice).impulse).norm();
        assert!(jump > 1e-3 * at(once).impulse.norm(), "{law:?} {jump}");
        for e in [once, twice] {
            let d = derivative(&m, &v, &Surface { mu: 1.95, e, law }).expect("solved");
            assert_eq!(d.non_smoothness, Some(NonSmoothness::Grazing), "{law:?}");
            assert!(d.impact.sensitivity.grazing);
        }
        for e in [once - 5e-3, twice + 0.1] {
            let d = derivative(&m, &v, &Surface { mu: 1.95, e, law }).expect("solved");
            assert_eq!(d.non_smoothness, None, "{law:?}");
        }
    }
}

/// A point mass that falls on a frictionless floor: the saltation matrix is known.
#[test]
fn saltation_of_a_bouncing_ball() {
    let m = ReducedMatrix::new(0.5, 0.0, 0.0, 0.5, 0.0, 0.5);
    let (e, v, g) = (0.8, 3.0, 9.81);
    let surface = Surface { mu: 0.0, e, law: Law::Newton };
    let d = derivative(&m, &Vector3::new(-v, 1.0, 0.0), &surface).expect("solved");
    let partial = SMatrix::<f64, 3, 1>::new(1.0, 0.0, 0.0);
    let jump = speed_derivative(&d, &partial, &(partial.transpose() * 0.5));
    assert!((jump.x + e).abs() < 1e-15);
    let reset = SMatrix::<f64, 2, 2>::new(1.0, 0.0, 0.0, jump.x);
    let matrix = saltation(
        &reset,
        &SVector::<f64, 2>::new(-v, -g),
        &SVector::<f64, 2>::new(e * v, -g),
        &SVector::<f64, 2>::new(1.0, 0.0),
    )
    .expect("closing");
    let known = SMatrix::<f64, 2, 2>::new(-e, 0.0, g * (1.0 + e) / v, -e);
    assert!((matrix - known).amax() < 1e-14, "{matrix}");
}
