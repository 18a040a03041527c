//! Restitution too small to change a sum, and speeds beyond the range of their ratio: an outcome that obeys
//! its law, or an error that names the number at fault.

use crate::common::random::Random;
use hodograph::structure::{Balanced, Diagonal, Isotropic, Planar, solve_structured};
use hodograph::{Impact, ImpactError, Law, ReducedMatrix, Surface, solve};
use nalgebra::{Matrix3, Vector3};

/// Restitution below the rounding unit is still restitution: compression ends, v_n2 is not negative, and
/// Newton's law gives e times the speed of approach, to the last digits.
#[test]
fn tiny_restitution_obeys_its_law() {
    let mut random = Random::new(61);
    let mut newton = 0;
    for _ in 0..400 {
        let b = Matrix3::from_fn(|_, _| random.number());
        let mut v = b * Vector3::from_fn(|_, _| random.number());
        v.x = -v.x.abs();
        let m = ReducedMatrix::from(b * b.transpose());
        let mu = random.between(0.0, 1.5);
        if v.x > -1e-3 * v.norm() || m.nn < 1e-2 * m.tt.max(m.ss) {
            continue;
        }
        for e in [1e-15, 1e-17, 1e-20, 1e-40, 1e-300] {
            for &law in Law::ALL {
                let surface = Surface { mu, e, law };
                let planar = ReducedMatrix { ns: 0.0, ts: 0.0, ..m };
                let balanced = ReducedMatrix { nt: 0.0, ns: 0.0, ..m };
                let diagonal = ReducedMatrix { ts: 0.0, ..balanced };
                let isotropic = ReducedMatrix { tt: m.tt.max(m.ss), ts: 0.0, ss: m.tt.max(m.ss), ..m };
                let within = Vector3::new(v.x, v.y, 0.0);
                let answers: [Result<Impact<f64>, ImpactError<f64>>; 5] = [
                    solve(&m, &v, &surface),
                    solve_structured::<Planar, _>(&planar, &within, &surface),
                    solve_structured::<Balanced, _>(&balanced, &v, &surface),
                    solve_structured::<Diagonal, _>(&diagonal, &v, &surface),
                    solve_structured::<Isotropic, _>(&isotropic, &v, &surface),
                ];
                for hit in answers.into_iter().flatten() {
                    let what = format!("{law:?} e = {e:e} mu = {mu} {m:?} {v:?}\n{hit:?}");
                    assert!(hit.velocity.x >= 0.0 && hit.compressions > 0, "{what}");
                    if law == Law::Newton {
                        let expected = e * -v.x;
                        let error = (hit.velocity.x - expected).abs();
                        assert!(error <= 8.0 * f64::EPSILON * expected, "{what}");
                        newton += 1;
                    }
                }
            }
        }
    }
    assert_eq!(newton, 9770);
}

/// A speed of approach so small beside slip that their ratio is beyond the range: the error names it, and
/// does not blame friction.
#[test]
fn approaches_beyond_the_range_are_named() {
    let m = ReducedMatrix::new(0.25, -0.125, 0.0, 0.5, 0.0, 0.5);
    for &law in Law::ALL {
        for (normal, slip) in [(-1e-320, 0.5), (-5e-324, 1.0), (-1e-300, 1e10), (-1e-10, 1e300)] {
            let surface = Surface { mu: 0.5, e: 0.5, law };
            let answer = solve(&m, &Vector3::new(normal, slip, 0.0), &surface);
            match answer {
                Err(ImpactError::NotFinite { value }) => assert_eq!(value, normal, "{law:?}"),
                other => panic!("{law:?} {normal:e} {slip:e}: {other:?}"),
            }
        }
    }
    let message = ImpactError::NotFinite { value: -1e-320 }.to_string();
    assert!(message.contains("-1e-320"), "{message}");
}
