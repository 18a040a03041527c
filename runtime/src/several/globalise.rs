//! The ways in which forces of several contacts are looked for, one after the other, until a certificate
//! accepts them.
//!
//! Theory: docs/theory.md, section 17.10.

use super::{
    Certificate, SeveralContacts,
    certificate::certificate,
    dense::NewtonSteps,
    law::allowed,
    newton::{Run, Vectors, newton},
    scaled::{Scaled, three},
};
use crate::{
    Scalar,
    scalar::{constant, larger},
};

/// Why no forces were found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Unfound<T> {
    /// The slices do not have the lengths that k contacts need.
    Lengths,
    /// A number is not finite, a coefficient of friction is negative, or a diagonal entry of W is.
    Input {
        /// The contact at fault.
        contact: usize,
    },
    /// All ways ended without forces that the certificate accepts.
    NotFound {
        /// The least violation that was reached.
        violation: T,
    },
}

/// The numbers of memory that [`solve_several`] needs for k contacts.
pub const fn memory_of_several(k: usize) -> usize {
    let n = 3 * k;
    n * n + 12 * n + k
}

/// Forces and accelerations of k contacts; `force` holds a first guess, or zeros.
///
/// `steps` solves linear systems: [`super::Dense`] is for few contacts. `memory` has at least
/// [`memory_of_several`] numbers. At most 7000 steps of Newton's method are made; usual are 5 to 30.
///
/// # Errors
/// See [`Unfound`]. Forces whose certificate is above 4096 eps (9e-13) are never returned as an answer; with
/// [`Unfound::NotFound`] `force` holds those with the least violation, if any were near.
pub fn solve_several<T: Scalar, S: NewtonSteps<T>>(
    problem: &SeveralContacts<'_, T>,
    force: &mut [T],
    acceleration: &mut [T],
    memory: &mut [T],
    steps: &mut S,
) -> Result<Certificate<T>, Unfound<T>> {
    let k = problem.mu.len();
    let n = 3 * k;
    check(problem)?;
    if force.len() != n || acceleration.len() != n || memory.len() < memory_of_several(k) {
        return Err(Unfound::Lengths);
    }
    if k == 0 {
        return Ok(Certificate::none());
    }
    let (scale, memory) = memory.split_at_mut(k);
    let (matrix, memory) = memory.split_at_mut(n * n);
    let (beta, memory) = memory.split_at_mut(n);
    let (terms, memory) = memory.split_at_mut(n);
    let (start, memory) = memory.split_at_mut(n);
    let (nearest, memory) = memory.split_at_mut(n);
    let mut parts = memory.chunks_exact_mut(n);
    let mut part = || parts.next().unwrap_or_default();
    let vectors = Vectors {
        x: part(),
        v: part(),
        f: part(),
        trial: part(),
        trial_v: part(),
        step: part(),
        centre: part(),
        best: part(),
    };
    let scaled = Scaled::new(problem, scale, matrix, beta);
    for (i, (start, force)) in start.iter_mut().zip(force.iter()).enumerate() {
        let given = *force / (scaled.scale[i / 3] * scaled.unit);
        *start = if given.is_finite() { given } else { T::zero() };
    }
    let mut search = Search { scaled, vectors, terms, start, nearest, least: None };
    let found = search.run(steps);
    let least = search.least.unwrap_or(T::max_value().unwrap_or(T::one()));
    let Search { scaled, vectors, nearest, .. } = search;
    let Some(found) = found else {
        for (i, (force, nearest)) in force.iter_mut().zip(nearest.iter()).enumerate() {
            let there = *nearest * scaled.scale[i / 3] * scaled.unit;
            *force = if there.is_finite() { there } else { T::zero() };
        }
        return Err(Unfound::NotFound { violation: least });
    };
    scaled.rates(vectors.best, vectors.v);
    for i in 0..n {
        let scale = scaled.scale[i / 3];
        force[i] = vectors.best[i] * scale * scaled.unit;
        acceleration[i] = vectors.v[i] * scaled.unit / scale;
    }
    if !force.iter().chain(acceleration.iter()).all(|number| number.is_finite()) {
        // In these units the answer has no numbers.
        force.fill(T::zero());
        acceleration.fill(T::zero());
        return Err(Unfound::NotFound { violation: least });
    }
    Ok(found)
}

