//! The paper's methods against the exact solver: integration to its tolerance, the threshold eps_s, and the
//! error of summation.
#![cfg(feature = "std")]

use crate::common::reference_cases;
use hodograph::methods::{
    Integration, MethodError, Partial, Summation, Switch, integrate, irs, stability, sum,
};
use hodograph::{Impact, ImpactError, Law, Path, ReducedMatrix, Surface, solve};
use nalgebra::Vector3;

/// The two sleds of section 5, rounded to eight digits.
fn sleds() -> (ReducedMatrix<f64>, Vector3<f64>) {
    (
        ReducedMatrix::new(0.22510385, -0.10936656, -0.12575887, 0.23598633, -0.11584858, 0.27021211),
        Vector3::new(-0.946108022, 1.06306701, 0.0),
    )
}

fn nine() -> Vec<Surface<f64>> {
    [0.6, 1.1, 1.6]
        .into_iter()
        .flat_map(|mu| Law::ALL.iter().map(move |&law| Surface { mu, e: 0.8, law }))
        .collect()
}

/// The scaled difference of two outcomes.
fn error(ours: &Impact<f64>, exact: &Impact<f64>, approach: &Vector3<f64>) -> f64 {
    let (impulse, velocity) = (exact.impulse.amax(), exact.velocity.amax() + approach.amax());
    ((ours.impulse - exact.impulse).amax() / impulse)
        .max((ours.velocity - exact.velocity).amax() / velocity)
        .max((ours.contact_work - exact.contact_work).abs() / (impulse * velocity))
        .max((ours.normal_work - exact.normal_work).abs() / (impulse * velocity))
}

#[test]
fn integration_agrees_with_the_exact_solver_on_the_nine() {
    let (m, v) = sleds();
    for surface in nine() {
        let exact = solve(&m, &v, &surface).unwrap();
        for tolerance in [1e-6, 1e-8, 1e-10, 1e-12] {
            let options = Integration::with_tolerance(tolerance);
            for ours in [
                integrate(&m, &v, &surface, &options).unwrap().impact,
                irs(&m, &v, &surface, &Partial::Integrate(options)).unwrap().impact,
            ] {
                let error = error(&ours, &exact, &v);
                assert!(error <= 20.0 * tolerance, "{surface:?} {tolerance:e}: {error:e}");
                assert_eq!((ours.path, ours.compressions), (exact.path, exact.compressions));
            }
        }
    }
}

/// The second road to every reference collision: the answers have 25 digits and come from neither.
#[test]
fn integration_agrees_with_every_reference_case() {
    for case in reference_cases() {
        let ours =
            integrate(&case.matrix, &case.approach, &case.surface, &Integration::with_tolerance(1e-11));
        let ours = ours.unwrap_or_else(|e| panic!("{e}: {}", case.line)).impact;
        let error = case.error(&ours);
        assert!(error <= 1e-8_f64.max(1e-10 * case.condition), "{error:e}: {}", case.line);
        if let Some(n) = case.compressions {
            assert_eq!(u64::from(ours.compressions), n, "{}", case.line);
        }
    }
}

/// Section 5 says eps_s = 0.1 .. 0.01 (m/s); the slip at the start is 1.063 m/s.
#[test]
fn the_threshold_does_not_matter() {
    let (m, v) = sleds();
    for surface in nine() {
        let at = |eps_s: f64, switch| {
            let options = Integration { slip_threshold: eps_s / v.y, switch, ..Integration::default() };
            integrate(&m, &v, &surface, &options).unwrap().impact
        };
        let exact = solve(&m, &v, &surface).unwrap();
        for eps_s in [0.1, 0.05, 0.02, 0.01] {
            assert!(error(&at(eps_s, Switch::AtRest), &exact, &v) < 1e-9, "{surface:?} {eps_s}");
        }
        let literal = |eps_s| error(&at(eps_s, Switch::AtThreshold), &exact, &v);
        if exact.path == Path::Sliding {
            // Slip passes the origin at a distance between 0.05 and 0.1 m/s: a threshold below that is never
            // met.
            println!("{} {:?}: {:?}", surface.mu, surface.law, [0.1, 0.05, 0.02, 0.01].map(literal));
            assert!(literal(0.01) < 1e-9);
        } else {
            // Slip that is dropped is an error in proportion to it.
            let errors = [0.1, 0.01, 0.001, 1e-6].map(literal);
            println!("{} {:?}: {errors:?}", surface.mu, surface.law);
            assert!(errors[1] < 0.3 * errors[0] && errors[2] < 0.3 * errors[1] && errors[3] < 1e-5);
        }
    }
}

#[test]
fn the_error_of_summation_falls_with_refinement() {
    let (m, v) = sleds();
    for surface in nine() {
        let exact = solve(&m, &v, &surface).unwrap();
        let of = |k| {
            let options = Summation { k, unit: Some(1.0) };
            [
                error(&sum(&m, &v, &surface, &options).unwrap().impact, &exact, &v),
                error(&irs(&m, &v, &surface, &Partial::Sum(options)).unwrap().impact, &exact, &v),
            ]
        };
        let errors = [1, 5, 50, 500, 5000].map(of);
        println!("{} {:?}: {errors:?}", surface.mu, surface.law);
        for i in 0..2 {
            assert!(errors[2][i] < 0.7 * errors[0][i], "{surface:?} {errors:?}");
            for k in 3..5 {
                assert!(errors[k][i] < 0.2 * errors[k - 1][i], "{surface:?} {errors:?}");
            }
        }
    }
}

