//! Finds the contact that jams where no forces obey the laws.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector};

use super::{
    Mode, Problem, Solution,
    certified::{ACCEPTED, attempt},
    enumerate::enumerate,
    prescribed::{Wanted, prescribed},
    problem::three,
};

/// f / W_nn up to this counts as not positive.
const JAMS: f64 = 1e-6;

/// A sliding contact whose f is not positive, and that f: by itself, or else while the others keep the modes
/// that they have without it, if it approaches then.
pub(super) fn jam(problem: &Problem<'_>) -> Option<(usize, f64)> {
    let sliding = (0..problem.contacts()).filter(|&i| problem.slip[i].is_some());
    let normal = |i: usize| problem.w[(3 * i, 3 * i)];
    let own = sliding.clone().filter_map(|i| own_f(problem, i).map(|f| (i, f)));
    own.filter(|&(i, f)| f <= JAMS * normal(i))
        .min_by(|(i, one), (j, other)| (one / normal(*i)).total_cmp(&(other / normal(*j))))
        .or_else(|| sliding.filter_map(|i| f_with_others(problem, i).map(|f| (i, f))).next())
}

/// f of a sliding contact by itself.
fn own_f(problem: &Problem<'_>, i: usize) -> Option<f64> {
    let d = problem.slip[i]?;
    let row = 3 * i;
    Some(
        problem.w[(row, row)]
            - problem.mu[i] * (problem.w[(row, row + 1)] * d.x + problem.w[(row, row + 2)] * d.y),
    )
}

/// f of a sliding contact while the others keep their modes of the motion without it, if the contact
/// approaches in that motion and f is not positive.
fn f_with_others(problem: &Problem<'_>, i: usize) -> Option<f64> {
    let kept: Vec<usize> = (0..problem.contacts()).filter(|&other| other != i).collect();
    let rows: Vec<usize> = kept.iter().flat_map(|&other| 3 * other..3 * other + 3).collect();
    let (w, beta) = (
        DMatrix::from_fn(rows.len(), rows.len(), |a, b| problem.w[(rows[a], rows[b])]),
        DVector::from_fn(rows.len(), |a, _| problem.beta[rows[a]]),
    );
    let noise = problem.noise.map(|noise| DVector::from_fn(rows.len(), |a, _| noise[rows[a]]));
    let (mu, slip): (Vec<_>, Vec<_>) =
        kept.iter().map(|&other| (problem.mu[other], problem.slip[other])).unzip();
    let rest = Problem { w: &w, beta: &beta, mu: &mu, slip: &slip, noise: noise.as_ref() };
    let Solution { force, modes: others, .. } =
        attempt(&rest, None).ok().or_else(|| enumerate(&rest).into_iter().next())?;
    let (mut approach, mut terms) = (problem.beta[3 * i], problem.beta[3 * i].abs());
    for (&row, force) in rows.iter().zip(force.iter()) {
        let part = problem.w[(3 * i, row)] * force;
        approach += part;
        terms += part.abs();
    }
    // Rounding is no approach.
    if approach >= -(ACCEPTED * terms + problem.noise(3 * i)) {
        return None;
    }
    let mut modes = others;
    modes.insert(i, Mode::Slide(problem.slip[i]?));
    // How much the contact accelerates with its own force, beside the forces of the others that change with it.
    let pressed = prescribed(problem, &modes, None, Wanted::Any).ok()?;
    let own = three(&pressed.force, i).x;
    (own < 0.0).then(|| -approach / own)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::contact_problem::solve;

    /// Four joints of a chain stick to a floor, and its tip slides past the last of them, above which two links stand
    /// upright. Beside that joint friction draws the tip down faster than its normal force lifts it.
    #[test]
    fn a_contact_jams_beside_others_that_stick() {
        // n of all, then the tangent that the joints share, then that of the tip.
        let normals = [
            [
                34.621_848_739_668,
                -9.243_697_479_335,
                2.352_941_177_673,
                -0.168_067_231_358,
                -0.168_067_219_780,
            ],
            [
                -9.243_697_479_335,
                18.487_394_958_670,
                -4.705_882_355_347,
                0.336_134_462_716,
                0.336_134_439_559,
            ],
            [
                2.352_941_177_673,
                -4.705_882_355_347,
                16.470_588_243_713,
                -1.176_470_619_507,
                -1.176_470_538_458,
            ],
            [-0.168_067_231_358, 0.336_134_462_716, -1.176_470_619_507, 4.369_748_015_313, 4.369_747_714_273],
            [-0.168_067_219_780, 0.336_134_439_559, -1.176_470_538_458, 4.369_747_714_273, 4.369_748_234_072],
        ];
        let shared =
            [-8.216_177_76e-6, 1.643_235_552e-5, -5.751_324_433e-5, 2.136_206_218e-4, -1.774_694_371e-4];
        let tip =
            [-4.436_735_942e-5, 8.873_471_883e-5, -3.105_715_159e-4, 1.153_551_345e-3, -2.757_349_238e-3];
        let tangents = [3.043_478_256_655, 0.434_782_577_141, 34.347_825_761_190];
        let w = DMatrix::from_fn(15, 15, |a, b| match (a % 3, b % 3) {
            (0, 0) => normals[a / 3][b / 3],
            (0, 1) => {
                if b == 13 {
                    tip[a / 3]
                } else {
                    shared[a / 3]
                }
            }
            (1, 0) => {
                if a == 13 {
                    tip[b / 3]
                } else {
                    shared[b / 3]
                }
            }
            (1, 1) => tangents[usize::from(a == 13) + usize::from(b == 13)],
            _ => 0.0,
        });
        let pulled = [
            -9.824_226_144_521,
            -9.781_547_710_958,
            -9.909_583_011_648,
            -9.440_120_242_449,
            -9.440_120_699_722,
        ];
        let beta = DVector::from_fn(15, |row, _| match row % 3 {
            0 => pulled[row / 3],
            1 => {
                if row == 13 {
                    3.848_188_909e-6
                } else {
                    -3.987_323_3e-6
                }
            }
            _ => 0.0,
        });
        let (mu, slip) = ([0.443; 5], [None, None, None, None, Some(Vector2::new(-1.0, 0.0))]);
        let problem = Problem { w: &w, beta: &beta, mu: &mu, slip: &slip, noise: None };
        assert!(own_f(&problem, 4).unwrap() > 4.0);
        assert!(matches!(jam(&problem), Some((4, f)) if f < -1e-4), "{:?}", jam(&problem));
        // One motion is left, in which that joint opens: not Newton's method, but the choice of contacts that press finds it.
        let solved = solve(&problem, None).unwrap();
        assert!(solved.modes[3] == Mode::Separate && solved.force[12] > 2.0, "{:?}", solved.modes);
        // Without friction there is no jam.
        assert!(solve(&Problem { mu: &[0.0; 5], ..problem }, None).is_ok());
    }
}
