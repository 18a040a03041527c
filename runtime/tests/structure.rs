//! Every structure gives what the general solver gives.

use hodograph::{
    Impact, ImpactError, Law, ReducedMatrix, Surface, solve,
    structure::{Balanced, Diagonal, Frictionless, General, Isotropic, Planar, Structure, solve_structured},
};
use nalgebra::{Matrix3, Vector3};

/// A small deterministic source of numbers in [-1, 1].
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn compare(
    one: &Result<Impact<f64>, ImpactError<f64>>,
    other: &Result<Impact<f64>, ImpactError<f64>>,
    approach: f64,
) {
    let (Ok(a), Ok(b)) = (one, other) else {
        let kind = |r: &Result<_, ImpactError<f64>>| r.as_ref().err().map(ImpactError::kind);
        assert_eq!(kind(one), kind(other));
        return;
    };
    assert_eq!((a.path, a.compressions), (b.path, b.compressions));
    let (impulse, speed) = (a.impulse.amax(), approach + a.velocity.amax());
    assert!((a.impulse - b.impulse).amax() <= 1e-13 * impulse, "{a:?} {b:?}");
    assert!((a.velocity - b.velocity).amax() <= 1e-13 * speed, "{a:?} {b:?}");
    assert!((a.contact_work - b.contact_work).abs() <= 1e-13 * impulse * speed);
    assert!((a.normal_work - b.normal_work).abs() <= 1e-13 * impulse * speed);
}

/// Over random contacts of every rank; `shape` makes them of the structure.
fn agree<S: Structure>(shape: impl Fn(&mut ReducedMatrix<f64>, &mut Vector3<f64>, &mut Surface<f64>)) {
    let mut random = Random(11);
    let mut paths = std::collections::HashSet::new();
    for n in 0..1500 {
        let rank = 1 + n % 3;
        let a = Matrix3::from_fn(|_, j| if j < rank { random.next() } else { 0.0 });
        let mut m = ReducedMatrix::from(a * a.transpose());
        let slip = if n % 10 == 0 { 0.0 } else { random.next() };
        let mut v = Vector3::new(-0.1 - random.next().abs(), slip, slip * random.next());
        let e = [0.0, 1.0, 0.5 + 0.5 * random.next()][(n / 3) % 3];
        let law = [Law::Newton, Law::Poisson, Law::Stronge][(n / 9) % 3];
        let mut surface = Surface { mu: 3.0 * random.next().abs().powi(2), e, law };
        shape(&mut m, &mut v, &mut surface);
        let general = solve(&m, &v, &surface);
        let structured = solve_structured::<S, f64>(&m, &v, &surface);
        paths.insert(match &general {
            Ok(hit) => hit.path.phases().join("+"),
            Err(error) => error.kind().to_owned(),
        });
        compare(&general, &structured, v.amax());
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
