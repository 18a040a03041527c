//! Records the places where two dimensions must be the same: those that agree, and those that contradict each
//! other.

use std::collections::HashMap;

use super::super::names::Symbol;
use super::super::provenance::Provenance;
use crate::dimension::{Dimension, Exponent};

/// What is found out about dimensions.
#[derive(Default)]
pub(super) struct Balances {
    pub contradictions: Vec<Contradiction>,
    /// the names in quotients of dimensions that are the same, as they must be
    pub agreements: Vec<Provenance>,
    /// what is not of one dimension was left out of the mechanism
    pub incomplete: bool,
}

/// A place where two dimensions must be the same and are not.
pub(super) struct Contradiction {
    /// which diagnostic says so
    pub error: usize,
    /// the names in the quotient of the two
    pub provenance: Provenance,
    /// the dimension that is missing in this quotient
    pub missing: Dimension,
    /// what is said of the place, seen from the declaration
    pub says: String,
}

impl Contradiction {
    /// The names for whose declarations nothing speaks.
    pub fn doubtful<'c>(
        &'c self,
        evidence: &'c HashMap<Symbol, usize>,
    ) -> impl Iterator<Item = &'c (Symbol, Exponent)> {
        self.provenance.names().iter().filter(|(symbol, _)| !evidence.contains_key(symbol))
    }

    /// The only name in it whose declaration no use agrees with, if there is just one.
    pub fn plain(&self, evidence: &HashMap<Symbol, usize>) -> Option<(Symbol, Exponent)> {
        let mut doubtful = self.doubtful(evidence);
        doubtful.next().copied().filter(|_| doubtful.next().is_none())
    }

    /// Supposes that a name is declared in another dimension, by this factor.
    pub fn suppose(&mut self, symbol: Symbol, change: Option<Dimension>) {
        let change = change.and_then(|change| change.power(self.provenance.of_name(symbol)));
        self.missing = change.and_then(|change| self.missing.over(&change)).unwrap_or(self.missing);
    }
}
