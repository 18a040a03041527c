//! Forces of several contacts at once, in memory of the caller.

use crate::common::random::Random;
use hodograph::several::{Dense, SeveralContacts, Unfound, certify, memory_of_several, solve_several};
use hodograph::{ReducedMatrix, Selection, contact_mode};
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

/// Four corners of a box of mass 1 on the ground: W and the free acceleration of a load.
fn corners(force: &Vector3<f64>, moment: &Vector3<f64>) -> (SMatrix<f64, 12, 12>, SVector<f64, 12>) {
    let mut partials = SMatrix::<f64, 12, 6>::zeros();
    for (i, (x, y)) in [(-0.5, -0.3), (0.5, -0.3), (-0.5, 0.3), (0.5, 0.3)].into_iter().enumerate() {
        let point = Vector3::new(x, y, -0.2);
        for (row, e) in [Vector3::z(), Vector3::x(), Vector3::y()].into_iter().enumerate() {
            let arm = point.cross(&e);
            for c in 0..3 {
                partials[(3 * i + row, c)] = e[c];
                partials[(3 * i + row, 3 + c)] = arm[c];
            }
        }
    }
    let inverse = SVector::<f64, 6>::from_column_slice(&[1.0, 1.0, 1.0, 30.0, 12.0, 9.0]);
    let load =
        SVector::<f64, 6>::from_column_slice(&[force.x, force.y, force.z, moment.x, moment.y, moment.z]);
    let response = SMatrix::<f64, 6, 12>::from_fn(|a, b| inverse[a] * partials[(b, a)]);
    (partials * response, partials * inverse.component_mul(&load))
}

#[test]
fn a_box_is_held_slides_or_tips() {
    for (push, moves) in [(3.0, false), (6.0, true), (-4.0, false), (-9.0, true)] {
        let (w, beta) = corners(&Vector3::new(push, 0.0, -9.81), &Vector3::zeros());
        let problem =
            SeveralContacts { matrix: w.as_slice(), beta: beta.as_slice(), mu: &[0.5; 4], slip: &[None; 4] };
        let (mut force, mut acceleration) = ([0.0; 12], [0.0; 12]);
        let (mut memory, mut matrix) = ([0.0; memory_of_several(4)], [0.0; 144]);
        let found =
            solve_several(&problem, &mut force, &mut acceleration, &mut memory, &mut Dense::new(&mut matrix))
                .unwrap();
        assert!(found.greatest() <= 1e-14, "{found:?}");
        let normal: f64 = (0..4).map(|i| force[3 * i]).sum();
        let along: f64 = (0..4).map(|i| force[3 * i + 1]).sum();
        assert!((normal - 9.81).abs() < 1e-12);
        if moves {
            assert!((along.abs() - 0.5 * 9.81).abs() < 1e-12);
            assert!((acceleration[1].abs() - (push.abs() - 0.5 * 9.81)).abs() < 1e-12);
        } else {
            assert!((along + push).abs() < 1e-12 && acceleration.iter().all(|a| a.abs() < 1e-12));
        }
    }
}

/// Single precision: the same forces to its own accuracy.
#[test]
fn singles_are_solved_too() {
    for push in [3.0, 6.0] {
        let (w, beta) = corners(&Vector3::new(push, 1.0, -9.81), &Vector3::new(0.1, -0.2, 0.05));
        let (w, beta) = (w.map(|entry| entry as f32), beta.map(|entry| entry as f32));
        let problem =
            SeveralContacts { matrix: w.as_slice(), beta: beta.as_slice(), mu: &[0.5; 4], slip: &[None; 4] };
        let (mut force, mut acceleration) = ([0.0_f32; 12], [0.0; 12]);
        let (mut memory, mut matrix) = ([0.0; memory_of_several(4)], [0.0; 144]);
        let found =
            solve_several(&problem, &mut force, &mut acceleration, &mut memory, &mut Dense::new(&mut matrix))
                .unwrap();
        assert!(found.greatest() <= 4096.0 * f32::EPSILON);
        let normal: f32 = (0..4).map(|i| force[3 * i]).sum();
        assert!((normal - 9.81).abs() < 1e-2, "{normal}");
    }
}

