//! The untyped syntax tree of a model, with the place of every part.

use crate::span::Span;

/// A name and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// as spelled
    pub text: String,
    /// where
    pub span: Span,
}

/// The sections, in the order in which they stand in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Section {
    Parameters,
    Inputs,
    Coordinates,
    Speeds,
    Dependent,
    Definitions,
    Frames,
    AngularVelocities,
    Points,
    Velocities,
    Bodies,
    Particles,
    Shapes,
    Loads,
    Kinematics,
    Constraints,
    Configuration,
    Contacts,
}

impl Section {
    /// All, in order.
    pub const ALL: [Section; 18] = [
        Section::Parameters,
        Section::Inputs,
        Section::Coordinates,
        Section::Speeds,
        Section::Dependent,
        Section::Definitions,
        Section::Frames,
        Section::AngularVelocities,
        Section::Points,
        Section::Velocities,
        Section::Bodies,
        Section::Particles,
        Section::Shapes,
        Section::Loads,
        Section::Kinematics,
        Section::Constraints,
        Section::Configuration,
        Section::Contacts,
    ];

    /// The word that opens it.
    pub fn word(self) -> &'static str {
        match self {
            Section::Parameters => "parameters",
            Section::Inputs => "inputs",
            Section::Coordinates => "coordinates",
            Section::Speeds => "speeds",
            Section::Dependent => "dependent",
            Section::Definitions => "definitions",
            Section::Frames => "frames",
            Section::AngularVelocities => "angular_velocities",
            Section::Points => "points",
            Section::Velocities => "velocities",
            Section::Bodies => "bodies",
            Section::Particles => "particles",
            Section::Shapes => "shapes",
            Section::Loads => "loads",
            Section::Kinematics => "kinematics",
            Section::Constraints => "constraints",
            Section::Configuration => "configuration",
            Section::Contacts => "contacts",
        }
    }

    /// The section that a word opens.
    pub fn of_word(word: &str) -> Option<Section> {
        Section::ALL.into_iter().find(|section| section.word() == word)
    }
}

/// A whole model.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// documentation of the mechanism
    pub docs: String,
    /// its name, if it was read
    pub name: Option<Name>,
    /// parameters
    pub parameters: Vec<Declaration>,
    /// inputs
    pub inputs: Vec<Declaration>,
    /// coordinates
    pub coordinates: Vec<Declaration>,
    /// independent speeds
    pub speeds: Vec<Declaration>,
    /// dependent speeds
    pub dependent: Vec<Declaration>,
    /// definitions
    pub definitions: Vec<Definition>,
    /// frames
    pub frames: Vec<Frame>,
    /// declared angular velocities
    pub angular_velocities: Vec<AngularVelocity>,
    /// points
    pub points: Vec<Point>,
    /// declared velocities
    pub velocities: Vec<Velocity>,
    /// bodies
    pub bodies: Vec<Record>,
    /// particles
    pub particles: Vec<Record>,
    /// shapes
    pub shapes: Vec<Record>,
    /// loads
    pub loads: Vec<Load>,
    /// kinematical equations
    pub kinematics: Vec<Equation>,
    /// velocity constraints
    pub constraints: Vec<Equation>,
    /// configuration constraints
    pub configuration: Vec<Equation>,
    /// contacts
    pub contacts: Vec<Record>,
    /// names of entries that could not be read: what refers to them is no further mistake
    pub broken: Vec<Name>,
    /// names behind a word that cannot stand there; the word may be the name that is meant
    pub doubtful: Vec<Span>,
    /// whole parts could not be read: that something is missing is no further mistake
    pub incomplete: bool,
    /// where each section that is there is named
    pub sections: Vec<(Section, Span)>,
}

/// `fixed` or `dependent` before a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modifier {
    /// `fixed`
    Fixed,
    /// `dependent`
    Dependent,
}

/// `fixed name: unit = value`
#[derive(Clone, Debug)]
pub struct Declaration {
    /// documentation
    pub docs: String,
    /// `fixed` or `dependent`
    pub modifier: Option<(Modifier, Span)>,
    /// name
    pub name: Name,
    /// unit, read as an expression
    pub unit: Expr,
    /// value
    pub value: Option<Expr>,
}

