//! The names of a model. All kinds share one name space.

use std::collections::{HashMap, HashSet};

use super::hulls::Hulls;
use super::pairs;
use crate::diagnostics::{Diagnostic, codes};
use crate::parts;
use crate::rust_names::{is_keyword, is_value, snake_case};
use crate::span::Span;
use crate::suggest;
use crate::syntax::tree::{Name, Tree};
use crate::unicode;

/// What a name stands for. Indices as in `Mechanism`: frame 0 is N, point 0 is O, dependent speeds follow the
/// independent ones and particles the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Symbol {
    Parameter(usize),
    Input(usize),
    Coordinate(usize),
    Speed(usize),
    Definition(usize),
    Frame(usize),
    Point(usize),
    Body(usize),
    Contact(usize),
    Shape(usize),
    Time,
    Pi,
    /// declared by an entry that could not be read
    Broken,
}

impl Symbol {
    /// With its article, for messages.
    pub fn kind(self) -> &'static str {
        match self {
            Symbol::Parameter(_) => "a parameter",
            Symbol::Input(_) => "an input",
            Symbol::Coordinate(_) => "a coordinate",
            Symbol::Speed(_) => "a speed",
            Symbol::Definition(_) => "a definition",
            Symbol::Frame(_) => "a frame",
            Symbol::Point(_) => "a point",
            Symbol::Body(_) => "a body",
            Symbol::Contact(_) => "a contact",
            Symbol::Shape(_) => "a shape",
            Symbol::Time => "the time",
            Symbol::Pi => "the number pi",
            Symbol::Broken => "something that could not be read",
        }
    }
}

/// All names of a model.
pub struct Names {
    symbols: HashMap<String, (Symbol, Option<Span>)>,
    /// declared twice: it is not known what they mean
    ambiguous: HashSet<String>,
    /// in the order of declaration, so that suggestions do not depend on hashing
    order: Vec<(String, Symbol)>,
}

impl Names {
    /// Collects the declarations of a model; reports names that cannot be declared.
    pub fn collect(tree: &Tree, hulls: &Hulls, diagnostics: &mut Vec<Diagnostic>) -> Names {
        let mut names = Names { symbols: HashMap::new(), ambiguous: HashSet::new(), order: Vec::new() };
        for (text, symbol) in
            [("N", Symbol::Frame(0)), ("O", Symbol::Point(0)), ("time", Symbol::Time), ("pi", Symbol::Pi)]
        {
            names.symbols.insert(text.to_owned(), (symbol, None));
            names.order.push((text.to_owned(), symbol));
        }
        let doubtful: HashSet<Span> = tree.doubtful.iter().copied().collect();
        let mut add = |name: &Name, symbol: Symbol| {
            if !(doubtful.contains(&name.span) && names.symbols.contains_key(&name.text)) {
                names.declare(name, symbol, diagnostics);
            }
        };
        let quantities = |list: &[crate::syntax::tree::Declaration]| -> Vec<Name> {
            list.iter().map(|quantity| quantity.name.clone()).collect()
        };
        for (i, name) in quantities(&tree.parameters).iter().enumerate() {
            add(name, Symbol::Parameter(i));
        }
        for (i, name) in quantities(&tree.inputs).iter().enumerate() {
            add(name, Symbol::Input(i));
        }
        for (i, name) in quantities(&tree.coordinates).iter().enumerate() {
            add(name, Symbol::Coordinate(i));
        }
        for (i, name) in quantities(&tree.speeds).iter().chain(&quantities(&tree.dependent)).enumerate() {
            add(name, Symbol::Speed(i));
        }
        for (i, definition) in tree.definitions.iter().enumerate() {
            add(&definition.name, Symbol::Definition(i));
        }
        for (i, frame) in tree.frames.iter().enumerate() {
            add(&frame.name, Symbol::Frame(i + 1));
        }
        for (i, point) in tree.points.iter().enumerate() {
            add(&point.name, Symbol::Point(i + 1));
        }
        for (i, body) in tree.bodies.iter().chain(&tree.particles).enumerate() {
            add(&body.name, Symbol::Body(i));
        }
        for (i, shape) in tree.shapes.iter().enumerate() {
            add(&shape.name, Symbol::Shape(i));
        }
        let contacts = pairs::names(tree, hulls);
        for (i, (contact, _)) in contacts.iter().enumerate() {
            add(contact, Symbol::Contact(i));
        }
        for name in &tree.broken {
            names.symbols.entry(name.text.clone()).or_insert((Symbol::Broken, Some(name.span)));
        }
        names.collisions(tree, &contacts, diagnostics);
        names
    }

