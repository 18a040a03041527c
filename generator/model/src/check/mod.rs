//! Reads a model and checks it as a whole: numbers of equations and unknowns, and properties that only
//! evaluation at states shows.

mod bodies;
mod body_points;
mod by_values;
mod centres;
mod configuration;
mod contacts;
mod counts;
pub mod coupled;
mod empty_equations;
mod exact;
mod finite;
mod gaps;
mod hollows;
mod hulls;
mod implicit_surfaces;
mod independent_constraints;
mod loads;
mod loops;
mod motion;
mod physics;
mod shapes;
mod start;
mod states;
mod unit_vectors;
mod vector_constraints;

use std::collections::HashMap;

use crate::diagnostics::{Diagnostic, Severity, codes};
use crate::model::{self, mechanism::Mechanism, names::Symbol, symbols::Symbols};
use crate::parts::{self, Expansion};
use crate::source::{MAX_TOKENS, Source};
use crate::span::Span;
use crate::syntax::{self, lexer, token::Token, tree::Tree};

pub use bodies::{Impossible, impossible_bodies};
pub use shapes::{ImpossibleSize, impossible_sizes};
pub use unit_vectors::{ROUNDED_QUATERNION, UNIT_QUATERNION};
pub use vector_constraints::dependent_components;

/// What was found in a model.
#[derive(Clone, Debug)]
pub struct Checked {
    /// the mechanism; there if and only if no error was found
    pub mechanism: Option<Mechanism>,
    /// errors and warnings, in the order of their places
    pub diagnostics: Vec<Diagnostic>,
}

impl Checked {
    /// Whether an error was found.
    pub fn has_errors(&self) -> bool {
        self.mechanism.is_none()
    }
}

/// All that is known of a model, mistaken or not.
#[derive(Clone, Debug, Default)]
pub struct Analysis {
    /// its tokens
    pub tokens: Vec<Token>,
    /// what of it could be parsed
    pub tree: Tree,
    /// its names and their places
    pub symbols: Symbols,
    /// the names that are declared in a file that is imported, and where
    pub imported: HashMap<Symbol, parts::Place>,
    /// what could be read of the mechanism: a whole only if `has_errors` says no
    pub mechanism: Option<Mechanism>,
    /// errors and warnings, in the order of their places
    pub diagnostics: Vec<Diagnostic>,
}

impl Analysis {
    /// Whether an error was found.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }
}

/// Reads and checks a model. Reports all mistakes at once; never fails otherwise.
pub fn check(source: &Source) -> Checked {
    let analysis = match source.expansion() {
        Some(expansion) => expanded(source, expansion),
        None => analysed(source),
    };
    let failed = analysis.has_errors();
    Checked { mechanism: analysis.mechanism.filter(|_| !failed), diagnostics: analysis.diagnostics }
}

/// Checks what the parts of a model expand to.
fn expanded(source: &Source, expansion: &Expansion) -> Analysis {
    let mut diagnostics = expansion.syntax.clone();
    diagnostics.extend(expansion.mistakes.iter().cloned());
    if diagnostics.is_empty() && source.is_library() {
        let message = "this is a file of parts, and no mechanism";
        let error = Diagnostic::new(codes::EMPTY, Span::default(), message);
        let help =
            "a model uses it after `import \"..\";`; `hodograph check` and `hodograph fmt` take it as it is";
        diagnostics.push(error.help(help));
    }
    if !diagnostics.is_empty() {
        return Analysis { diagnostics: expansion.explained(diagnostics), ..Analysis::default() };
    }
    let Analysis { mechanism, diagnostics, symbols, .. } = analysed(source);
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    // names of imported files stand in other texts
    let place = |span: Span| expansion.places.find(span);
    let others =
        symbols.declared.iter().filter_map(|declared| Some((declared.symbol, place(declared.place?)?)));
    let imported = others.filter(|(_, place)| place.file > 0).collect();
    let symbols = symbols.placed(|span| place(span).filter(|place| place.file == 0).map(|place| place.span));
    let mechanism = mechanism.filter(|_| !failed);
    let diagnostics = expansion.explained(diagnostics);
    Analysis { mechanism, symbols, imported, diagnostics, ..Analysis::default() }
}