/// The certificate of given forces; `memory` as for [`solve_several`].
///
/// # Errors
/// [`Unfound::Lengths`] and [`Unfound::Input`].
pub fn certify<T: Scalar>(
    problem: &SeveralContacts<'_, T>,
    force: &[T],
    memory: &mut [T],
) -> Result<Certificate<T>, Unfound<T>> {
    let k = problem.mu.len();
    let n = 3 * k;
    check(problem)?;
    if force.len() != n || memory.len() < memory_of_several(k) {
        return Err(Unfound::Lengths);
    }
    if k == 0 {
        return Ok(Certificate::none());
    }
    let (scale, memory) = memory.split_at_mut(k);
    let (matrix, memory) = memory.split_at_mut(n * n);
    let (beta, memory) = memory.split_at_mut(n);
    let (terms, memory) = memory.split_at_mut(n);
    let (x, memory) = memory.split_at_mut(n);
    let (v, _) = memory.split_at_mut(n);
    let scaled = Scaled::new(problem, scale, matrix, beta);
    for (i, (x, force)) in x.iter_mut().zip(force).enumerate() {
        *x = *force / (scaled.scale[i / 3] * scaled.unit);
    }
    scaled.rates(x, v);
    scaled.terms(x, terms);
    Ok(certificate(&scaled, x, v, terms))
}

fn check<T: Scalar>(problem: &SeveralContacts<'_, T>) -> Result<(), Unfound<T>> {
    let n = 3 * problem.mu.len();
    if problem.slip.len() * 3 != n || problem.beta.len() != n || problem.matrix.len() != n * n {
        return Err(Unfound::Lengths);
    }
    for (i, mu) in problem.mu.iter().enumerate() {
        let finite = |values: &[T]| values.iter().all(|value| value.is_finite());
        let slip = problem.slip[i].is_none_or(|d| d.x.is_finite() && d.y.is_finite());
        let columns = 3 * i * n..3 * (i + 1) * n;
        let good = mu.is_finite()
            && *mu >= T::zero()
            && slip
            && finite(&problem.beta[3 * i..3 * i + 3])
            && finite(&problem.matrix[columns])
            && (3 * i..3 * i + 3).all(|row| problem.matrix[row * n + row] >= T::zero());
        if !good {
            return Err(Unfound::Input { contact: i });
        }
    }
    Ok(())
}

struct Search<'a, T: Scalar> {
    scaled: Scaled<'a, T>,
    vectors: Vectors<'a, T>,
    terms: &'a mut [T],
    start: &'a mut [T],
    /// The forces with the least violation so far.
    nearest: &'a mut [T],
    /// Their violation.
    least: Option<T>,
}

