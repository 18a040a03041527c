//! The structs and methods of a generated module that can be represented in C, selected by their types.

use hodograph_generator::emit::identifiers::ident;
use hodograph_generator::emit::interface::{Interface, Signature, Struct, Type};

/// The part of a module that can be represented in C.
#[derive(Clone, Debug)]
pub struct Module {
    /// name of the module in Rust
    pub path: String,
    /// the prefix of all names in C, initially the Rust name
    pub name: String,
    /// name of the mechanism's type
    pub mechanism: String,
    /// documentation of the mechanism: the first paragraph
    pub docs: String,
    /// number of scalars in the type of the mechanism
    pub numbers: usize,
    /// parameters, coordinates and speeds, and results with several parts
    pub records: Vec<Record>,
    /// routines
    pub routines: Vec<Routine>,
}

/// A struct.
#[derive(Clone, Debug)]
pub struct Record {
    /// its name in Rust
    pub name: String,
    /// its documentation
    pub docs: String,
    /// the fields that can be represented in C
    pub fields: Vec<Field>,
    /// whether the model states values for it
    pub stated: bool,
}

impl Record {
    /// Whether it holds numbers only, so that it is an array in Rust.
    pub fn is_plain(&self) -> bool {
        self.fields.iter().all(|field| field.form == Form::Number)
    }
}

/// A field of a record.
#[derive(Clone, Debug)]
pub struct Field {
    /// its name in Rust
    pub name: String,
    /// its documentation
    pub docs: String,
    /// its type
    pub form: Form,
}

/// A routine.
#[derive(Clone, Debug)]
pub struct Routine {
    /// its name in Rust
    pub name: String,
    /// its name in C after that of the module, initially the Rust name
    pub symbol: String,
    /// its documentation
    pub docs: String,
    /// its arguments after the mechanism: names and types
    pub arguments: Vec<(String, Form)>,
    /// its result
    pub answer: Form,
    /// whether there is a variant with a budget
    pub budgeted: bool,
}

/// The types that can be represented in C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// a number
    Number,
    /// a fixed number of numbers
    Vector(usize),
    /// rows and columns
    Matrix(usize, usize),
    /// the reduced matrix of a contact
    Reduced,
    /// an optional vector of three numbers
    Direction,
    /// a record of this name
    Record(String),
    /// the surface of a contact
    Surface,
    /// the phases of a collision
    Path,
    /// the mode of a closed contact
    Mode,
    /// whether other modes fit
    Selection,
    /// works, compressions and sensitivity of a collision
    Impact,
    /// how far the mode of a closed contact is from its end
    Margins,
}

/// The part of an interface that can be represented in C.
pub fn of(interface: &Interface) -> Module {
    let mut records: Vec<Record> = interface.structures.iter().map(record).collect();
    let routines: Vec<Routine> =
        interface.methods.iter().filter_map(|method| routine(method, &records)).collect();
    let is_known = |name: &str| {
        let forms = |routine: &Routine| {
            routine
                .arguments
                .iter()
                .map(|(_, form)| form)
                .chain([&routine.answer])
                .cloned()
                .collect::<Vec<_>>()
        };
        routines.iter().flat_map(forms).any(|form| matches!(form, Form::Record(of) if of == name))
    };
    records.retain(|record| record.name == "Parameters" || is_known(&record.name));
    let docs = plain(&interface.docs);
    Module {
        path: interface.module.clone(),
        name: interface.module.clone(),
        mechanism: interface.mechanism.clone(),
        docs: docs.lines().take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" "),
        numbers: interface.numbers,
        records,
        routines,
    }
}

fn record(of: &Struct) -> Record {
    let field = |field: &hodograph_generator::emit::interface::Field| {
        let name = ident(&field.name).to_string();
        Some(Field { name, docs: plain(&field.docs), form: form(&field.of)? })
    };
    let fields = of.fields.iter().filter_map(field).collect();
    Record { name: of.name.clone(), docs: plain(&of.docs), fields, stated: of.stated }
}

/// A method, if all its arguments and its result can be represented in C.
fn routine(method: &Signature, records: &[Record]) -> Option<Routine> {
    let find = |name: &str| records.iter().find(|record| record.name == name);
    let argument = |name: &str, of: &Type| {
        let form = form(of)?;
        let taken = match &form {
            Form::Number | Form::Surface => true,
            Form::Record(name) => find(name).is_some_and(Record::is_plain),
            _ => false,
        };
        taken.then(|| (name.to_owned(), form))
    };
    let arguments = method.arguments.iter().map(|taken| argument(taken.name, &taken.of));
    let arguments = arguments.collect::<Option<Vec<_>>>()?;
    let answer = form(&method.answer)?;
    let is_there = match &answer {
        Form::Record(name) => find(name).is_some_and(|record| !record.fields.is_empty()),
        _ => true,
    };
    is_there.then(|| Routine {
        name: ident(&method.name).to_string(),
        symbol: method.name.clone(),
        docs: plain(&method.docs),
        arguments,
        answer,
        budgeted: method.arguments.iter().any(|taken| taken.of == Type::BudgetedSurface),
    })
}

/// The form of a type, if it can be represented in C. C forbids empty structs and arrays.
fn form(of: &Type) -> Option<Form> {
    match of {
        Type::Number => Some(Form::Number),
        Type::Vector(rows) | Type::Matrix(rows, 1) => (*rows > 0).then_some(Form::Vector(*rows)),
        Type::Matrix(rows, columns) => (*rows > 0 && *columns > 0).then_some(Form::Matrix(*rows, *columns)),
        Type::Optional(of) => (**of == Type::Vector(3)).then_some(Form::Direction),
        // The derivatives of a contact contain arrays of matrices and optional values.
        Type::Struct(name) => {
            let is_foreign = ["CollisionDerivative", "ContactDerivatives"].contains(&name.as_str());
            (!is_foreign).then(|| Form::Record(name.clone()))
        }
        Type::Reduced => Some(Form::Reduced),
        Type::Surface | Type::BudgetedSurface => Some(Form::Surface),
        Type::Path => Some(Form::Path),
        Type::Mode => Some(Form::Mode),
        Type::Selection => Some(Form::Selection),
        Type::Impact => Some(Form::Impact),
        Type::Margins => Some(Form::Margins),
        Type::Array(..)
        | Type::Pair(..)
        | Type::ContactState
        | Type::Law
        | Type::ImpactDerivative
        | Type::Saltation(_)
        | Type::ContactOutcome => None,
    }
}

/// The text of the documentation, without the marks of links.
fn plain(docs: &str) -> String {
    let lines = docs.trim().lines().map(|line| line.trim().replace("[`", "`").replace("`]", "`"));
    lines.collect::<Vec<_>>().join("\n")
}