/// The names of a model and their places, without a check of its numbers.
pub fn names(tokens: &[Token]) -> (Tree, Symbols) {
    let (tree, diagnostics) = syntax::parse(tokens);
    if model::too_many(&tree).is_some() {
        return (tree, Symbols::default());
    }
    let symbols = model::lower(&tree, &hulls::hulls(&tree), diagnostics).symbols;
    (tree, symbols)
}

/// Reads and checks a model, and keeps all that was found on the way. Of a model with parts the tokens and the
/// places of names are those of its own text, and what could be parsed is not kept; the places of mistakes are
/// those of the expanded model, which [`Source::place`] and [`Source::in_itself`] find in the texts.
pub fn analyse(source: &Source) -> Analysis {
    let Some(expansion) = source.expansion() else { return analysed(source) };
    let tokens = source.text().map(|text| lexer::tokens(text, MAX_TOKENS)).unwrap_or_default();
    Analysis { tokens, ..expanded(source, expansion) }
}

/// The same of the tokens of a model without parts.
fn analysed(source: &Source) -> Analysis {
    let tokens = match source.tokens() {
        Ok(tokens) => tokens.into_owned(),
        Err(error) => return Analysis { diagnostics: vec![*error], ..Analysis::default() },
    };
    let (tree, diagnostics) = syntax::parse(&tokens);
    let mut symbols = Symbols::default();
    // without a name nothing else could be read
    let unread = tree.name.is_none() && tree.sections.is_empty();
    let (mut mechanism, mut diagnostics) = if let Some(error) = model::too_many(&tree) {
        (None, diagnostics.into_iter().chain([error]).collect())
    } else if unread {
        (None, diagnostics)
    } else {
        let lowered = model::lower(&tree, &hulls::hulls(&tree), diagnostics);
        symbols = lowered.symbols;
        (Some((lowered.mechanism, lowered.readable)), lowered.diagnostics)
    };
    if let Some((mechanism, readable)) = &mut mechanism {
        let sound = !diagnostics.iter().any(Diagnostic::hides_meaning);
        let found = start::complete(mechanism, sound);
        readable.motion &= found.is_empty();
        diagnostics.extend(found);
    }
    // parts that could not be read hold placeholders: only checks that do not depend on them are made
    if let Some((mechanism, readable)) = &mut mechanism {
        if readable.motion {
            let empty = physics::empty_equations(mechanism);
            readable.motion = empty.is_empty();
            diagnostics.extend(empty);
        }
        if readable.motion {
            mechanism.determining_constraints = physics::determining_constraints(mechanism, readable);
            let counts = counts::counts(mechanism);
            readable.motion = counts.is_empty();
            diagnostics.extend(counts);
        }
        let name = tree.name.as_ref().map_or(Span::default(), |name| name.span);
        let found = physics::physics(mechanism, readable, name);
        diagnostics.extend(found.mistakes);
        found.without_potential.into_iter().for_each(|load| mechanism.loads[load].potential = false);
    }
    // only the first mistake at a place is reported: others there follow from it
    let mut places = std::collections::HashSet::new();
    diagnostics.retain(|d| d.severity == Severity::Warning || places.insert(d.primary.span));
    // several contacts of one pair of shapes say the same
    let mut said = std::collections::HashSet::new();
    diagnostics.retain(|d| d.severity == Severity::Error || said.insert((d.code, d.primary.span)));
    // a contact without a gap is worth a word only where nothing else is wrong with it
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    let others: Vec<Span> =
        diagnostics.iter().filter(|d| d.code != codes::NO_GAP).map(|d| d.primary.span).collect();
    diagnostics.retain(|d| d.code != codes::NO_GAP || !failed && !others.contains(&d.primary.span));
    diagnostics.sort_by_key(|d| (d.primary.span, d.code));
    let mechanism = mechanism.map(|(mechanism, _)| mechanism);
    Analysis { tokens, tree, symbols, mechanism, diagnostics, ..Analysis::default() }
}
