//! Emits the checks of masses, inertias and dimensions of shapes in the constructor, where they depend on parameters only.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::record::number;
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::{Body, DefinitionValue, Scalar};

/// Expressions that are nested deeper than this are not checked.
const DEPTH: usize = 64;

impl Emitter<'_> {
    /// The checks of all bodies.
    pub fn body_checks(&self) -> TokenStream {
        let krate = self.krate;
        let checks = self.mechanism.bodies.iter().map(|body| {
            let name = &body.name;
            let mass = self
                .scalar(&body.mass, DEPTH)
                .map(|mass| quote!(#krate::generated::check_mass::<T>(#mass, #name)?;));
            let inertia = self
                .inertia(body)
                .map(|inertia| quote!(#krate::generated::check_inertia::<T>([#(#inertia),*], #name)?;));
            quote! { #mass #inertia }
        });
        quote! { #(#checks)* }
    }

    /// Checks of the dimensions of shapes that depend on parameters alone.
    pub fn shape_checks(&self) -> TokenStream {
        let krate = self.krate;
        let checks = self.mechanism.shapes.iter().flat_map(|shape| {
            let name = &shape.name;
            shape.dimensions().filter_map(move |dimension| {
                let varies = !matches!(dimension.value, Scalar::Number(_));
                let size = varies.then(|| self.scalar(&dimension.value, DEPTH)).flatten()?;
                let dimension = dimension.name;
                Some(quote!(#krate::generated::check_size::<T>(#size, #name, #dimension)?;))
            })
        });
        quote! { #(#checks)* }
    }

    /// The inertia components of a body. Components about another point than the mass centre must be
    /// possible, too.
    fn inertia(&self, body: &Body) -> Option<Vec<TokenStream>> {
        body.inertia.as_ref()?.components.iter().map(|component| self.scalar(component, DEPTH)).collect()
    }

    /// An expression of parameters alone; `None` for any other.
    fn scalar(&self, scalar: &Scalar, depth: usize) -> Option<TokenStream> {
        let depth = depth.checked_sub(1)?;
        let krate = self.krate;
        let of = |scalar: &Scalar| self.scalar(scalar, depth);
        let all = |scalars: &[Scalar]| scalars.iter().map(of).collect::<Option<Vec<_>>>();
        Some(match scalar {
            Scalar::Number(value) => number(krate, value.to_f64()),
            Scalar::Pi => number(krate, std::f64::consts::PI),
            Scalar::Parameter(id) => {
                let parameter = self.mechanism.parameters.get(id.0)?;
                if parameter.fixed {
                    return None;
                }
                let field = self.parameters.field(self.parameter_field(id.0 as u32));
                quote!(parameters.#field)
            }
            Scalar::Definition(id) => match &self.mechanism.definitions.get(id.0)?.value {
                DefinitionValue::Scalar(scalar) => of(scalar)?,
                DefinitionValue::Vector(_) => return None,
            },
            Scalar::Neg(a) => {
                let a = of(a)?;
                quote!((-#a))
            }
            Scalar::Add(terms) => {
                let terms = all(terms)?;
                quote!((#(#terms)+*))
            }
            Scalar::Mul(factors) => {
                let mut factors = all(factors)?.into_iter();
                let first = factors.next()?;
                quote!((#first #(* #factors)*))
            }
            Scalar::Div(a, b, _) => {
                let (a, b) = (of(a)?, of(b)?);
                quote!((#a / #b))
            }
            Scalar::Pow(base, exponent) => {
                let base = of(base)?;
                match &**exponent {
                    Scalar::Number(n) if n.to_integer().is_some_and(|n| i32::try_from(n).is_ok()) => {
                        let n = Literal::i64_unsuffixed(n.to_integer()?.abs());
                        let power = quote!(#krate::generated::power(#base, #n));
                        if matches!(&**exponent, Scalar::Number(n) if n.is_negative()) {
                            quote!(#krate::generated::recip(#power))
                        } else {
                            power
                        }
                    }
                    exponent => {
                        let exponent = of(exponent)?;
                        quote!(#krate::generated::exp(#krate::generated::log(#base) * #exponent))
                    }
                }
            }
            Scalar::Call(Function::Sqrt, arguments) => {
                let arguments = all(arguments)?;
                quote!(#krate::generated::sqrt(#(#arguments),*))
            }
            Scalar::Call(Function::Abs, arguments) => {
                let arguments = all(arguments)?;
                quote!(#krate::generated::abs(#(#arguments),*))
            }
            _ => return None,
        })
    }
}
