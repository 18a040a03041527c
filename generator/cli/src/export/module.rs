//! What of a generated module can be called from C: its records and routines, read from its Rust text.

use syn::{
    Attribute, Expr, Fields, FnArg, GenericArgument, ImplItem, Item, Lit, Meta, Pat, PathArguments,
    ReturnType, Type,
};

/// A module with the parts that have a form in C.
#[derive(Clone, Debug)]
pub struct Module {
    /// name of the module in Rust
    pub path: String,
    /// the prefix of all names in C, at first the same
    pub name: String,
    /// name of the mechanism's type
    pub mechanism: String,
    /// documentation of the mechanism: the first paragraph
    pub docs: String,
    /// numbers that the type of the mechanism holds
    pub numbers: usize,
    /// parameters, coordinates and speeds, and the answers with several parts
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
    /// the fields that have a form in C
    pub fields: Vec<Field>,
    /// whether the model states a value of it
    pub stated: bool,
}

impl Record {
    /// Whether it holds numbers alone, so that it is an array for Rust.
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
    /// what it is
    pub form: Form,
}

/// A routine.
#[derive(Clone, Debug)]
pub struct Routine {
    /// its name in Rust
    pub name: String,
    /// its name in C after that of the module, at first the same
    pub symbol: String,
    /// its documentation
    pub docs: String,
    /// what it takes after the mechanism: names and forms
    pub arguments: Vec<(String, Form)>,
    /// what it answers
    pub answer: Form,
    /// whether its surface may have a budget
    pub budgeted: bool,
}

/// What has a form in C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// a number
    Number,
    /// so many numbers
    Vector(usize),
    /// rows and columns
    Matrix(usize, usize),
    /// the reduced matrix of a contact
    Reduced,
    /// a vector of three that may be missing
    Direction,
    /// a record of this name
    Record(String),
    /// the surface of a contact
    Surface,
    /// the phases of a collision
    Path,
    /// the mode of a closed contact
    Mode,
}

/// Reads a generated module. `None`: it does not look like one.
pub fn read(file: &syn::File) -> Option<Module> {
    let module = file.items.iter().find_map(|item| match item {
        Item::Mod(module) => Some(module),
        _ => None,
    })?;
    let items = &module.content.as_ref()?.1;
    let mut records = Vec::new();
    let mut mechanism = None;
    for item in items {
        let Item::Struct(item) = item else { continue };
        let Fields::Named(fields) = &item.fields else { continue };
        let is = |name: &str| {
            fields.named.iter().any(|field| field.ident.as_ref().is_some_and(|ident| ident == name))
        };
        if is("parameters") && is("hoisted")
            || mechanism.is_none()
                && item.fields.iter().all(|field| matches!(field.vis, syn::Visibility::Inherited))
        {
            mechanism = Some(item);
            continue;
        }
        let fields = fields.named.iter().filter_map(|field| {
            let name = field.ident.as_ref()?.to_string();
            Some(Field { name, docs: docs(&field.attrs), form: form(&field.ty)? })
        });
        let name = item.ident.to_string();
        let stated =
            items.iter().any(|item| matches!(item, Item::Impl(block) if is_default_of(block, &name)));
        records.push(Record { docs: docs(&item.attrs), fields: fields.collect(), stated, name });
    }
    let mechanism = mechanism?;
    let size = |record: &str| {
        records.iter().find(|known: &&Record| known.name == record).map_or(0, |known| known.fields.len())
    };
    let numbers = mechanism.fields.iter().map(|field| match &field.ty {
        Type::Array(array) => literal(&array.len).unwrap_or(0),
        _ => size("Parameters"),
    });
    let mut routines = Vec::new();
    for item in items {
        let Item::Impl(block) = item else { continue };
        if block.trait_.is_some() || last(&block.self_ty).is_none_or(|name| mechanism.ident != name) {
            continue;
        }
        for item in &block.items {
            if let ImplItem::Fn(method) = item
                && let Some(routine) = routine(method, &records)
            {
                routines.push(routine);
            }
        }
    }
    let known: Vec<String> = routines
        .iter()
        .flat_map(|routine| {
            let arguments = routine.arguments.iter().map(|(_, form)| form);
            arguments.chain([&routine.answer]).filter_map(|form| match form {
                Form::Record(name) => Some(name.clone()),
                _ => None,
            })
        })
        .collect();
    let numbers = numbers.sum();
    records.retain(|record| record.name == "Parameters" || known.contains(&record.name));
    let docs = docs(&module.attrs).lines().take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    Some(Module {
        path: module.ident.to_string(),
        name: module.ident.to_string(),
        mechanism: mechanism.ident.to_string(),
        docs,
        numbers,
        records,
        routines,
    })
}

