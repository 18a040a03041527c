//! Emits operations of a program as Rust statements.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::record::number;
use hodograph_model::arithmetic::Function;
use hodograph_program::program::graph::Input;
use hodograph_program::program::operation::{Operation, Stage, Value};

/// The local variable of a value.
pub fn local(value: Value) -> Ident {
    format_ident!("v{}", value.0)
}

/// The place of values that depend on parameters alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// in a method: fields of `self`
    Method,
    /// at construction: local variables, in double-double arithmetic
    Construction,
}

impl Emitter<'_> {
    /// The statement that computes a value; `None` if it needs none.
    pub fn statement(&self, value: Value, place: Place) -> Option<TokenStream> {
        let name = local(value);
        let operation = self.program.operation(value);
        if place == Place::Method && self.stage(value) == Stage::Parameter {
            let source = match operation {
                Operation::Input(input) => self.input(input, place),
                _ => {
                    let index = Literal::usize_unsuffixed(self.hoisted_index(value)?);
                    quote!(self.hoisted[#index])
                }
            };
            return Some(quote! { let #name = #source; });
        }
        if let Operation::SinCos(angle) = operation {
            let (angle, cosine) = (local(angle), format_ident!("{}c", name));
            let from = self.support(place);
            return Some(quote! { let (#name, #cosine) = #from::sin_cos(#angle); });
        }
        let expression = self.expression(operation, place);
        Some(quote! { let #name = #expression; })
    }

    fn expression(&self, operation: Operation, place: Place) -> TokenStream {
        let krate = self.krate;
        match operation {
            Operation::Constant(bits) => self.exactly(number(krate, bits.get()), place),
            Operation::Input(input) => self.exactly(self.input(input, place), place),
            Operation::Neg(a) => unary(quote!(-), a),
            Operation::Add(a, b) => binary(a, quote!(+), b),
            Operation::Sub(a, b) => binary(a, quote!(-), b),
            Operation::Mul(a, b) => binary(a, quote!(*), b),
            Operation::Div(a, b) => binary(a, quote!(/), b),
            Operation::Recip(a) => self.call(quote!(recip), &[a], place),
            Operation::MulAdd(a, b, c) => self.call(quote!(mul_add), &[a, b, c], place),
            Operation::MulSub(a, b, c) => self.call(quote!(mul_sub), &[a, b, c], place),
            Operation::NegMulAdd(a, b, c) => self.call(quote!(neg_mul_add), &[a, b, c], place),
            Operation::Sine(pair) | Operation::SinCos(pair) => {
                let pair = local(pair);
                quote!(#pair)
            }
            Operation::Cosine(pair) => {
                let cosine = format_ident!("{}c", local(pair));
                quote!(#cosine)
            }
            Operation::Call(function, a) => self.call(self::function(function), &[a], place),
            Operation::Call2(function, a, b) => self.call(self::function(function), &[a, b], place),
        }
    }

    fn call(&self, function: TokenStream, arguments: &[Value], place: Place) -> TokenStream {
        let from = self.support(place);
        let arguments = arguments.iter().map(|&argument| local(argument));
        quote!(#from::#function(#(#arguments),*))
    }

    /// The module of the runtime's support functions: at construction those in double-double arithmetic.
    fn support(&self, place: Place) -> TokenStream {
        let krate = self.krate;
        match place {
            Place::Method => quote!(#krate::generated),
            Place::Construction => quote!(#krate::generated::construction),
        }
    }

    /// An input in the precision of its place.
    fn exactly(&self, number: TokenStream, place: Place) -> TokenStream {
        let from = self.support(place);
        match place {
            Place::Method => number,
            Place::Construction => quote!(#from::exactly(#number)),
        }
    }

    /// The expression of an input.
    fn input(&self, input: Input, place: Place) -> TokenStream {
        let (record, variable, index) = match input {
            Input::Time => return quote!(time),
            Input::Parameter(index) => {
                let field = self.parameters.field(self.parameter_field(index));
                return match place {
                    Place::Method => quote!(self.parameters.#field),
                    Place::Construction => quote!(parameters.#field),
                };
            }
            Input::Coordinate(index) => (&self.coordinates, quote!(q), index),
            Input::Speed(index) => (&self.speeds, quote!(u), index),
            Input::Input(index) => (&self.inputs, quote!(inputs), index),
            Input::Acceleration(index) => (&self.speeds, quote!(acceleration), index),
            Input::Tangent(index) => {
                let index = Literal::usize_unsuffixed(index as usize);
                return quote!(tangent[#index]);
            }
        };
        let field = record.field(index as usize);
        quote!(#variable.#field)
    }
}

fn unary(operator: TokenStream, a: Value) -> TokenStream {
    let a = local(a);
    quote!(#operator #a)
}

fn binary(a: Value, operator: TokenStream, b: Value) -> TokenStream {
    let (a, b) = (local(a), local(b));
    quote!(#a #operator #b)
}

/// The support function of a function.
fn function(function: Function) -> TokenStream {
    match function {
        Function::Sin => quote!(sin),
        Function::Cos => quote!(cos),
        Function::Tan => quote!(tan),
        Function::Asin => quote!(asin),
        Function::Acos => quote!(acos),
        Function::Atan => quote!(atan),
        Function::Atan2 => quote!(atan2),
        Function::Sqrt => quote!(sqrt),
        Function::Exp => quote!(exp),
        Function::Log => quote!(log),
        Function::Sinh => quote!(sinh),
        Function::Cosh => quote!(cosh),
        Function::Tanh => quote!(tanh),
        Function::Abs => quote!(abs),
        Function::Sign => quote!(sign),
        Function::Min => quote!(min),
        Function::Max => quote!(max),
        Function::Frozen => quote!(frozen),
    }
}
