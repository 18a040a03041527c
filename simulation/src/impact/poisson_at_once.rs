//! Poisson's hypothesis for several contacts at once, in two phases, after Glocker and Pfeiffer.
//!
//! Compression ends with impulses p_C that stop every approach: v_C = v- + W p_C with p_Cn >= 0, v_Cn >= 0,
//! one of them zero, and Coulomb friction against the slip at its end. Expansion gives each contact the
//! normal impulse e p_Cn, or more if it would approach: v+ = v_C + W p_E with p_En >= e p_Cn, v+_n >= 0, one
//! of them with equality, and friction abs(p_Et) <= mu p_En against the remaining slip (docs/theory.md,
//! section 17.13).

use nalgebra::{DMatrix, DVector, Vector2};

use crate::closed::closed_contacts::ClosedContacts;
use crate::contact_problem::{self, Problem, Unsolved};

/// The impulses of both phases together.
pub(crate) fn impulses(support: &ClosedContacts, mu: &[f64], e: &[f64]) -> Result<DVector<f64>, Unsolved> {
    let w = &support.coupled;
    let compression = solved(w, &support.velocity, mu)?;
    let given: Vec<f64> = e.iter().enumerate().map(|(i, e)| e * compression[3 * i]).collect();
    if given.iter().all(|&impulse| impulse == 0.0) {
        return Ok(compression);
    }
    let velocity = w * &compression + &support.velocity;
    Ok(compression + expansion(w, &velocity, mu, &given)?)
}

/// The impulses of expansion, for given least normal impulses of the contacts.
///
/// Friction is that of the whole normal impulse. So a contact is represented by two: one with the additional
/// normal impulse, and one with the given normal impulse, independent of the motion (its normal row of W is
/// coupled with nothing). Both slip with the same velocity, so that their friction adds up to that of one
/// contact with both impulses.
fn expansion(
    w: &DMatrix<f64>,
    velocity: &DVector<f64>,
    mu: &[f64],
    given: &[f64],
) -> Result<DVector<f64>, Unsolved> {
    let k = mu.len();
    let rubs: Vec<usize> = (0..k).filter(|&i| given[i] > 0.0 && mu[i] > 0.0).collect();
    let places: Vec<usize> = (0..k).chain(rubs.iter().copied()).collect();
    let row = |a: usize| 3 * places[a / 3] + a % 3;
    let apart = |a: usize| a / 3 >= k && a.is_multiple_of(3);
    let n = 3 * places.len();
    let twice =
        DMatrix::from_fn(
            n,
            n,
            |a, b| {
                if a != b && (apart(a) || apart(b)) { 0.0 } else { w[(row(a), row(b))] }
            },
        );
    let mut begin = velocity.clone();
    for (i, impulse) in given.iter().enumerate() {
        begin += w.column(3 * i) * *impulse;
    }
    let start = DVector::from_fn(n, |a, _| {
        if apart(a) { -w[(row(a), row(a))] * given[places[a / 3]] } else { begin[row(a)] }
    });
    let friction: Vec<f64> = places.iter().map(|&i| mu[i]).collect();
    let found = solved(&twice, &start, &friction)?;
    let mut impulse = DVector::zeros(3 * k);
    for (i, given) in given.iter().enumerate() {
        impulse[3 * i] = *given;
    }
    for a in (0..n).filter(|&a| !apart(a)) {
        impulse[row(a)] += found[a];
    }
    Ok(impulse)
}

/// Impulses without restitution under which no contact approaches, with friction against the remaining slip.
fn solved(w: &DMatrix<f64>, velocity: &DVector<f64>, mu: &[f64]) -> Result<DVector<f64>, Unsolved> {
    let none: Vec<Option<Vector2<f64>>> = vec![None; mu.len()];
    let problem = Problem { w, beta: velocity, mu, slip: &none, noise: None };
    Ok(contact_problem::solve(&problem, None)?.force)
}
