//! The syntax of parts: what they hold, and what of a file belongs to no section.
//!
//! ```text
//! import "leg.mech";
//! count n = 5;
//! part Leg(hip: point of Body, side: 1 = +1, joints: count = 2) { sections, uses and repetitions }
//! use Leg as front_left(hip: H1 of Trunk, side: -1);
//! for i in 1..n { sections, uses and repetitions }
//! ```

use super::text::shown;
use crate::span::Span;
use crate::syntax::token::Token;
use crate::syntax::tree::{Name, Section};

/// Words that begin a statement of its own among the sections.
pub const WORDS: [&str; 5] = ["import", "count", "part", "use", "for"];

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// `import "path";`
    pub imports: Vec<Import>,
    /// `count n = 5;`
    pub counts: Vec<Count>,
    /// parts
    pub parts: Vec<Part>,
    /// the sections, uses and repetitions of the mechanism
    pub block: Block,
}

/// `import "path";`
#[derive(Clone, Debug)]
pub struct Import {
    /// the path, without its quotes
    pub path: String,
    /// where
    pub span: Span,
}

/// `count n = 5;`
#[derive(Clone, Debug)]
pub struct Count {
    /// its name
    pub name: Name,
    /// its value
    pub value: Vec<Token>,
}

/// `part Name(arguments) { .. }`
#[derive(Clone, Debug)]
pub struct Part {
    /// its name
    pub name: Name,
    /// what is given to it
    pub arguments: Vec<Argument>,
    /// what it holds
    pub block: Block,
}

/// An argument of a part, as declared.
#[derive(Clone, Debug)]
pub struct Argument {
    /// its name
    pub name: Name,
    /// what is given
    pub kind: ArgumentKind,
}

/// What an argument stands for.
#[derive(Clone, Debug)]
pub enum ArgumentKind {
    /// a point, and the body or frame that it belongs to
    Point {
        /// the name that the body or frame has in the part
        of: Option<Name>,
    },
    /// a frame
    Frame,
    /// a body
    Body,
    /// a whole number that is known when the model is read
    Count {
        /// what it is if it is not given
        default: Option<Vec<Token>>,
    },
    /// a quantity
    Value {
        /// its unit
        unit: Vec<Token>,
        /// what it is if it is not given
        default: Option<Vec<Token>>,
    },
}

impl ArgumentKind {
    /// With its article, for messages.
    pub fn describe(&self) -> String {
        match self {
            ArgumentKind::Point { of: Some(_) } => "a point of a body or frame".to_owned(),
            ArgumentKind::Point { of: None } => "a point".to_owned(),
            ArgumentKind::Frame => "a frame".to_owned(),
            ArgumentKind::Body => "a body".to_owned(),
            ArgumentKind::Count { .. } => "a whole number".to_owned(),
            ArgumentKind::Value { unit, .. } => format!("a quantity in {}", shown(unit)),
        }
    }

    /// Something that may be given at first; nothing for a body, of which none is given to all models.
    pub fn placeholder(&self) -> Option<&'static str> {
        match self {
            ArgumentKind::Point { of: Some(_) } => Some("O of N"),
            ArgumentKind::Point { of: None } => Some("O"),
            ArgumentKind::Frame => Some("N"),
            ArgumentKind::Body => None,
            ArgumentKind::Count { .. } | ArgumentKind::Value { .. } => Some("1"),
        }
    }

    /// Whether it must be given.
    pub fn is_required(&self) -> bool {
        !matches!(
            self,
            ArgumentKind::Count { default: Some(_) } | ArgumentKind::Value { default: Some(_), .. }
        )
    }
}

/// What stands between the braces of a part or a repetition, or in a file.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// its sections, and in a mechanism what could not be read
    pub chunks: Vec<Chunk>,
    /// uses and repetitions
    pub items: Vec<Item>,
}

/// A stretch of tokens.
#[derive(Clone, Debug)]
pub enum Chunk {
    /// a section
    Section(SectionText),
    /// what is not for this stage to read
    Other(Vec<Token>),
}

/// The tokens of a section.
#[derive(Clone, Debug)]
pub struct SectionText {
    /// which
    pub section: Section,
    /// its word and the brace
    pub head: Vec<Token>,
    /// what is between the braces
    pub inner: Vec<Token>,
    /// the brace that closes it
    pub close: Token,
}

/// What puts parts into a model.
#[derive(Clone, Debug)]
pub enum Item {
    /// `use Part as name(arguments);`
    Use(Use),
    /// `for i in from..to { .. }`
    For(For),
}

/// `use Part as name[index](arguments);`
#[derive(Clone, Debug)]
pub struct Use {
    /// the part
    pub part: Name,
    /// the name of this instance
    pub name: Name,
    /// its indices
    pub indices: Vec<Vec<Token>>,
    /// what is given
    pub actuals: Vec<Actual>,
    /// it is given between brackets
    pub has_brackets: bool,
    /// where
    pub span: Span,
}

/// What is given for an argument.
#[derive(Clone, Debug)]
pub struct Actual {
    /// the name of the argument
    pub name: Name,
    /// what is given
    pub tokens: Vec<Token>,
}

impl Actual {
    /// Where what is given stands.
    pub fn span(&self) -> Span {
        match (self.tokens.first(), self.tokens.last()) {
            (Some(first), Some(last)) => first.span.to(last.span),
            _ => self.name.span,
        }
    }
}

/// `for i in from..to { .. }`: both ends are included.
#[derive(Clone, Debug)]
pub struct For {
    /// the index
    pub variable: Name,
    /// its first value
    pub from: Vec<Token>,
    /// its last value
    pub to: Vec<Token>,
    /// what is repeated
    pub block: Block,
    /// where the range stands
    pub span: Span,
}

/// The names that the arguments of a part give.
pub fn names_of_arguments(part: &Part) -> impl Iterator<Item = &Name> {
    part.arguments.iter().flat_map(|argument| {
        let of = match &argument.kind {
            ArgumentKind::Point { of } => of.as_ref(),
            _ => None,
        };
        std::iter::once(&argument.name).chain(of)
    })
}
