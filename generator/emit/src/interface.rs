//! The interface of a generated module as data: its structs, and its methods with the types of their
//! arguments and results. The Rust text and the interfaces of other languages are made from it.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use crate::identifiers::ident;
use crate::prose::docs;

/// The interface of a module.
#[derive(Clone, Debug)]
pub struct Interface {
    /// name of the module, in Rust raw if it is a keyword
    pub module: String,
    /// name of the mechanism's type
    pub mechanism: String,
    /// documentation of the module
    pub docs: String,
    /// number of scalars in the type of the mechanism
    pub numbers: usize,
    /// the structs that methods take and return
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
    /// whether the model states values for it, so that it implements `Default`
    pub stated: bool,
}

/// A field of a struct.
#[derive(Clone, Debug)]
pub struct Field {
    /// its name, in Rust raw if it is a keyword
    pub name: String,
    /// its documentation
    pub docs: String,
    /// its type
    pub of: Type,
}

/// A method without its body.
#[derive(Clone, Debug)]
pub struct Signature {
    /// its name, in Rust raw if it is a keyword
    pub name: String,
    /// its documentation
    pub docs: String,
    /// its arguments after `&self`
    pub arguments: Vec<Argument>,
    /// the type of its result
    pub answer: Type,
    /// its error
    pub failure: Failure,
    /// the methods that share its body, if the answer is long
    pub in_place: Option<InPlace>,
}

/// The methods of a routine with a long answer. The body is that of a private method: it hands the answer to
/// a function `put`, and returns what that makes of it: the answer itself, or nothing once it is stored.
#[derive(Clone, Debug)]
pub struct InPlace {
    /// the private method with the body
    pub put: Ident,
    /// the method that stores the answer in its last argument, `out`
    pub into: Ident,
}

/// An argument of a method. Numbers and enums are passed by value, others by reference.
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

/// The type of a field, an argument or a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Type {
    /// a number
    Number,
    /// a fixed number of values
    Array(Box<Type>, usize),
    /// a column vector
    Vector(usize),
    /// a matrix: numbers of rows and columns
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
    /// a surface, with or without a budget of quadratures
    BudgetedSurface,
    /// the law of restitution
    Law,
    /// the phases of a collision
    Path,
    /// the outcome of the impact solver
    Impact,
    /// its derivative
    ImpactDerivative,
    /// a saltation matrix with this number of states
    Saltation(usize),
    /// the mode of a closed contact
    Mode,
    /// whether other modes fit
    Selection,
    /// the margins of the mode
    Margins,
    /// mode and force in the type that all mechanisms share
    ContactOutcome,
}

impl Type {
    /// Numbers in rows and columns: a vector if there is one column of several numbers.
    pub fn of_shape(rows: usize, columns: usize) -> Self {
        if columns == 1 && rows != 1 { Self::Vector(rows) } else { Self::Matrix(rows, columns) }
    }

    /// A struct of the module.
    pub fn of_struct(name: &str) -> Self {
        Self::Struct(name.to_owned())
    }

    /// Whether arguments of this type are passed by value.
    fn is_small(&self) -> bool {
        matches!(self, Self::Number | Self::Law | Self::Mode)
    }

    /// The Rust type.
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
    /// The Rust type of the error.
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

    /// The struct in Rust, with these attributes.
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
    /// The Rust type of its result.
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
    /// the signature
    pub signature: Signature,
    /// such as `#[inline]`
    pub attributes: TokenStream,
    /// the statements
    pub body: TokenStream,
}

impl InPlace {
    /// Those of the routine of this name. The names of others begin with that of a quantity: none is
    /// `put_..`.
    pub fn of(name: &str) -> Self {
        let name = name.trim_start_matches("r#");
        Self { put: format_ident!("put_{name}"), into: format_ident!("{name}_into") }
    }
}

impl Method {
    /// The method in Rust, with those that share its body.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let Method { signature, attributes, body } = self;
        let (name, about) = (ident(&signature.name), docs(&signature.docs));
        let (arguments, result) = (declared(&signature.arguments, krate), signature.result(krate));
        let Some(InPlace { put, into }) = &signature.in_place else {
            return quote! {
                #about
                #attributes
                pub fn #name(&self, #arguments) -> #result { #body }
            };
        };
        let passed: Vec<Ident> =
            signature.arguments.iter().map(|argument| format_ident!("{}", argument.name)).collect();
        let (answer, failure) = (signature.answer.tokens(krate), signature.failure.tokens(krate));
        let in_place = docs(&format!(
            "[`Self::{name}`] in place: the answer is stored in `out` without a copy. After an error `out` may hold anything."
        ));
        quote! {
            #about
            #[inline]
            pub fn #name(&self, #arguments) -> #result {
                self.#put(#(#passed,)* ::core::result::Result::Ok)
            }
            #in_place
            #[inline]
            pub fn #into(&self, #arguments out: &mut #answer) -> ::core::result::Result<(), #failure> {
                self.#put(#(#passed,)* |value| {
                    *out = value;
                    ::core::result::Result::Ok(())
                })
            }
            #attributes
            fn #put<R: ::core::marker::Copy>(
                &self,
                #arguments
                put: impl ::core::ops::FnOnce(#answer) -> ::core::result::Result<R, #failure>,
            ) -> ::core::result::Result<R, #failure> {
                #body
            }
        }
    }
}

/// Methods with the private functions that they share.
#[derive(Default)]
pub struct Group {
    /// the methods
    pub methods: Vec<Method>,
    /// private functions and other items
    pub private: TokenStream,
    /// whether the methods are those of several states at once, too: they decide nothing for a state
    pub in_lanes: bool,
}

impl Group {
    /// The items in Rust.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let methods = self.methods.iter().map(|method| method.tokens(krate));
        let private = &self.private;
        quote!(#(#methods)* #private)
    }
}

impl From<Method> for Group {
    fn from(method: Method) -> Self {
        Self { methods: vec![method], ..Self::default() }
    }
}
