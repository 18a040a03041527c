//! Builds sums, products and quotients of terms in the form in which a person would write them.

use super::{Term, product};

/// The number 0.
pub const ZERO: Term = Term::Number(0.0);

const ONE: Term = Term::Number(1.0);

/// The negative of a term.
pub fn neg(a: Term) -> Term {
    match a {
        Term::Neg(a) => *a,
        Term::Number(number) => Term::Number(if number == 0.0 { 0.0 } else { -number }),
        Term::Sum(terms) => Term::Sum(terms.into_iter().map(neg).collect()),
        other => Term::Neg(Box::new(other)),
    }
}

/// The sum, with like terms collected.
pub fn sum(a: Term, b: Term) -> Term {
    let mut terms: Vec<(f64, Term)> = parts(a).into_iter().map(coefficient).collect();
    for (number, base) in parts(b).into_iter().map(coefficient) {
        match terms.iter_mut().find(|(_, known)| *known == base) {
            Some((sum, _)) => *sum += number,
            None => terms.push((number, base)),
        }
    }
    terms.retain(|(number, _)| *number != 0.0);
    let mut terms: Vec<Term> = terms.into_iter().map(|(number, base)| multiple(number, base)).collect();
    match terms.len() {
        0 => ZERO,
        1 => terms.remove(0),
        _ => Term::Sum(terms),
    }
}

fn parts(term: Term) -> Vec<Term> {
    match term {
        Term::Sum(terms) => terms,
        other => vec![other],
    }
}

/// The number in front of a term, and the rest of the term: 1 if the term is a number.
fn coefficient(term: Term) -> (f64, Term) {
    let (minus, term) = term.unsigned();
    let (number, base) = match term {
        Term::Number(number) => (number, ONE),
        Term::Product(factors) => match factors[..] {
            [Term::Number(number), ref rest @ ..] => (number, product(rest.to_vec())),
            _ => (1.0, Term::Product(factors)),
        },
        other => (1.0, other),
    };
    (if minus { -number } else { number }, base)
}

/// The product of a number and a term that has no number in front.
fn multiple(number: f64, base: Term) -> Term {
    if base == ONE {
        return Term::Number(number);
    }
    let magnitude = Term::Number(number.abs());
    let term = match base {
        base if magnitude == ONE => base,
        Term::Product(factors) => Term::Product(std::iter::once(magnitude).chain(factors).collect()),
        other => Term::Product(vec![magnitude, other]),
    };
    if number < 0.0 { neg(term) } else { term }
}

/// The product, with equal factors as powers.
pub fn times(a: Term, b: Term) -> Term {
    if a == ZERO || b == ZERO {
        return ZERO;
    }
    let (minus_a, a) = a.unsigned();
    let (minus_b, b) = b.unsigned();
    let parts = |term| match term {
        Term::Product(factors) => factors,
        other => vec![other],
    };
    let mut factors = parts(a);
    for factor in parts(b) {
        let (base, n) = powered(&factor);
        let known =
            factors.iter_mut().find(|known| powered(known).0 == base && !matches!(base, Term::Number(_)));
        match known {
            Some(known) => *known = Term::Power(Box::new(base.clone()), powered(known).1 + n),
            None => factors.push(factor),
        }
    }
    factors.sort_by_key(place);
    let product = product(factors);
    if minus_a == minus_b { product } else { neg(product) }
}

/// Sorting key of a factor. Functions stand last, since a factor after `sin x` could be read as part of its
/// argument.
fn place(factor: &Term) -> u8 {
    match factor {
        Term::Number(_) => 0,
        Term::Power(base, _) => place(base).max(1),
        Term::Sum(_) | Term::Neg(_) => 2,
        Term::Call(..) => 3,
        _ => 1,
    }
}

/// Base and exponent of a factor.
fn powered(term: &Term) -> (&Term, u32) {
    match term {
        Term::Power(base, n) => (base, *n),
        other => (other, 1),
    }
}

/// The quotient.
pub fn quotient(a: Term, b: Term) -> Term {
    let (minus_a, a) = a.unsigned();
    let (minus_b, b) = b.unsigned();
    let quotient = Term::Quotient(Box::new(a), Box::new(b));
    if minus_a == minus_b { quotient } else { neg(quotient) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn z(index: usize, number: f64) -> Term {
        times(Term::Number(number), Term::Z(index))
    }

    #[test]
    fn like_terms_become_one() {
        let fractions = sum(sum(Term::Z(1), Term::Name("m".to_owned())), z(1, 0.5));
        assert_eq!(fractions, sum(z(1, 1.5), Term::Name("m".to_owned())));
        assert_eq!(sum(Term::Z(1), Term::Z(1)), Term::Product(vec![Term::Number(2.0), Term::Z(1)]));
        assert_eq!(sum(z(1, 0.5), z(1, 0.5)), Term::Z(1));
        let numbers = sum(sum(Term::Z(1), Term::Number(-1.0)), Term::Number(-1.0));
        assert_eq!(numbers, Term::Sum(vec![Term::Z(1), Term::Number(-2.0)]));
    }

    #[test]
    fn terms_that_cancel_give_zero() {
        assert_eq!(sum(Term::Z(1), neg(Term::Z(1))), ZERO);
        assert_eq!(sum(sum(Term::Z(1), Term::Z(2)), neg(Term::Z(1))), Term::Z(2));
        assert_eq!(sum(times(ZERO, Term::Z(1)), Term::Z(2)), Term::Z(2));
    }
}
