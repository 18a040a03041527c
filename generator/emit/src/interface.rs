//! What a generated module offers, as data: its structs, and its methods with the types of what they take and
//! give. The Rust text and the interfaces of other languages are made from it.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use crate::identifiers::{docs, ident};

/// What a module offers.
#[derive(Clone, Debug)]
pub struct Interface {
    /// name of the module
    pub module: String,
    /// name of the mechanism's type
    pub mechanism: String,
    /// documentation of the module
    pub docs: String,
    /// how many numbers the type of the mechanism holds
    pub numbers: usize,
    /// the structs that methods take and give
    pub structures: Vec<Struct>,
    /// the methods of the mechanism's type that take `&self`
    pub methods: Vec<Signature>,
}

/// A struct.
#[derive(Clone, Debug)]
pub struct Struct {
    /// its name
    pub name: String,
    /// its documentation
    pub docs: String,
    /// its fields, in order
    pub fields: Vec<Field>,
    /// whether the model states a value of it: it implements `Default`
    pub stated: bool,
}

/// A field of a struct.
#[derive(Clone, Debug)]
pub struct Field {
    /// its name, in Rust raw where it is a keyword
    pub name: String,
    /// its documentation
    pub docs: String,
    /// its type
    pub of: Type,
}

/// A method but for its body.
#[derive(Clone, Debug)]
pub struct Signature {
    /// its name, in Rust raw where it is a keyword
    pub name: String,
    /// its documentation
    pub docs: String,
    /// what it takes after `&self`
    pub arguments: Vec<Argument>,
    /// what it gives where it does not fail
    pub answer: Type,
    /// how it fails
    pub failure: Failure,
}

/// An argument of a method. Numbers and enums are handed over by value, all else by reference.
#[derive(Clone, Debug)]
pub struct Argument {
    /// its name
    pub name: &'static str,
    /// its type
    pub of: Type,
}

/// The error of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// the state is singular, or a result is not finite
    State,
    /// also: the collision has no outcome
    Collision,
    /// also: the closed contact has no force
    ClosedContact,
}

/// The type of a field, an argument or an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Type {
    /// a number
    Number,
    /// so many values
    Array(Box<Type>, usize),
    /// a column of so many numbers
    Vector(usize),
    /// a matrix of so many rows and columns
    Matrix(usize, usize),
    /// two values
    Pair(Box<Type>, Box<Type>),
    /// a value that may be missing
    Optional(Box<Type>),
    /// a struct of the module, by its name
    Struct(String),
    /// the reduced mass matrix of a contact
    Reduced,
    /// gap, basis, velocity and reduced matrix of a contact
    ContactState,
    /// friction and restitution
    Surface,
    /// the same, with a budget of quadratures or without
    BudgetedSurface,
    /// the law of restitution
    Law,
    /// the phases of a collision
    Path,
    /// the outcome of the impact solver
    Impact,
    /// its derivative
    ImpactDerivative,
    /// a saltation matrix of so many states
    Saltation(usize),
    /// what a closed contact does
    Mode,
    /// whether other modes fit
    Selection,
    /// how far the mode is from its end
    Margins,
    /// mode and force in the type that all mechanisms share
    ContactOutcome,
}

impl Type {
    /// Numbers in rows and columns: a vector where there is one column of several numbers.
    pub fn of_shape(rows: usize, columns: usize) -> Self {
        if columns == 1 && rows != 1 { Self::Vector(rows) } else { Self::Matrix(rows, columns) }
    }

    /// A struct of the module.
    pub fn of_struct(name: &str) -> Self {
        Self::Struct(name.to_owned())
    }

    /// Whether arguments of this type are handed over by value.
    fn is_small(&self) -> bool {
        matches!(self, Self::Number | Self::Law | Self::Mode)
    }