/// `name: unit = value;`
#[derive(Clone, Debug)]
pub struct Definition {
    /// documentation
    pub docs: String,
    /// name
    pub name: Name,
    /// unit, if stated
    pub unit: Option<Expr>,
    /// value
    pub value: Expr,
}

/// `name = value;`
#[derive(Clone, Debug)]
pub struct Frame {
    /// documentation
    pub docs: String,
    /// name
    pub name: Name,
    /// how it is oriented
    pub value: Expr,
}

/// `frame in frame = value;`
#[derive(Clone, Debug)]
pub struct AngularVelocity {
    /// of this frame
    pub frame: Name,
    /// in this frame; absent: N
    pub within: Option<Name>,
    /// what it is
    pub value: Expr,
}

/// `point = value;` under `velocities`
#[derive(Clone, Debug)]
pub struct Velocity {
    /// of this point
    pub point: Name,
    /// what it is
    pub value: Expr,
}

/// A statement under `points`
#[derive(Clone, Debug)]
pub struct Point {
    /// documentation
    pub docs: String,
    /// name
    pub name: Name,
    /// the body or frame of which it is a material point
    pub of: Option<Name>,
    /// its position, or its velocity
    pub value: Expr,
    /// `value` is a velocity
    pub by_velocity: bool,
}

/// `name { field: value, .. }`
#[derive(Clone, Debug)]
pub struct Record {
    /// documentation
    pub docs: String,
    /// name
    pub name: Name,
    /// fields in the order written
    pub fields: Vec<Field>,
}

/// `name: value`
#[derive(Clone, Debug)]
pub struct Field {
    /// name
    pub name: Name,
    /// value
    pub value: Expr,
    /// what `velocity` before the value, or `in`, `about`, `of` after it say; of a pair of shapes, `Foot on
    /// Floor`, the second: the name of the field is then `on` or `in`, and its value the first
    pub notes: Vec<Note>,
    /// the fields of a value in braces, in place of an expression
    pub fields: Option<Vec<Field>>,
}

/// A word and a name beside the value of a field.
#[derive(Clone, Debug)]
pub struct Note {
    /// `velocity`, `in`, `about`, `of` or `on`
    pub word: Name,
    /// what follows it; absent for `velocity`
    pub name: Option<Name>,
}

/// A statement under `loads`
#[derive(Clone, Debug)]
pub struct Load {
    /// `gravity`, `force` ..
    pub word: Name,
    /// the names between the word and the colon: `on P`, `from Q`, `to H`, or `P` itself (without a word)
    pub ends: Vec<(Option<Name>, Name)>,
    /// the axis after `about`
    pub about: Option<Expr>,
    /// the value, unless there are fields
    pub value: Option<Expr>,
    /// fields of a spring
    pub fields: Vec<Field>,
    /// the whole
    pub span: Span,
}

/// `left = right;`
#[derive(Clone, Debug)]
pub struct Equation {
    /// left side
    pub left: Expr,
    /// right side
    pub right: Expr,
}

impl Equation {
    /// Where it stands.
    pub fn span(&self) -> Span {
        self.left.span.to(self.right.span)
    }
}

/// An expression and its place.
#[derive(Clone, Debug)]
pub struct Expr {
    /// what it is
    pub kind: ExprKind,
    /// where it stands
    pub span: Span,
}

/// An expression. Sums and products are flat, so that a tree is no deeper than its brackets.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// could not be read; a message says so already
    Error,
    /// a decimal number
    Number(String),
    /// a name
    Name(String),
    /// terms, each with a minus sign or not
    Sum(Vec<(bool, Expr)>),
    /// factors, each a divisor or not
    Product(Vec<(bool, Expr)>),
    /// base and exponent
    Power(Box<Expr>, Box<Expr>),
    /// opposite
    Neg(Box<Expr>),
    /// `function(arguments)`
    Call(Name, Vec<Expr>),
    /// `base.method(arguments)`
    Method(Box<Expr>, Name, Vec<Expr>),
    /// `base.field`
    Field(Box<Expr>, Name),
    /// `[items]`
    List(Vec<Expr>),
    /// `d(expression)/dt`
    Rate(Box<Expr>),
}