/// A public method, if all it takes and what it answers have a form in C.
fn routine(method: &syn::ImplItemFn, records: &[Record]) -> Option<Routine> {
    if !matches!(method.vis, syn::Visibility::Public(_)) {
        return None;
    }
    let mut inputs = method.sig.inputs.iter();
    let Some(FnArg::Receiver(receiver)) = inputs.next() else { return None };
    if receiver.mutability.is_some() {
        return None;
    }
    let mut budgeted = false;
    let arguments = inputs.map(|argument| {
        let FnArg::Typed(argument) = argument else { return None };
        let Pat::Ident(name) = &*argument.pat else { return None };
        let form = match &*argument.ty {
            Type::Reference(reference) if takes_budgets(&reference.elem) => {
                budgeted = true;
                Form::Surface
            }
            Type::Reference(reference) => form(&reference.elem)?,
            other => form(other)?,
        };
        let known = match &form {
            Form::Number | Form::Surface => true,
            Form::Record(name) => records.iter().any(|record| record.name == *name && record.is_plain()),
            _ => false,
        };
        known.then(|| (name.ident.to_string(), form))
    });
    let arguments = arguments.collect::<Option<Vec<_>>>()?;
    let ReturnType::Type(_, answer) = &method.sig.output else { return None };
    let [answer, _] = types(answer)[..] else { return None };
    let answer = form(answer)?;
    let known = match &answer {
        Form::Record(name) => records.iter().any(|record| record.name == *name && !record.fields.is_empty()),
        _ => true,
    };
    let name = method.sig.ident.to_string();
    known.then_some(Routine {
        symbol: name.strip_prefix("r#").unwrap_or(&name).to_owned(),
        name,
        docs: docs(&method.attrs),
        arguments,
        answer,
        budgeted,
    })
}

/// Whether it is a surface with or without a budget.
fn takes_budgets(of: &Type) -> bool {
    let Type::ImplTrait(of) = of else { return false };
    of.bounds.iter().any(|bound| match bound {
        syn::TypeParamBound::Trait(bound) => {
            bound.path.segments.last().is_some_and(|part| part.ident == "ContactSurface")
        }
        _ => false,
    })
}

/// The form of a Rust type. What is empty has none: C forbids it.
fn form(of: &Type) -> Option<Form> {
    if numbers(of).contains(&0) {
        return None;
    }
    Some(match last(of)?.as_str() {
        "T" => Form::Number,
        "Vector3" => Form::Vector(3),
        "SVector" => Form::Vector(*numbers(of).first()?),
        "Matrix3" => Form::Matrix(3, 3),
        "SMatrix" => match numbers(of)[..] {
            [rows, 1] => Form::Vector(rows),
            [rows, columns] => Form::Matrix(rows, columns),
            _ => return None,
        },
        "ReducedMatrix" => Form::Reduced,
        "Option" if last(types(of).first()?)? == "Vector3" => Form::Direction,
        "Surface" => Form::Surface,
        "Path" => Form::Path,
        "ContactMode" => Form::Mode,
        record @ ("Coordinates" | "Speeds" | "Inputs" | "Collision" | "ClosedContact" | "Derivatives"
        | "Linearisation") => Form::Record(record.to_owned()),
        _ => return None,
    })
}

/// The last part of a type's path.
fn last(of: &Type) -> Option<String> {
    match of {
        Type::Path(path) => Some(path.path.segments.last()?.ident.to_string()),
        _ => None,
    }
}

fn parameters(of: &Type) -> impl Iterator<Item = &GenericArgument> {
    let arguments = match of {
        Type::Path(path) => path.path.segments.last().map(|part| &part.arguments),
        _ => None,
    };
    let list = match arguments {
        Some(PathArguments::AngleBracketed(arguments)) => Some(&arguments.args),
        _ => None,
    };
    list.into_iter().flatten()
}

/// The types among the parameters of a type.
fn types(of: &Type) -> Vec<&Type> {
    let mut types = Vec::new();
    for parameter in parameters(of) {
        if let GenericArgument::Type(of) = parameter {
            types.push(of);
        }
    }
    types
}

/// The numbers among the parameters of a type.
fn numbers(of: &Type) -> Vec<usize> {
    let number = |parameter: &GenericArgument| match parameter {
        GenericArgument::Const(number) => literal(number),
        _ => None,
    };
    parameters(of).filter_map(number).collect()
}

fn literal(expression: &Expr) -> Option<usize> {
    match expression {
        Expr::Lit(number) => match &number.lit {
            Lit::Int(number) => number.base10_parse().ok(),
            _ => None,
        },
        _ => None,
    }
}

fn is_default_of(block: &syn::ItemImpl, name: &str) -> bool {
    let default = block.trait_.as_ref().and_then(|(path, _)| path.segments.last());
    default.is_some_and(|part| part.ident == "Default") && last(&block.self_ty).is_some_and(|of| of == name)
}

/// The text of the documentation, without the marks of links.
fn docs(attributes: &[Attribute]) -> String {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(text) => match &text.lit {
                Lit::Str(text) => Some(text.value().trim().replace("[`", "`").replace("`]", "`")),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    attributes.iter().filter_map(line).collect::<Vec<_>>().join("\n")
}
