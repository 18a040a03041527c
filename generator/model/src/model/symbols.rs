//! The names of a model with the places where they are declared and used, and what the places of the text are:
//! one table, which resolving fills and an editor reads.

use std::collections::{HashMap, HashSet};

use super::names::Symbol;
use crate::dimension::Dimension;
use crate::span::Span;

/// The table of a model.
#[derive(Clone, Debug, Default)]
pub struct Symbols {
    /// all names, in the order of their declaration; those that are given come first
    pub declared: Vec<Declared>,
    /// where names are used, in the order of their places
    pub uses: Vec<Use>,
    /// the expressions that could be read, in the order of their places, the greater before those within
    pub values: Vec<Value>,
    /// what places demand, in the order in which they were read
    pub wanted: Vec<Wanted>,
    /// names that are declared twice
    pub ambiguous: HashSet<String>,
    by_symbol: HashMap<Symbol, usize>,
    by_name: HashMap<String, usize>,
}

/// A declared name.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    /// as spelled
    pub name: String,
    /// what it stands for
    pub symbol: Symbol,
    /// where it is declared; `None` for what is given
    pub place: Option<Span>,
    /// its documentation
    pub docs: String,
    /// its dimension in SI units, if it has one and that is known
    pub dimension: Option<Dimension>,
    /// it is a vector
    pub is_vector: bool,
}

/// A use of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Use {
    /// where
    pub place: Span,
    /// of what
    pub symbol: Symbol,
}

/// An expression that could be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    /// where it stands
    pub place: Span,
    /// its dimension; `None` fits everything
    pub dimension: Option<Dimension>,
    /// it is a vector
    pub is_vector: bool,
}

/// What a place demands of the expression that stands there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// where
    pub place: Span,
    /// its dimension, if that is demanded
    pub dimension: Option<Dimension>,
    /// whether it must be a vector, if that is demanded
    pub is_vector: Option<bool>,
    /// what stands there, such as `the mass`
    pub what: String,
}

impl Symbols {
    /// The same at other places: what has none is left out.
    pub fn placed(self, place: impl Fn(Span) -> Option<Span>) -> Symbols {
        let mut places = Places::default();
        for found in self.uses {
            places.uses.extend(place(found.place).map(|place| Use { place, ..found }));
        }
        for value in self.values {
            places.values.extend(place(value.place).map(|place| Value { place, ..value }));
        }
        let moved = |declared: Declared| Declared { place: declared.place.and_then(&place), ..declared };
        places.table(self.declared.into_iter().map(moved).collect(), self.ambiguous)
    }

    /// The declaration of a symbol.
    pub fn of(&self, symbol: Symbol) -> Option<&Declared> {
        self.by_symbol.get(&symbol).map(|i| &self.declared[*i])
    }

    /// The declaration of a name.
    pub fn named(&self, name: &str) -> Option<&Declared> {
        self.by_name.get(name).map(|i| &self.declared[*i])
    }

    /// What is declared or used at a place of the text, and the place of its name.
    pub fn at(&self, offset: u32) -> Option<(&Declared, Span)> {
        let holds = |place: Span| place.start <= offset && offset <= place.end;
        let used = self.uses.iter().find(|found| holds(found.place));
        if let Some(found) = used.and_then(|found| Some((self.of(found.symbol)?, found.place))) {
            return Some(found);
        }
        let declared = |declared: &&Declared| declared.place.is_some_and(holds);
        self.declared.iter().find(declared).and_then(|found| Some((found, found.place?)))
    }

    /// The places where a symbol is used.
    pub fn uses_of(&self, symbol: Symbol) -> impl Iterator<Item = Span> {
        self.uses.iter().filter(move |found| found.symbol == symbol).map(|found| found.place)
    }

    /// What is known of the expression at exactly this place.
    pub fn value(&self, place: Span) -> Option<&Value> {
        self.values.iter().rev().find(|value| value.place == place)
    }
}

/// What lowering notes on its way: uses, values and demands.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    used: HashSet<Symbol>,
    pub uses: Vec<Use>,
    pub values: Vec<Value>,
    pub wanted: Vec<Wanted>,
}

impl Places {
    /// A name is used here.
    pub fn uses(&mut self, symbol: Symbol, place: Span) {
        self.used.insert(symbol);
        self.uses.push(Use { place, symbol });
    }

    /// A name is used where it does not stand: a coordinate has a rate.
    pub fn implied(&mut self, symbol: Symbol) {
        self.used.insert(symbol);
    }

    /// Whether a name is used.
    pub fn is_used(&self, symbol: Symbol) -> bool {
        self.used.contains(&symbol)
    }

    /// A place demands this of what stands there.
    pub fn wants(&mut self, place: Span, dimension: Option<Dimension>, is_vector: Option<bool>, what: &str) {
        self.wanted.push(Wanted { place, dimension, is_vector, what: what.to_owned() });
    }

    /// The table, with these declarations.
    pub fn table(self, declared: Vec<Declared>, ambiguous: HashSet<String>) -> Symbols {
        let Places { mut uses, mut values, wanted, .. } = self;
        uses.sort();
        uses.dedup();
        values.sort_by_key(|value| (value.place.start, std::cmp::Reverse(value.place.end)));
        values.dedup();
        let index = |(i, declared): (usize, &Declared)| (declared.symbol, i);
        let by_symbol = declared.iter().enumerate().map(index).collect();
        let by_name = declared.iter().enumerate().map(|(i, declared)| (declared.name.clone(), i)).collect();
        Symbols { declared, uses, values, wanted, ambiguous, by_symbol, by_name }
    }
}
