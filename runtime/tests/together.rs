//! Collisions that are solved together have the bits and the errors of single ones, whatever stands beside them.

use crate::common::random::{Draw, Random};
use crate::common::reference_cases;
use crate::hostile::contact;
use hodograph::lanes::solve_each;
use hodograph::{Impact, ImpactError, Law, ReducedMatrix, Surface, solve};
use nalgebra::{Matrix3, Vector3};

type Collision = (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>);

/// The answers in the order of the collisions. Each is given once.
fn together(collisions: &[Collision]) -> Vec<Result<Impact<f64>, ImpactError<f64>>> {
    let mut answers = vec![None; collisions.len()];
    solve_each(collisions.iter().copied(), |place, answer| {
        assert!(answers[place].replace(answer).is_none(), "{place} is answered twice");
    });
    answers.into_iter().map(|answer| answer.expect("an answer")).collect()
}

/// Compares all numbers, flags and errors with those of single collisions: the text of a number tells its bits.
fn compare(collisions: &[Collision]) {
    for ((m, v, surface), found) in collisions.iter().zip(together(collisions)) {
        let expected = solve(m, v, surface);
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{m:?} {v:?} {surface:?}");
    }
}

/// A contact of full rank, as mechanisms have it.
fn usual(random: &mut Random) -> Collision {
    let b = Matrix3::from_fn(|_, _| random.number());
    let mut v = Vector3::from_fn(|_, _| random.number());
    v.x = -v.x.abs();
    let e = [0.0, 1.0, random.between(0.0, 1.0)][random.below(3)];
    let law = Law::ALL[random.below(Law::ALL.len())];
    (ReducedMatrix::from(b * b.transpose()), v, Surface { mu: random.between(0.0, 2.0), e, law })
}

/// Ranks 1 to 3, friction and slip over the range of doubles.
fn extreme(random: &mut Random) -> Collision {
    let case = contact(random, f64::EPSILON, 300.0);
    (case.m.into(), case.v.into(), Surface { mu: case.mu, e: case.e, law: case.law })
}

/// Slip that is tiny or fast, friction next to mu_c, directions next to those that slip keeps.
fn delicate(random: &mut Random) -> Collision {
    let (m, mut v, mut surface) = usual(random);
    let rates = hodograph::Characteristics::of(&m, surface.mu);
    match random.below(4) {
        0 => (v.y, v.z) = (v.y * random.power(9.0), v.z * random.power(9.0)),
        1 => {
            surface.mu =
                rates.mu_c * (1.0 + random.number() * 10.0_f64.powf(-12.0 * random.between(0.0, 1.0)))
        }
        2 => surface.e = 10.0_f64.powf(-20.0 * random.between(0.0, 1.0)),
        _ => {
            let directions: Vec<f64> =
                hodograph::invariant_directions(&m, surface.mu).into_iter().flatten().collect();
            if let Some(angle) = directions.get(random.below(directions.len().max(1))) {
                let angle = angle + random.number() * 10.0_f64.powf(-17.0 * random.between(0.0, 1.0));
                let slip = v.yz().norm();
                (v.y, v.z) = (slip * angle.cos(), slip * angle.sin());
            }
        }
    }
    if surface.mu.is_finite() { (m, v, surface) } else { usual(random) }
}

#[test]
fn usual_collisions() {
    let mut random = Random::new(301);
    compare(&(0..20_000).map(|_| usual(&mut random)).collect::<Vec<_>>());
}

#[test]
fn extreme_collisions() {
    let mut random = Random::new(302);
    compare(&(0..8_000).map(|_| extreme(&mut random)).collect::<Vec<_>>());
}

#[test]
fn delicate_collisions() {
    let mut random = Random::new(303);
    compare(&(0..12_000).map(|_| delicate(&mut random)).collect::<Vec<_>>());
}

#[test]
fn the_reference_collisions() {
    let cases = reference_cases();
    compare(&cases.iter().map(|case| (case.matrix, case.approach, case.surface)).collect::<Vec<_>>());
}

/// What is wrong with one input does not touch its neighbours, in whichever lane it comes.
#[test]
fn errors_stay_in_their_lane() {
    let mut random = Random::new(304);
    let mut collisions: Vec<Collision> = (0..2_000).map(|_| usual(&mut random)).collect();
    for (place, (m, v, surface)) in collisions.iter_mut().enumerate() {
        match place % 11 {
            0 => v.y = f64::NAN,
            2 => surface.mu = -0.5,
            3 => surface.e = 1.5,
            4 => v.x = 0.0,
            5 => m.nt = 3.0 * m.nn.max(m.tt),
            6 => v.x = f64::NEG_INFINITY,
            7 => m.nn = 0.0,
            8 => (v.y, v.z) = (0.0, 0.0),
            9 => surface.mu = f64::INFINITY,
            _ => {}
        }
    }
    let refused = collisions.iter().filter(|(m, v, surface)| solve(m, v, surface).is_err()).count();
    assert!(refused > 1_200, "{refused}");
    compare(&collisions);
}

/// From none to more than are in work at a time: those that are left over at the end are answered too.
#[test]
fn any_number_of_collisions() {
    let mut random = Random::new(305);
    for count in (0..20).chain([31, 32, 33, 63, 64, 65, 100, 257]) {
        let mut mixed =
            |place: usize| if place.is_multiple_of(3) { extreme(&mut random) } else { usual(&mut random) };
        compare(&(0..count).map(&mut mixed).collect::<Vec<_>>());
    }
}