    /// How Rust writes it.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let size = |number: &usize| Literal::usize_unsuffixed(*number);
        match self {
            Self::Number => quote!(T),
            Self::Array(of, count) => {
                let (of, count) = (of.tokens(krate), size(count));
                quote!([#of; #count])
            }
            Self::Vector(3) => quote!(#krate::nalgebra::Vector3<T>),
            Self::Vector(rows) => {
                let rows = size(rows);
                quote!(#krate::nalgebra::SVector<T, #rows>)
            }
            Self::Matrix(3, 3) => quote!(#krate::nalgebra::Matrix3<T>),
            Self::Matrix(rows, columns) => {
                let (rows, columns) = (size(rows), size(columns));
                quote!(#krate::nalgebra::SMatrix<T, #rows, #columns>)
            }
            Self::Pair(first, second) => {
                let (first, second) = (first.tokens(krate), second.tokens(krate));
                quote!((#first, #second))
            }
            Self::Optional(of) => {
                let of = of.tokens(krate);
                quote!(::core::option::Option<#of>)
            }
            Self::Struct(name) => {
                let name = format_ident!("{name}");
                quote!(#name<T>)
            }
            Self::Reduced => quote!(#krate::ReducedMatrix<T>),
            Self::ContactState => quote!(#krate::ContactState<T>),
            Self::Surface => quote!(#krate::Surface<T>),
            Self::BudgetedSurface => quote!(impl #krate::ContactSurface<T>),
            Self::Law => quote!(#krate::Law),
            Self::Path => quote!(#krate::Path),
            Self::Impact => quote!(#krate::Impact<T>),
            Self::ImpactDerivative => quote!(#krate::ImpactDerivative<T>),
            Self::Saltation(states) => {
                let states = size(states);
                quote!(#krate::Saltation<T, #states>)
            }
            Self::Mode => quote!(#krate::ContactMode),
            Self::Selection => quote!(#krate::Selection),
            Self::Margins => quote!(#krate::Margins<T>),
            Self::ContactOutcome => quote!(#krate::ContactOutcome<T>),
        }
    }
}

impl Failure {
    /// The error in Rust.
    pub fn tokens(self, krate: &TokenStream) -> TokenStream {
        match self {
            Self::State => quote!(#krate::StateError),
            Self::Collision => quote!(#krate::CollisionError<T>),
            Self::ClosedContact => quote!(#krate::ClosedContactError<T>),
        }
    }
}

impl Field {
    /// A field of this name.
    pub fn new(name: &str, of: Type, docs: &str) -> Self {
        Self { name: name.to_owned(), docs: docs.to_owned(), of }
    }
}

impl Struct {
    /// The struct of results of this name.
    pub fn of_results(name: &str, docs: &str, fields: Vec<Field>) -> Self {
        Self { name: name.to_owned(), docs: docs.to_owned(), fields, stated: false }
    }

    /// The names of its fields.
    pub fn names(&self) -> Vec<&str> {
        self.fields.iter().map(|field| field.name.as_str()).collect()
    }

    /// The struct in Rust, after these attributes.
    pub fn tokens(&self, krate: &TokenStream, attributes: &TokenStream) -> TokenStream {
        let (name, about) = (format_ident!("{}", self.name), docs(&self.docs));
        let fields = self.fields.iter().map(|field| {
            let (name, about, of) = (ident(&field.name), docs(&field.docs), field.of.tokens(krate));
            quote!(#about pub #name: #of)
        });
        quote! {
            #about
            #[derive(Clone, Copy, Debug, PartialEq)]
            #[must_use]
            #attributes
            pub struct #name<T: #krate::nalgebra::Scalar = f64> { #(#fields),* }
        }
    }
}

impl Signature {
    /// What it answers in Rust.
    pub fn result(&self, krate: &TokenStream) -> TokenStream {
        let (answer, failure) = (self.answer.tokens(krate), self.failure.tokens(krate));
        quote!(::core::result::Result<#answer, #failure>)
    }
}

/// The arguments of a method in Rust, after `&self`.
pub fn declared(arguments: &[Argument], krate: &TokenStream) -> TokenStream {
    let each = arguments.iter().map(|Argument { name, of }| {
        let (name, by) = (format_ident!("{name}"), (!of.is_small()).then(|| quote!(&)));
        let of = of.tokens(krate);
        quote!(#name: #by #of,)
    });
    quote!(#(#each)*)
}

/// A method: its signature, attributes and body.
pub struct Method {
    /// what stands before the body
    pub signature: Signature,
    /// such as `#[inline]`
    pub attributes: TokenStream,
    /// the statements
    pub body: TokenStream,
}

impl Method {
    /// The method in Rust.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let Method { signature, attributes, body } = self;
        let (name, about) = (ident(&signature.name), docs(&signature.docs));
        let (arguments, result) = (declared(&signature.arguments, krate), signature.result(krate));
        quote! {
            #about
            #attributes
            pub fn #name(&self, #arguments) -> #result { #body }
        }
    }
}

/// Methods with the private functions that they share.
#[derive(Default)]
pub struct Group {
    /// the methods
    pub methods: Vec<Method>,
    /// what they call, or what is no method
    pub private: TokenStream,
}

impl Group {
    /// Its tokens in Rust.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let methods = self.methods.iter().map(|method| method.tokens(krate));
        let private = &self.private;
        quote!(#(#methods)* #private)
    }
}

impl From<Method> for Group {
    fn from(method: Method) -> Self {
        Self { methods: vec![method], private: TokenStream::new() }
    }
}