/// Units, and tangential axes, do not matter to the methods either.
#[test]
fn the_default_unit_of_impulse_does_not_depend_on_units() {
    let (m, v) = sleds();
    let surface = Surface { mu: 1.1, e: 0.8, law: Law::Stronge };
    let ours = sum(&m, &v, &surface, &Summation::new(5)).unwrap().impact;
    let [nn, nt, ns, tt, ts, ss] = <[f64; 6]>::from(m).map(|x| x * 1e6);
    let other = ReducedMatrix::new(nn, nt, ns, tt, ts, ss);
    let theirs = sum(&other, &(v * 1e-3), &surface, &Summation::new(5)).unwrap().impact;
    assert!((theirs.velocity * 1e3 - ours.velocity).amax() < 1e-12);
    assert!((theirs.impulse * 1e9 - ours.impulse).amax() < 1e-9);
}

#[test]
fn errors_are_those_of_the_exact_solver() {
    let (m, v) = sleds();
    let surface = Surface { mu: 0.5, e: 0.5, law: Law::Newton };
    let all = |m: &ReducedMatrix<f64>, v: &Vector3<f64>, surface: &Surface<f64>| {
        [
            integrate(m, v, surface, &Integration::default()),
            sum(m, v, surface, &Summation::new(1)),
            irs(m, v, surface, &Partial::Sum(Summation::new(1))),
            irs(m, v, surface, &Partial::Integrate(Integration::default())),
        ]
    };
    for (matrix, approach, surface) in [
        (m, -v, surface),
        (m, v * f64::NAN, surface),
        (m, v, Surface { mu: -1.0, ..surface }),
        (m, v, Surface { e: 1.5, ..surface }),
        (ReducedMatrix::new(1.0, 2.0, 0.0, 1.0, 0.0, 1.0), v, surface),
        (ReducedMatrix::new(0.0, 0.0, 0.0, 1.0, 0.0, 1.0), v, surface),
        // No slip, and no motion along the normal without slip: it wedges.
        (
            ReducedMatrix::new(1.0, 1.0, 0.0, 1.0, 0.0, 0.0),
            Vector3::new(-1.0, 0.0, 0.0),
            Surface { mu: 2.0, ..surface },
        ),
    ] {
        let expected = solve(&matrix, &approach, &surface).unwrap_err().kind();
        for answer in all(&matrix, &approach, &surface) {
            assert_eq!(answer.unwrap_err().kind(), expected);
        }
    }
    assert!(matches!(
        sum(&m, &v, &surface, &Summation::new(0)),
        Err(MethodError::BadOption { name: "k", .. })
    ));
    assert!(matches!(
        integrate(&m, &v, &surface, &Integration::with_tolerance(0.0)),
        Err(MethodError::BadOption { name: "tolerance", .. })
    ));
    // Slides for ever.
    let wedge = ReducedMatrix::new(1.0, 1.0, 0.0, 1.0, 0.0, 0.0);
    for answer in all(&wedge, &Vector3::new(-1.0, -0.1, 1.0), &Surface { mu: 2.0, ..surface }) {
        match answer.unwrap_err() {
            // It tends to -0.3226 (a coarse summation to something near it).
            MethodError::Unfinished { normal_velocity, .. } => {
                assert!(normal_velocity < 0.0, "{normal_velocity}");
            }
            MethodError::Impact(ImpactError::Wedged { .. }) => {}
            other => panic!("{other}"),
        }
    }
}

/// 6.1 as corrected: at phi_bar the eigenvalues are h' / s and 0; elsewhere a step is stable up to the bound.
#[test]
fn stability_bounds_the_step() {
    let (m, _) = sleds();
    let rates = |mu: f64, phi: f64, s: f64| {
        let (sin, cos) = phi.sin_cos();
        let v = (m.nt - mu * (m.tt * cos + m.ts * sin), m.ns - mu * (m.ts * cos + m.ss * sin));
        [(v.1 * cos - v.0 * sin) / s, v.0 * cos + v.1 * sin]
    };
    for (mu, phi, s) in [(1.6, 0.598067, 0.01), (1.1, 0.4323866, 0.1), (0.6, 0.3, 1.0), (0.6, 2.0, 0.5)] {
        let found = stability(&m, mu, phi, s);
        // The Jacobian by differences: trace and determinant are those of the eigenvalues.
        let d = 1e-6;
        let (a, b) = (rates(mu, phi + d, s), rates(mu, phi - d, s));
        let (p, q) = (rates(mu, phi, s + d * s), rates(mu, phi, s - d * s));
        let j = [
            (a[0] - b[0]) / (2.0 * d),
            (p[0] - q[0]) / (2.0 * d * s),
            (a[1] - b[1]) / (2.0 * d),
            (p[1] - q[1]) / (2.0 * d * s),
        ];
        let [x, y] = found.eigenvalues;
        let size = x.norm() + y.norm();
        assert!(((x + y).re - j[0] - j[3]).abs() < 1e-7 * size, "{found:?}");
        assert!(((x * y).re - (j[0] * j[3] - j[1] * j[2])).abs() < 1e-7 * size * size, "{found:?}");
        let worst = |step: f64| found.eigenvalues.iter().fold(0.0_f64, |w, l| w.max((l * step + 1.0).norm()));
        if found.largest_step > 0.0 {
            assert!(worst(found.largest_step * 0.999) <= 1.0 && worst(found.largest_step * 1.001) > 1.0);
            assert!(found.permits(found.largest_step * 0.5) && !found.permits(found.largest_step * 2.0));
        }
    }
    // At phi_bar: -h' D / s < 2.
    let bar = stability(&m, 1.6, 0.598067, 0.01);
    assert!(bar.eigenvalues[1].norm() < 1e-4 * bar.eigenvalues[0].norm());
}