    fn declare(&mut self, name: &Name, symbol: Symbol, diagnostics: &mut Vec<Diagnostic>) {
        if let Some(error) = reserved(name).or_else(|| value_in_rust(name, symbol)) {
            diagnostics.push(error);
        }
        match self.symbols.get(&name.text) {
            None => {
                self.symbols.insert(name.text.clone(), (symbol, Some(name.span)));
                self.order.push((name.text.clone(), symbol));
            }
            Some((first, Some(place))) => {
                self.ambiguous.insert(name.text.clone());
                diagnostics.push(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        name.span,
                        format!("the name `{}` is declared twice", name.text),
                    )
                    .related(*place, format!("first declared here, as {}", first.kind()))
                    .help("all names of a model share one name space: choose another name"),
                );
            }
            Some((_, None)) => diagnostics.extend(parts::predefined(name)),
        }
    }

    /// The names declared twice.
    pub fn ambiguous(&self) -> impl Iterator<Item = &str> {
        self.ambiguous.iter().map(String::as_str)
    }

    /// Whether no name is nearer to `name` than this.
    pub fn is_near(&self, name: &str, this: &str) -> bool {
        let candidates = std::iter::once(this).chain(self.order.iter().map(|(text, _)| text.as_str()));
        suggest::nearest(name, candidates) == Some(this)
    }

    /// Whether it is declared twice.
    pub fn is_ambiguous(&self, name: &str) -> bool {
        self.ambiguous.contains(name)
    }

    /// Routines of the generated code are named after these, in snake case.
    fn collisions(&self, tree: &Tree, contacts: &[(Name, usize)], diagnostics: &mut Vec<Diagnostic>) {
        let kinds: [(&str, Vec<&Name>); 4] = [
            ("contact", contacts.iter().map(|(name, _)| name).collect()),
            ("point", tree.points.iter().map(|p| &p.name).collect()),
            ("frame", tree.frames.iter().map(|f| &f.name).collect()),
            ("body", tree.bodies.iter().chain(&tree.particles).map(|b| &b.name).collect()),
        ];
        for (kind, list) in kinds {
            let mut seen: HashMap<String, &Name> = HashMap::new();
            for name in &list {
                let rust = snake_case(&name.text);
                match seen.get(&rust) {
                    Some(first) if first.text != name.text => diagnostics.push(
                        Diagnostic::new(
                            codes::COLLISION,
                            name.span,
                            format!("`{}` and `{}` both become `{rust}` in Rust", first.text, name.text),
                        )
                        .related(first.span, format!("the other {kind}"))
                        .help("make them differ by more than capitals and underscores"),
                    ),
                    Some(_) => {}
                    None => {
                        seen.insert(rust, name);
                    }
                }
            }
            // `collide_tip` has its derivative beside it.
            for name in list.iter().filter(|_| kind == "contact") {
                let rust = snake_case(&name.text);
                if let Some(first) = rust.strip_suffix("_derivative").and_then(|of| seen.get(of)) {
                    diagnostics.push(
                        Diagnostic::new(
                            codes::COLLISION,
                            name.span,
                            format!(
                                "`collide_{rust}` would be both the collision of `{}` and the derivative of that of `{}` in Rust",
                                name.text, first.text
                            ),
                        )
                        .related(first.span, "the other contact")
                        .help("let its name end otherwise"),
                    );
                }
            }
        }
    }

    /// What a name stands for, if it is declared.
    pub fn get(&self, name: &str) -> Option<Symbol> {
        self.symbols.get(name).map(|(symbol, _)| *symbol)
    }

    /// All names, in the order of their declaration.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.order.iter().map(|(text, _)| text.as_str())
    }

    /// All names and what they stand for, in the order of their declaration.
    pub fn declared(&self) -> impl Iterator<Item = (&str, Symbol)> {
        self.order.iter().map(|(text, symbol)| (text.as_str(), *symbol))
    }

    /// Where it is declared; `None` for what is given.
    pub fn place(&self, name: &str) -> Option<Span> {
        self.symbols.get(name).and_then(|(_, place)| *place)
    }

    /// The declared name most like this one, among those that fit.
    pub fn nearest(&self, name: &str, fits: impl Fn(Symbol) -> bool) -> Option<&str> {
        let candidates = self.order.iter().filter(|(_, symbol)| fits(*symbol)).map(|(text, _)| text.as_str());
        suggest::nearest(name, candidates)
    }
}

/// A quantity becomes a variable of the generated code, which cannot have the name of a constant.
fn value_in_rust(name: &Name, symbol: Symbol) -> Option<Diagnostic> {
    use Symbol::{Coordinate, Input, Parameter, Speed};
    let quantity = matches!(symbol, Parameter(_) | Input(_) | Coordinate(_) | Speed(_));
    if !quantity || !is_value(&name.text) {
        return None;
    }
    let message = format!("`{}` is a value in Rust: {} cannot have this name", name.text, symbol.kind());
    let help = format!("choose another name, such as `{}`", name.text.to_lowercase() + "_");
    Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help(help))
}

/// Says why a name cannot be declared.
pub fn reserved(name: &Name) -> Option<Diagnostic> {
    if is_keyword(&name.text) {
        let message = format!("`{}` is a keyword of Rust", name.text);
        return Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help("choose another name"));
    }
    if name.text.chars().all(|c| c == '_') {
        let message = "a name needs a letter";
        return Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help("choose another name"));
    }
    if let Some(c) = name.text.chars().find(|c| !c.is_alphanumeric() && *c != '_') {
        let message = format!("`{}` cannot stand in a name", c.escape_debug());
        let help = match c {
            '·' => "write `*` for a product",
            c if unicode::is_invisible(c) => "remove this character, which cannot be seen",
            _ => "names are made of letters, digits and `_`",
        };
        return Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help(help));
    }
    if let Some(c) = unicode::with_two_spellings(&name.text) {
        let message = format!(
            "`{c}` (U+{:04X}) can be written in two ways: names that look alike may differ",
            c as u32
        );
        let help = "Rust takes both spellings for one name: choose letters that have one spelling";
        return Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help(help));
    }
    if name.text.chars().count() > 100 {
        let message = "a name has at most 100 letters";
        return Some(Diagnostic::new(codes::RESERVED_NAME, name.span, message).help("choose a shorter name"));
    }
    None
}

/// The names that the rate of a coordinate may have: `u1` for `q1`, `u_hip` for `q_hip`, and in an instance of a
/// part, whose names begin with that of the instance, `leg_u1` for `leg_q1`.
pub fn speeds_of(coordinate: &str) -> impl Iterator<Item = String> {
    let begins = |at: &usize| *at == 0 || coordinate[..*at].ends_with('_');
    let places = coordinate.match_indices('q').map(|(at, _)| at).filter(begins);
    places.map(|at| format!("{}u{}", &coordinate[..at], &coordinate[at + 1..]))
}
