//! Joins steps to chains: sums of products whose partial sums nobody else reads stay in registers.

use std::collections::HashMap;

use super::steps::{Code, Draft, Place, Sign, Term, Varying};

/// What a step adds to one of its operands: which of them is the sum so far, and the term. A factor of 1 leaves the bits of
/// the other, and -0 those of what is added to it.
fn as_term(draft: &Draft) -> Vec<(Place, Term<Place>)> {
    let term = |a, b, sign| Term { factors: [a, b], sign };
    let one = Place::Number(1.0);
    match (draft.code, draft.operands) {
        (Code::AddSS | Code::AddSU, [Some(a), Some(b), _]) => {
            vec![(a, term(b, one, Sign::Plus)), (b, term(a, one, Sign::Plus))]
        }
        (Code::SubSS | Code::SubSU | Code::SubUS, [Some(a), Some(b), _]) => {
            vec![(a, term(b, one, Sign::Minus)), (b, term(a, one, Sign::MinusSum))]
        }
        (Code::MulSS | Code::MulSU, [Some(a), Some(b), _]) => {
            vec![(Place::Number(-0.0), term(a, b, Sign::Plus))]
        }
        (code, [Some(a), Some(b), Some(c)]) if code.is_mul_add() => vec![(c, term(a, b, Sign::Plus))],
        (code, [Some(a), Some(b), Some(c)]) if code.is_mul_sub() => vec![(c, term(a, b, Sign::MinusSum))],
        (code, [Some(a), Some(b), Some(c)]) if code.is_neg_mul_add() => vec![(c, term(a, b, Sign::Minus))],
        _ => Vec::new(),
    }
}

/// How often each value is read.
fn readers(drafts: &[Draft]) -> HashMap<Varying, usize> {
    let mut out = HashMap::new();
    for varying in drafts.iter().flat_map(Draft::reads) {
        *out.entry(varying).or_default() += 1;
    }
    out
}

/// The steps, in which those that follow each other in a sum are one. A chain stands where its last step stood.
pub fn joined(drafts: Vec<Draft>) -> Vec<Draft> {
    let readers = readers(&drafts);
    let mut out: Vec<Option<Draft>> = Vec::with_capacity(drafts.len());
    let mut places: HashMap<Varying, usize> = HashMap::new();
    for draft in drafts {
        // the longest chain that this step can go on with
        let longest = as_term(&draft)
            .into_iter()
            .filter_map(|(sum, term)| {
                let Place::Varying(varying) = sum else { return None };
                let at = *places.get(&varying).filter(|_| readers.get(&varying) == Some(&1))?;
                let before = out.get(at)?.as_ref()?;
                let length = if before.code == Code::Chain { before.terms.len() } else { 1 };
                (before.code == Code::Chain || !as_term(before).is_empty()).then_some((length, at, term))
            })
            .max_by_key(|(length, ..)| *length);
        let draft = match longest {
            None => draft,
            Some((_, at, term)) => {
                let before = out.get_mut(at).and_then(Option::take);
                let (sum, mut terms) = match before {
                    Some(chain) if chain.code == Code::Chain => (chain.operands[0], chain.terms),
                    Some(single) => {
                        let first = as_term(&single).into_iter().next();
                        (first.map(|first| first.0), first.map(|first| first.1).into_iter().collect())
                    }
                    None => (None, Vec::new()),
                };
                terms.push(term);
                Draft { code: Code::Chain, operands: [sum, None, None], terms, ..draft }
            }
        };
        for varying in draft.defines.into_iter().flatten() {
            places.insert(varying, out.len());
        }
        out.push(Some(draft));
    }
    out.into_iter().flatten().collect()
}
