//! Finds the declaration that is wrong where dimensions contradict each other.
//!
//! A name that is declared with a wrong unit contradicts all of its uses. If another dimension of one name
//! resolves several contradictions, and no use agrees with the declared dimension, the declaration is taken
//! for wrong and is reported once instead of all its uses.

use std::collections::{HashMap, HashSet};

use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::Lowering;
use super::balances::{Balances, Contradiction};
use super::dimensions::{Declared, in_words};
use crate::diagnostics::{Diagnostic, Label, codes};
use crate::dimension::Dimension;

/// At most this number of wrong declarations is looked for; nobody reads more messages.
const MOST_DECLARATIONS: usize = 100;
/// Bound on the number of contradictions examined in all, for the same reason.
const MOST_LOOKS: usize = 200_000;
/// At most this number of uses is shown for one declaration.
const MOST_USES: usize = 5;
/// A declaration counts as wrong where this number of uses contradicts it for each use that agrees with it.
const MAJORITY: usize = 4;

/// A use that agrees with one declaration makes others in it trustworthy, and so on: at most this number of
/// steps.
const MOST_PASSES: usize = 8;

/// A declaration that would resolve several contradictions if it were of another dimension.
#[derive(Clone)]
struct Culprit {
    symbol: Symbol,
    needed: Dimension,
    /// contradictions that it would resolve, in order
    resolved: Vec<usize>,
    /// number of these that contain no other doubtful name
    certain: usize,
    /// counts those most in which few other names are in doubt
    weight: f64,
}

impl Culprit {
    /// How odd such a declaration would be: of things that explain the same, the least odd one is meant.
    fn oddity(&self) -> i32 {
        let size: i32 = self.needed.exponents.iter().map(|e| e.numer().abs()).sum();
        size + i32::from(matches!(self.symbol, Symbol::Definition(_)))
    }
}

