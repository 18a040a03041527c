//! Emits structs of named numbers: parameters, coordinates, speeds, inputs.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use crate::identifiers::ident;
use crate::interface::{self, Struct, Type};
use crate::prose::{fence, prose};
use hodograph_model::model::mechanism::Variable;

/// A struct of named numbers.
pub struct Record {
    name: Ident,
    docs: String,
    fields: Vec<Field>,
}

struct Field {
    name: Ident,
    /// the name, as the model spells it
    label: String,
    unit: String,
    docs: String,
    default: f64,
}

impl Record {
    /// A struct `name` with a field for each of the quantities; defaults are their values in the model, else
    /// 0.
    pub fn new<'a>(name: &str, docs: &str, quantities: impl Iterator<Item = &'a Variable>) -> Self {
        let fields = quantities
            .map(|quantity| {
                let text = if quantity.docs.is_empty() { &quantity.name } else { &quantity.docs };
                let text = prose(text);
                // the unit comes after the first sentence
                let (what, more) =
                    text.split_once('\n').map_or((text.as_str(), ""), |(what, more)| (what, more));
                let counted = unit(&quantity.unit);
                let docs = match (fence(what), more) {
                    (Some(_), _) => format!(" In {counted}.\n\n{text}"),
                    (None, "") => format!(" {}, in {counted}", what.trim_end_matches('.')),
                    (None, more) => format!(" {}, in {counted}\n{more}", what.trim_end_matches('.')),
                };
                let unit = if quantity.unit.is_empty() { "1" } else { &quantity.unit };
                Field {
                    name: ident(&quantity.name),
                    label: quantity.name.clone(),
                    unit: unit.to_owned(),
                    docs,
                    default: quantity.value.unwrap_or(0.0),
                }
            })
            .collect();
        Record { name: format_ident!("{name}"), docs: docs.to_string(), fields }
    }

    /// Gives a field another default.
    pub fn set_default(&mut self, index: usize, default: f64) {
        if let Some(field) = self.fields.get_mut(index) {
            field.default = default;
        }
    }

    /// Number of fields.
    pub fn len(&self) -> usize {
        self.fields.len()
    }

    /// Whether it has no fields.
    pub fn is_empty(&self) -> bool {
        self.fields.is_empty()
    }

    /// The name of the struct.
    pub fn name(&self) -> &Ident {
        &self.name
    }

    /// The name of a field.
    pub fn field(&self, index: usize) -> Ident {
        self.fields.get(index).map_or_else(|| format_ident!("_{index}"), |field| field.name.clone())
    }

    /// The names of the fields.
    pub fn fields(&self) -> impl Iterator<Item = &Ident> {
        self.fields.iter().map(|field| &field.name)
    }

    /// What it offers.
    pub fn structure(&self) -> Struct {
        let fields = self.fields.iter().map(|field| {
            let name = field.name.to_string();
            interface::Field::new(name.trim_start_matches("r#"), Type::Number, field.docs.trim())
        });
        // Dependent speeds are determined by the others.
        let stated = self.name != "DependentSpeeds";
        Struct { name: self.name.to_string(), docs: self.docs.clone(), fields: fields.collect(), stated }
    }

    /// A value of the struct from an expression per field.
    pub fn construct(&self, values: &[TokenStream]) -> TokenStream {
        let name = &self.name;
        let fields = self.fields();
        quote! { #name { #(#fields: #values),* } }
    }

    /// The struct and its conversions.
    pub fn tokens(&self, krate: &TokenStream) -> TokenStream {
        let Record { name, docs, fields } = self;
        let count = Literal::usize_unsuffixed(fields.len());
        let docs_of = fields.iter().map(|field| &field.docs);
        let names: Vec<&Ident> = self.fields().collect();
        let defaults = fields.iter().map(|field| number(krate, field.default));
        let spelled: Vec<String> = names.iter().map(|name| name.to_string()).collect();
        let order = format!(" In the order of the fields: {}.", spelled.join(", "));
        let docs = format!(" {docs}");
        let labels = fields.iter().map(|field| &field.label);
        let units = fields.iter().map(|field| &field.unit);
        let logged = logged(krate, &name.to_string(), &names);
        quote! {
            #[doc = #docs]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct #name<T = f64> { #(#[doc = #docs_of] pub #names: T),* }

            #krate::generated::serialize_record! { #name #count #(#names)* }
            #krate::generated::record! { #name #count #(#names #labels #units)* }
            #krate::generated::record_in_lanes! { #name #count #(#names)* }
            #logged

            /// The values that the model gives, and 0 where it gives none.
            impl<T: #krate::Scalar> ::core::default::Default for #name<T> {
                #[inline]
                fn default() -> Self {
                    Self { #(#names: #defaults),* }
                }
            }

            #[doc = #order]
            impl<T> ::core::convert::From<[T; #count]> for #name<T> {
                #[inline]
                fn from([#(#names),*]: [T; #count]) -> Self {
                    Self { #(#names),* }
                }
            }

            #[doc = #order]
            impl<T> ::core::convert::From<#name<T>> for [T; #count] {
                #[inline]
                fn from(#name { #(#names),* }: #name<T>) -> Self {
                    [#(#names),*]
                }
            }

            #[doc = #order]
            impl<T: #krate::Scalar> ::core::convert::From<#krate::nalgebra::SVector<T, #count>> for #name<T> {
                #[inline]
                fn from(vector: #krate::nalgebra::SVector<T, #count>) -> Self {
                    let [[#(#names),*]] = vector.data.0;
                    Self { #(#names),* }
                }
            }

            #[doc = #order]
            impl<T: #krate::Scalar> ::core::convert::From<#name<T>> for #krate::nalgebra::SVector<T, #count> {
                #[inline]
                fn from(#name { #(#names),* }: #name<T>) -> Self {
                    Self::from([#(#names),*])
                }
            }
        }
    }
}

/// The implementations of serialisation and logging for a struct of results.
pub fn outcome(krate: &TokenStream, name: &str, fields: &[&str]) -> TokenStream {
    let (record, count) = (ident(name), Literal::usize_unsuffixed(fields.len()));
    let names: Vec<Ident> = fields.iter().map(|field| ident(field)).collect();
    let logged = logged(krate, name, &names.iter().collect::<Vec<_>>());
    quote! {
        #krate::generated::serialize_outcome! { #record #count #(#names)* }
        #logged
    }
}

/// The implementation of logging on targets: one format string for the struct, since it must be a literal.
fn logged(krate: &TokenStream, name: &str, fields: &[&Ident]) -> TokenStream {
    let each: Vec<String> =
        fields.iter().map(|field| format!("{}: {{}}", field.to_string().trim_start_matches("r#"))).collect();
    let format = format!("{name} {{{{ {} }}}}", each.join(", "));
    let name = ident(name);
    quote! { #krate::generated::log! { #name #format #(#fields)* } }
}

/// A number in the generic scalar.
pub fn number(krate: &TokenStream, number: f64) -> TokenStream {
    let magnitude = if number.is_nan() {
        quote!(::core::f64::NAN)
    } else if number.is_infinite() {
        quote!(::core::f64::INFINITY)
    } else {
        let literal = Literal::f64_suffixed(number.abs());
        quote!(#literal)
    };
    let sign = if number < 0.0 { quote!(-) } else { quote!() };
    quote! { #krate::generated::number::<T>(#sign #magnitude) }
}

fn unit(unit: &str) -> &str {
    if unit.is_empty() || unit == "1" { "no unit" } else { unit }
}