impl<T: Scalar> Search<'_, T> {
    /// The certificate of the first forces that are accepted; they are in `best`.
    fn run<S: NewtonSteps<T>>(&mut self, steps: &mut S) -> Option<Certificate<T>> {
        let [one, few] = [T::one(), constant::<T>(0.2)];
        for rho in [one, few, constant(5.0)] {
            self.vectors.x.copy_from_slice(self.start);
            if let Some(found) = self.attempt(rho, FIRST, steps) {
                return Some(found);
            }
        }
        // A proximal term, lowered threefold.
        for restart in 0..3 {
            let mut alpha = constant::<T>([1.0, 10.0, 0.1][restart]);
            if restart == 0 {
                self.vectors.x.copy_from_slice(self.start);
            } else {
                self.vectors.x.iter_mut().for_each(|x| *x = T::zero());
            }
            for round in 0..PROXIMAL {
                self.proximal(alpha, steps);
                alpha /= constant(3.0);
                if round % 4 == 3 {
                    self.vectors.trial_v.copy_from_slice(self.vectors.x);
                    self.vectors.centre.copy_from_slice(self.vectors.x);
                    if let Some(found) = self.attempt(one, SHORT, steps) {
                        return Some(found);
                    }
                    self.vectors.x.copy_from_slice(self.vectors.centre);
                }
            }
        }
        // Continuation in friction.
        for count in [8_u32, 32] {
            self.vectors.x.iter_mut().for_each(|x| *x = T::zero());
            for i in 0..=count {
                self.scaled.friction = constant::<T>(f64::from(i) / f64::from(count));
                self.proximal(constant(1e-2), steps);
                let run = Run { rho: one, alpha: T::zero(), steps: SHORT, enough: constant(1e-8) };
                newton(&self.scaled, &run, &mut self.vectors, steps);
            }
            self.scaled.friction = one;
            if let Some(found) = self.attempt(one, FIRST, steps) {
                return Some(found);
            }
        }
        // From elsewhere: numbers that look random.
        let mut seed = 0x2545_f491_u32;
        for start in 0..STARTS {
            for i in 0..self.vectors.x.len() {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let number = constant::<T>(f64::from(seed >> 8) / f64::from(1 << 24));
                let wanted =
                    if i % 3 == 0 { number } else { (number - constant(0.5)) * self.scaled.law(i / 3).mu };
                self.vectors.x[i] = wanted * constant(3.0);
            }
            // The equations with another parameter end in other cycles, if any.
            let rho = constant([1.0, 0.3, 3.0, 0.1, 10.0][start % 5]);
            if let Some(found) = self.attempt(rho, FIRST, steps) {
                return Some(found);
            }
        }
        None
    }

    /// One solution with the proximal term at the present forces.
    fn proximal<S: NewtonSteps<T>>(&mut self, alpha: T, steps: &mut S) {
        self.vectors.centre.copy_from_slice(self.vectors.x);
        let run = Run { rho: T::one(), alpha, steps: SHORT, enough: constant(1e-10) };
        newton(&self.scaled, &run, &mut self.vectors, steps);
    }

    /// Newton's method from the present forces, and the certificate where it accepts them.
    fn attempt<S: NewtonSteps<T>>(&mut self, rho: T, count: usize, steps: &mut S) -> Option<Certificate<T>> {
        let run = Run { rho, alpha: T::zero(), steps: count, enough: T::default_epsilon() };
        let size = newton(&self.scaled, &run, &mut self.vectors, steps);
        let close = larger(constant(1e-6), constant::<T>(64.0) * T::default_epsilon())
            * larger(T::one(), self.scaled.size(self.vectors.x));
        if !size.is_finite() || size > close {
            return None;
        }
        let Vectors { x, v, best, .. } = &mut self.vectors;
        for i in 0..self.scaled.contacts() {
            let force = allowed(&self.scaled.law(i), rho, &three(x, i), &three(v, i));
            best[3 * i..3 * i + 3].copy_from_slice(force.as_slice());
        }
        self.scaled.rates(best, v);
        self.scaled.terms(best, self.terms);
        let found = certificate(&self.scaled, best, v, self.terms);
        let greatest = found.greatest();
        if self.least.is_none_or(|least| greatest < least) {
            self.least = Some(greatest);
            self.nearest.copy_from_slice(best);
        }
        (greatest <= constant::<T>(ACCEPTED) * T::default_epsilon()).then_some(found)
    }
}

/// A certificate is accepted up to this many eps.
const ACCEPTED: f64 = 4096.0;

/// Steps of a first attempt, and of the solutions on a path.
const FIRST: usize = 60;
const SHORT: usize = 25;

/// Proximal terms.
const PROXIMAL: usize = 20;

/// Random starts.
const STARTS: usize = 40;
