//! The solver as a part of its caller, under a law that is known while compiling, gives the bits of the
//! shared one: every outcome and every error, with signs of zeros.

use std::collections::HashSet;
use std::fmt::Debug;

use hodograph::generated::{AnyLaw, KnownLaw, OneLaw, solve_inlined};
use hodograph::structure::{
    Balanced, Diagonal, Frictionless, General, Isotropic, Planar, Structure, solve_structured,
};
use hodograph::{ContactSurface, Impact, ImpactError, Law, ReducedMatrix, Scalar, Surface, solve};
use nalgebra::{Matrix3, Vector3};

use crate::common::random::Random;
use crate::common::reference_cases;

type Answer<T> = Result<Impact<T>, ImpactError<T>>;

fn inlined<S: Structure, T: Scalar>(
    m: &ReducedMatrix<T>,
    v: &Vector3<T>,
    surface: &impl ContactSurface<T>,
) -> Answer<T> {
    fn under<S: Structure, L: KnownLaw, T: Scalar>(
        m: &ReducedMatrix<T>,
        v: &Vector3<T>,
        surface: &impl ContactSurface<T>,
    ) -> Answer<T> {
        solve_inlined::<S, L, T>(m, v, surface)
    }
    let known = match surface.surface().law.number() {
        0 => under::<S, OneLaw<0>, T>(m, v, surface),
        1 => under::<S, OneLaw<1>, T>(m, v, surface),
        2 => under::<S, OneLaw<2>, T>(m, v, surface),
        _ => panic!("a law that this test leaves out"),
    };
    let any = under::<S, AnyLaw, T>(m, v, surface);
    same(&known, &any);
    known
}

/// The same bits: `Debug` prints the shortest digits that give a number back, and the sign of zero.
fn same<T: Debug + Scalar>(one: &Answer<T>, other: &Answer<T>) {
    let (one, other) = (format!("{one:?}"), format!("{other:?}"));
    assert_eq!(one, other);
}

/// Contacts of every rank, and surfaces; many of them hard.
fn contacts(count: usize) -> impl Iterator<Item = (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>)> {
    let mut random = Random::new(23);
    (0..count).map(move |n| {
        let rank = 1 + n % 3;
        let a = Matrix3::from_fn(|_, j| if j < rank { random.number() } else { 0.0 });
        let mut m = ReducedMatrix::from(a * a.transpose());
        let slip = if n % 10 == 0 { 0.0 } else { random.number() };
        let mut v = Vector3::new(-0.1 - random.number().abs(), slip, slip * random.number());
        let e = [0.0, 1.0, 0.5 + 0.5 * random.number()][(n / 3) % 3];
        let law = Law::ALL[(n / 9) % Law::ALL.len()];
        let mut surface = Surface { mu: 3.0 * random.number().abs().powi(2), e, law };
        match n % 17 {
            1 => (v.y, v.z) = (v.y * 1e4, v.z * 1e4),
            2 => (v.y, v.z) = (v.y * 1e-5, v.z * 1e-5),
            3 => v.z *= 1e-7,
            4 => v.y *= 1e-12,
            5 => (m.ss, m.ts) = (m.tt * (1.0 + 1e-13), 0.0),
            6 => (m.ss, m.ts, m.nt, m.ns) = (m.tt * (1.0 - 1e-6), 0.0, 0.5 * m.nt, 0.5 * m.ns),
            7 => surface.mu *= 30.0,
            // rates that need other units, friction that is limited, slip whose square overflows
            8 => surface.mu = 1e60,
            9 => surface.mu = 1e200,
            10 => (v.x, v.y, v.z) = (v.x * 1e200, v.y * 1e200, v.z * 1e200),
            11 => v.x *= 1e-200,
            // slip along an invariant direction
            12 => (m.ns, m.ts, v.z) = (0.0, 0.0, 0.0),
            13 => (m.ns, m.ts, v.z) = (1e-13 * m.ns, 1e-13 * m.ts, 1e-13 * v.z),
            // what is refused
            14 if n % 2 == 0 => surface.mu = -0.1,
            14 => surface.e = 1.5,
            15 if n % 3 == 0 => v.x = 0.1,
            15 if n % 3 == 1 => m.nn = -m.nn,
            15 => v.y = f64::NAN,
            _ => {}
        }
        (m, v, surface)
    })
}

#[test]
fn the_bits_of_the_shared_solver() {
    let (mut paths, mut errors) = (HashSet::new(), HashSet::new());
    for (m, v, surface) in contacts(6000) {
        let answer = solve(&m, &v, &surface);
        same(&inlined::<General, f64>(&m, &v, &surface), &answer);
        match answer {
            Ok(hit) => paths.insert(hit.path.phases().join(" ")),
            Err(error) => errors.insert(error.kind().to_owned()),
        };
    }
    assert!(paths.len() == 5 && errors.len() >= 7, "{paths:?} {errors:?}");
}

#[test]
fn within_every_budget() {
    let mut exceeded = 0;
    for (m, v, surface) in contacts(1000) {
        for budget in [0, 1, 2, 5] {
            let surface = surface.with_budget(budget);
            let answer = solve(&m, &v, &surface);
            same(&inlined::<General, f64>(&m, &v, &surface), &answer);
            exceeded += u32::from(matches!(answer, Err(ImpactError::BudgetExceeded { .. })));
        }
    }
    assert_eq!(exceeded, 1475);
}

#[test]
fn the_bits_of_every_structure() {
    fn all<S: Structure>() {
        for (m, v, surface) in contacts(2000) {
            same(&inlined::<S, f64>(&m, &v, &surface), &solve_structured::<S, f64>(&m, &v, &surface));
        }
    }
    all::<General>();
    all::<Planar>();
    all::<Balanced>();
    all::<Diagonal>();
    all::<Isotropic>();
    all::<Frictionless>();
}

#[test]
fn singles_and_reference_collisions() {
    let mut twice = 0;
    for case in reference_cases() {
        let answer = solve(&case.matrix, &case.approach, &case.surface);
        same(&inlined::<General, f64>(&case.matrix, &case.approach, &case.surface), &answer);
        twice += u32::from(answer.is_ok_and(|hit| hit.compressions > 1));
    }
    assert!(twice > 0, "no collision with two compressions");
    for (m, v, surface) in contacts(3000) {
        let [nn, nt, ns, tt, ts, ss] = <[f64; 6]>::from(m).map(|x| x as f32);
        let (m, v) = (ReducedMatrix::new(nn, nt, ns, tt, ts, ss), v.map(|x| x as f32));
        let surface = Surface { mu: surface.mu as f32, e: surface.e as f32, law: surface.law };
        same(&inlined::<General, f32>(&m, &v, &surface), &solve(&m, &v, &surface));
        same(&inlined::<Planar, f32>(&m, &v, &surface), &solve_structured::<Planar, f32>(&m, &v, &surface));
    }
}
