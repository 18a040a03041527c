//! The codes and titles of all kinds of mistakes.

use super::Severity;

/// The kind of a mistake: `E012` for errors, `W001` for warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(pub &'static str);

impl Code {
    /// Codes of warnings begin with `W`.
    pub fn severity(self) -> Severity {
        if self.0.starts_with('W') { Severity::Warning } else { Severity::Error }
    }

    /// Whether only the form is wrong. Then the model means what it would mean without the mistake, and all
    /// checks go on.
    pub fn is_of_form(self) -> bool {
        [SECTION_ORDER, SECTION_TWICE, SECOND_MECHANISM, STRAY_DOCS, COLLISION].contains(&self)
    }

    /// Whether it is a warning of what the text has too much or does not have, and no number is in doubt.
    pub fn is_of_text(self) -> bool {
        [UNUSED_PARAMETER, UNUSED_INPUT, UNUSED_DEFINITION, NO_GAP].contains(&self)
    }

    /// What it means, in a few words.
    pub fn title(self) -> &'static str {
        ALL.iter().find(|(code, _)| *code == self).map_or("", |(_, title)| title)
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

macro_rules! codes {
    ($($name:ident = $code:literal, $title:literal;)*) => {
        $(#[doc = $title] pub const $name: Code = Code($code);)*
        /// Every code with its title, in order.
        pub const ALL: &[(Code, &str)] = &[$(($name, $title)),*];
    };
}

codes! {
    UNREADABLE = "E001", "the file cannot be read as text";
    TOO_LARGE = "E002", "the model is too large";
    BAD_TOKEN = "E003", "this text cannot be part of a model";
    BAD_NUMBER = "E004", "not a decimal number";
    UNBALANCED = "E005", "a bracket without its partner";
    EXPECTED = "E006", "something else is expected here";
    SECTION_UNKNOWN = "E007", "no section has this name";
    SECTION_ORDER = "E008", "sections are out of order";
    SECTION_TWICE = "E009", "a section appears twice";
    STRAY_DOCS = "E010", "documentation without an entry";
    TOO_DEEP = "E011", "brackets are nested too deeply";
    BAD_EXPRESSION = "E012", "not an expression";
    FIELD = "E013", "a field is unknown, missing or given twice";
    EMPTY = "E014", "the model has no body or no speed";
    SECOND_MECHANISM = "E015", "a second mechanism in one model";
    UNKNOWN_NAME = "E020", "unknown name";
    DUPLICATE_NAME = "E021", "a name is declared twice";
    RESERVED_NAME = "E022", "a name that cannot be declared";
    COLLISION = "E023", "two names become one in Rust";
    CYCLE = "E024", "things are defined through each other";
    WRONG_KIND = "E025", "a name of another kind is needed here";
    UNKNOWN_UNIT = "E030", "unknown unit";
    DIMENSION = "E031", "dimensions do not agree";
    EXPONENT = "E032", "an exponent that is not allowed";
    NUMBER_RANGE = "E033", "a number out of range";
    ZERO_DIVISOR = "E034", "division by zero";
    CONSTANT = "E035", "a value must be a constant";
    NEEDS_VALUE = "E036", "a value is missing";
    SCALAR_VECTOR = "E040", "a scalar where a vector is needed, or the reverse";
    FUNCTION = "E041", "unknown function or wrong number of arguments";
    NO_AXES = "E042", "a frame without axes";
    NO_POSITION = "E043", "a point without position";
    SPEED_DEPENDENT = "E050", "this must be free of speeds";
    NOT_LINEAR = "E051", "this must be linear in the speeds";
    FRAME = "E052", "a frame is not oriented correctly";
    QUATERNION = "E053", "a quaternion is not used correctly";
    POINT = "E054", "a point is not placed correctly";
    MOTION_TWICE = "E055", "a motion is stated twice";
    INPUT_MOVES = "E056", "an input where a rate is needed";
    BODY = "E060", "a body or particle lacks something";
    MASS = "E061", "a mass that no body can have";
    INERTIA = "E062", "an inertia that no body can have";
    LOAD = "E063", "a load is not stated correctly";
    CONSTRAINT_COUNT = "E070", "constraints and dependent speeds differ in number";
    CONSTRAINT_SINGULAR = "E071", "the constraints do not determine the dependent speeds";
    CONFIGURATION_COUNT = "E072", "configuration equations and dependent coordinates differ in number";
    NO_RATE = "E073", "a coordinate without a kinematical equation";
    KINEMATICS_SINGULAR = "E074", "the kinematical equations do not determine the rates";
    INCONSISTENT = "E075", "a declared velocity contradicts the positions";
    NO_INERTIA = "E076", "a degree of freedom without inertia";
    EMPTY_EQUATION = "E077", "an equation that says nothing";
    NOT_KEPT = "E078", "a configuration that the motion does not keep";
    NO_CONFIGURATION = "E079", "a configuration that has no solution";
    NORMAL = "E080", "the normal is not a unit vector";
    CONTACT_STILL = "E081", "a contact that never moves";
    CONTACT = "E082", "a contact is not stated correctly";
    SURFACE = "E083", "a surface that is impossible";
    START = "E084", "a start in contact that cannot be found";
    SHAPE = "E085", "a shape is not stated correctly";
    PAIR = "E086", "shapes between which no contact is compiled";
    IMPORT = "E090", "a file cannot be imported";
    IMPORT_CYCLE = "E091", "files import each other";
    PART_UNKNOWN = "E092", "no part has this name";
    PART_CYCLE = "E093", "a part contains itself";
    ARGUMENT_UNKNOWN = "E094", "a part takes no such argument";
    ARGUMENT_MISSING = "E095", "a part lacks an argument";
    ARGUMENT_KIND = "E096", "an argument of another kind is needed";
    INDEX = "E097", "nothing has this index";
    COUNT = "E098", "not a whole number";
    REPETITION = "E099", "too many instances of parts";
    OUTER_NAME = "E100", "a name that cannot be seen from here";
    UNUSED_PARAMETER = "W001", "a parameter is never used";
    UNUSED_INPUT = "W002", "an input is never used";
    UNUSED_DEFINITION = "W003", "a definition is never used";
    UNCHECKED = "W004", "a mechanism too large for numerical checks";
    NOT_CLOSED = "W005", "a loop that does not close";
    NEVER_APPROACHES = "W006", "a contact that only slides";
    GAP_RATE = "W007", "a gap that does not belong to its contact";
    CONTACT_POINT = "W008", "a contact point that does not belong to its body";
    BEGINS_INSIDE = "W009", "a start inside what is struck";
    LOAD_POINT = "W010", "a load on a geometric point where a body is meant";
    TORSION_ANGLE = "W011", "a torsion spring whose angle is not that of its axis";
    NO_EFFECT = "W012", "a load that does nothing";
    KEPT_BY_VALUES = "W013", "a configuration that is kept with some values only";
    NO_GAP = "W014", "a contact that no simulation sees";
    NO_START = "W015", "a start without numbers";
    NARROW = "W016", "a sphere that is larger than a hollow";
    BY_VALUES = "W017", "what holds with some values only";
}