/// Second road: the exact selection of modes of one contact.
#[test]
fn one_contact_has_the_mode_of_the_exact_selection() {
    let mut random = Random::new(28);
    let (mut compared, mut refused) = (0, 0);
    for _ in 0..4_000 {
        let mut matrix = Matrix3::zeros();
        for _ in 0..3 {
            let row = Vector3::from_fn(|_, _| random.number());
            matrix += row * row.transpose();
        }
        let beta = Vector3::from_fn(|_, _| random.number());
        let mu = 0.5 * (random.number() + 1.0);
        let slips = random.number() > 0.5;
        let slip = if slips { Vector2::new(random.number(), random.number()) } else { Vector2::zeros() };
        let m = ReducedMatrix::from([
            matrix[(0, 0)],
            matrix[(0, 1)],
            matrix[(0, 2)],
            matrix[(1, 1)],
            matrix[(1, 2)],
            matrix[(2, 2)],
        ]);
        let exact = contact_mode(&m, &beta, &slip, mu);
        let direction = [slips.then(|| slip.normalize())];
        let problem =
            SeveralContacts { matrix: matrix.as_slice(), beta: beta.as_slice(), mu: &[mu], slip: &direction };
        let (mut force, mut acceleration) = ([0.0; 3], [0.0; 3]);
        let (mut memory, mut space) = ([0.0; memory_of_several(1)], [0.0; 9]);
        let found =
            solve_several(&problem, &mut force, &mut acceleration, &mut memory, &mut Dense::new(&mut space));
        match (exact, found) {
            (Ok(exact), Ok(found)) => {
                assert!(found.greatest() <= 1e-12);
                if exact.selection == Selection::Unique {
                    compared += 1;
                    let size = f64::max(1.0, exact.force.amax());
                    let error = (Vector3::from(force) - exact.force).amax();
                    assert!(error <= 1e-9 * size, "{matrix} {beta} {slip} {mu}: {force:?} {:?}", exact.force);
                }
            }
            (Err(_), Err(Unfound::NotFound { .. })) => refused += 1,
            (exact, found) => panic!("{matrix} {beta} {slip} {mu}: {exact:?} {found:?}"),
        }
    }
    assert_eq!((compared, refused), (3964, 10));
}

#[test]
fn input_is_checked() {
    let (w, beta) = corners(&Vector3::new(0.0, 0.0, -9.81), &Vector3::zeros());
    let (mut force, mut acceleration) = ([0.0; 12], [0.0; 12]);
    let (mut memory, mut matrix) = ([0.0; memory_of_several(4)], [0.0; 144]);
    let good =
        SeveralContacts { matrix: w.as_slice(), beta: beta.as_slice(), mu: &[0.5; 4], slip: &[None; 4] };
    let mut solved = |problem: &SeveralContacts<'_, f64>, memory: &mut [f64], space: &mut [f64]| {
        force.fill(0.0);
        solve_several(problem, &mut force, &mut acceleration, memory, &mut Dense::new(space))
    };
    assert!(solved(&good, &mut memory, &mut matrix).is_ok());
    assert_eq!(solved(&good, &mut [0.0; 5], &mut matrix), Err(Unfound::Lengths));
    assert!(matches!(solved(&good, &mut memory, &mut [0.0; 5]), Err(Unfound::NotFound { .. })));
    let short = SeveralContacts { mu: &[0.5; 3], ..good };
    assert_eq!(solved(&short, &mut memory, &mut matrix), Err(Unfound::Lengths));
    let negative = SeveralContacts { mu: &[0.5, 0.5, -0.5, 0.5], ..good };
    assert_eq!(solved(&negative, &mut memory, &mut matrix), Err(Unfound::Input { contact: 2 }));
    assert!(certify(&good, &[0.0; 12], &mut memory).unwrap().greatest() > 0.1);
    let none: SeveralContacts<'_, f64> = SeveralContacts { matrix: &[], beta: &[], mu: &[], slip: &[] };
    let mut memory = [];
    assert!(solve_several(&none, &mut [], &mut [], &mut memory, &mut Dense::new(&mut [])).is_ok());
}

/// Numbers at the ends of their range: an answer is one, and forces that break a law have no certificate without a flaw.
#[test]
fn numbers_without_bounds_are_no_answers() {
    let (mut memory, mut matrix) = ([0.0; memory_of_several(1)], [0.0; 9]);
    for size in [1e-320, 1e-300, 1e-200, 1e200, 1e300, 1e308] {
        let w = Matrix3::<f64>::identity() * size;
        for pull in [1e-200, 1.0, 1e200] {
            let beta = [-pull, 0.1 * pull, 0.0];
            let problem = SeveralContacts { matrix: w.as_slice(), beta: &beta, mu: &[0.3], slip: &[None] };
            let (mut force, mut acceleration) = ([0.0; 3], [0.0; 3]);
            let found = solve_several(
                &problem,
                &mut force,
                &mut acceleration,
                &mut memory,
                &mut Dense::new(&mut matrix),
            );
            let numbers = force.iter().chain(&acceleration).all(|number| number.is_finite());
            assert!(numbers, "{size:e} {pull:e}: {found:?} {force:?} {acceleration:?}");
            let wanted = pull / size;
            // squares of the forces must be numbers, and their parts too
            if found.is_ok() {
                assert!(
                    (force[0] - wanted).abs() <= 1e-12 * wanted.max(1e-290),
                    "{size:e} {pull:e}: {force:?}"
                );
            } else {
                assert!(!(1e-290..1e290).contains(&wanted) || size < 1e-300, "{size:e} {pull:e}: {found:?}");
            }
        }
    }
}

/// Where no acceleration has terms, forces must obey their own laws nevertheless.
#[test]
fn forces_that_move_nothing_obey_their_laws() {
    let mut memory = [0.0; memory_of_several(1)];
    let problem = SeveralContacts { matrix: &[0.0; 9], beta: &[0.0; 3], mu: &[0.3], slip: &[None] };
    let mut worst = |force: [f64; 3]| certify(&problem, &force, &mut memory).unwrap().greatest();
    assert!(worst([-5.0, 0.0, 0.0]) > 0.9);
    assert!(worst([1.0, 100.0, 0.0]) > 0.9);
    assert!(worst([5.0, 1.0, 0.0]) <= 0.0 && worst([0.0; 3]) <= 0.0);
}