impl Lowering<'_> {
    /// Puts the contradictions of one wrong declaration into one error, at the declaration.
    pub(super) fn gather(&mut self) {
        let Balances { contradictions: mut open, agreements, .. } = std::mem::take(&mut self.balances);
        let evidence = evidence(&agreements);
        self.show_doubtful(&open, &evidence);
        let mut gone = vec![false; self.diagnostics.len()];
        let mut found = Vec::new();
        let mut settled = HashSet::new();
        for _ in 0..MOST_DECLARATIONS.min(MOST_LOOKS / open.len().max(1)) {
            if open.len() < 2 {
                break;
            }
            let Some((culprit, others)) = self.culprit(&open, &evidence, &settled) else {
                // what is wrong with one may be plain, and then others can be seen
                let plain = |(i, at): (usize, &Contradiction)| {
                    let (symbol, power) =
                        at.plain(&evidence).filter(|(symbol, _)| !settled.contains(symbol))?;
                    Some((i, symbol, at.missing.power(power.recip())))
                };
                let Some((i, symbol, change)) = open.iter().enumerate().find_map(plain) else { break };
                open.remove(i);
                open.iter_mut().for_each(|at| at.suppose(symbol, change));
                settled.insert(symbol);
                continue;
            };
            let Some(declared) = self.declared(culprit.symbol) else { break };
            let mut error = self.wrong_declaration(&culprit, &declared, &others);
            for (shown, i) in culprit.resolved.iter().enumerate() {
                let at = &open[*i];
                if let Some(gone) = gone.get_mut(at.error).filter(|gone| !**gone) {
                    *gone = true;
                    if shown < MOST_USES {
                        error = error.related(self.diagnostics[at.error].primary.span, at.says.clone());
                    }
                }
            }
            // what is left is seen with the declaration as it should be
            let change = culprit.needed.over(&declared.dimension);
            open.iter_mut().for_each(|at| at.suppose(culprit.symbol, change));
            open.retain(|at| !at.missing.is_none());
            settled.insert(culprit.symbol);
            found.push(error);
        }
        let mut at = 0;
        self.diagnostics.retain(|_| {
            at += 1;
            !gone[at - 1]
        });
        self.diagnostics.extend(found);
    }

    /// Shows where names in contradictions are declared, if a few declarations may be wrong.
    fn show_doubtful(&mut self, open: &[Contradiction], evidence: &HashMap<Symbol, usize>) {
        for at in open {
            let doubtful: Vec<Symbol> = at.doubtful(evidence).map(|(symbol, _)| *symbol).collect();
            if doubtful.len() > 2 {
                continue;
            }
            for symbol in doubtful {
                let Some(declared) = self.declared(symbol) else { continue };
                let (span, place) = (declared.name.span, declared.place);
                let text = format!("`{}` is declared here", declared.name.text);
                let error = &mut self.diagnostics[at.error];
                let here = |label: &Label| label.span == span || label.span == place;
                if !here(&error.primary) && !error.related.iter().any(here) {
                    error.related.push(Label { span, text });
                }
            }
        }
    }

    /// The declaration that would resolve most contradictions, and others that would resolve the same ones.
    fn culprit(
        &self,
        open: &[Contradiction],
        evidence: &HashMap<Symbol, usize>,
        settled: &HashSet<Symbol>,
    ) -> Option<(Culprit, Vec<Culprit>)> {
        let mut suspects: HashMap<(Symbol, Dimension), Culprit> = HashMap::new();
        // places where nothing else is in doubt say for certain what is needed
        let mut certain: HashMap<Symbol, usize> = HashMap::new();
        for (i, at) in open.iter().enumerate() {
            let names = at.provenance.names();
            let doubtful = at.doubtful(evidence).count();
            let plain = at.plain(evidence).map(|(symbol, _)| symbol);
            for (symbol, power) in names.iter().filter(|(symbol, _)| !settled.contains(symbol)) {
                let needed = self
                    .declared(*symbol)
                    .and_then(|declared| declared.dimension.times(&at.missing.power(power.recip())?));
                // nobody declares roots of units
                let Some(needed) = needed.filter(|d| d.exponents.iter().all(|e| e.is_integer())) else {
                    continue;
                };
                let none =
                    || Culprit { symbol: *symbol, needed, resolved: Vec::new(), certain: 0, weight: 0.0 };
                let suspect = suspects.entry((*symbol, needed)).or_insert_with(none);
                suspect.resolved.push(i);
                suspect.weight += 1.0 / doubtful.max(1) as f64;
                suspect.certain += usize::from(plain == Some(*symbol));
            }
            if let Some(symbol) = plain {
                *certain.entry(symbol).or_default() += 1;
            }
        }
        let mut suspects: Vec<Culprit> = suspects
            .into_values()
            .filter(|suspect| {
                let for_it = evidence.get(&suspect.symbol).copied().unwrap_or(0);
                let certain = certain.get(&suspect.symbol).copied().unwrap_or(0);
                suspect.resolved.len() >= (MAJORITY * for_it).max(2)
                    && suspect.weight > (certain - suspect.certain) as f64
            })
            .collect();
        suspects.sort_by(|a, b| {
            let order = b.weight.total_cmp(&a.weight).then(a.oddity().cmp(&b.oddity()));
            order.then(a.symbol.cmp(&b.symbol)).then(a.needed.exponents.cmp(&b.needed.exponents))
        });
        let mut suspects = suspects.into_iter();
        let first = suspects.next()?;
        let others = suspects.filter(|other| other.resolved == first.resolved).take(2).collect();
        Some((first, others))
    }

    fn wrong_declaration(&self, culprit: &Culprit, declared: &Declared, others: &[Culprit]) -> Diagnostic {
        let needed = if culprit.needed.is_none() {
            "a plain number or an angle".to_owned()
        } else {
            culprit.needed.to_string()
        };
        let name = &declared.name.text;
        let is = match declared.unit {
            Some("1") => "declared as a plain number".to_owned(),
            Some(unit) => format!("declared in {unit}"),
            None if declared.stated => format!("declared in {}", declared.dimension),
            None => in_words(declared.dimension),
        };
        let remedy = |culprit: &Culprit| {
            let declared = self.declared(culprit.symbol)?;
            let name = &declared.name.text;
            let unit = match culprit.symbol {
                Symbol::Coordinate(_) if culprit.needed.is_none() => "rad".to_owned(),
                _ => culprit.needed.to_string(),
            };
            Some(if declared.stated {
                format!("declare `{name}: {unit}`")
            } else {
                format!("correct the value of `{name}`")
            })
        };
        let remedies: Vec<String> = std::iter::once(culprit).chain(others).filter_map(remedy).collect();
        let message = format!("`{name}` is {is}, but its uses need {needed}");
        let error = Diagnostic::new(codes::DIMENSION, declared.place, message);
        let more = culprit.resolved.len().saturating_sub(MOST_USES);
        let more = if more > 0 { format!("; {more} more uses say the same") } else { String::new() };
        error.help(format!("{}{more}", remedies.join(", or ")))
    }
}

/// Number of uses that agree with the declaration of each name. A use counts for a name if it contains no
/// other name, or only names that other uses agree with.
fn evidence(agreements: &[Provenance]) -> HashMap<Symbol, usize> {
    let mut evidence: HashMap<Symbol, usize> = HashMap::new();
    for _ in 0..MOST_PASSES {
        let before = evidence.len();
        let mut counts = HashMap::new();
        for provenance in agreements {
            let names = provenance.names().iter().map(|(symbol, _)| *symbol);
            let mut unknown = names.clone().filter(|symbol| !evidence.contains_key(symbol));
            match (unknown.next(), unknown.next()) {
                (None, _) => names.for_each(|symbol| *counts.entry(symbol).or_default() += 1),
                (Some(symbol), None) => *counts.entry(symbol).or_default() += 1,
                _ => {}
            }
        }
        evidence = counts;
        if evidence.len() == before {
            break;
        }
    }
    evidence
}
