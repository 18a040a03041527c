//! Emits the implementation of the traits `Mechanism` and `Contacts`: it converts slices to the arguments of
//! the methods of the type, and their results to slices.

mod closed_contacts;
mod contacts;
mod description;
mod features;
mod geometry;
mod in_one_pass;
mod parts;
mod quantities;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::interface::InPlace;
use super::record::Record;
use super::routine::Arguments;
use hodograph_program::program::Quantity;

impl Emitter<'_> {
    /// Both implementations, with names and units.
    pub fn traits(&self) -> TokenStream {
        let krate = self.krate;
        let description = self.description();
        let mechanism = self.mechanism_trait();
        let (in_one_pass, routines) = self.closed_in_one_pass().unzip();
        let (several, of_several) = self.several_in_one_pass();
        let contacts = self.contacts_trait(quote!(#several #in_one_pass));
        let name = &self.name;
        let routines = quote!(#of_several #routines);
        let routines = (!routines.is_empty()).then(|| {
            quote! {
                /// Parts of `Contacts::closed_contacts`, `gaps` and `contact_velocities`.
                impl<T: #krate::Scalar> #name<T> { #routines }
            }
        });
        let features = self.feature_routines().map(|routines| {
            quote! {
                /// Contacts that have no methods of their own.
                impl<T: #krate::Scalar> #name<T> { #routines }
            }
        });
        quote! { #description #mechanism #contacts #routines #features }
    }

    fn mechanism_trait(&self) -> TokenStream {
        let (krate, name) = (self.krate, &self.name);
        let told = self.names_and_counts();
        let parameters = self.parameters_by_slices();
        let quantities = self.quantities_by_slices();
        let configuration = self.configuration_by_slices();
        let named = self.named_by_slices();
        let geometry = self.geometry_by_slices();
        quote! {
            /// The methods of the same names, with slices.
            impl<T: #krate::Scalar> #krate::Mechanism<T> for #name<T> {
                #told
                #parameters
                #(#quantities)*
                #configuration
                #named
                #geometry
            }
        }
    }

    /// The statements that convert a `State` to the arguments of a method.
    fn unpack(&self, arguments: Arguments) -> TokenStream {
        let krate = self.krate;
        let record = |used: bool, record: &Record, variable: TokenStream, slice: &str| {
            used.then(|| {
                let (name, size) = (record.name(), Literal::usize_unsuffixed(record.len()));
                let field = format_ident!("{slice}");
                quote! {
                    let #variable = &<#name<T> as ::core::convert::From<[T; #size]>>::from(
                        #krate::generated::array::<T, #size>(state.#field, #slice)?,
                    );
                }
            })
        };
        let time = arguments.time.then(|| quote!(let time = state.time;));
        let coordinates = record(arguments.coordinates, &self.coordinates, quote!(q), "coordinates");
        let speeds = record(arguments.speeds, &self.speeds, quote!(u), "speeds");
        let inputs = record(arguments.inputs, &self.inputs, quote!(inputs), "inputs");
        quote! {
            DESCRIPTION.check(state)?;
            #time #coordinates #speeds #inputs
        }
    }

    /// The call of the method of a quantity with the parts of a `State`.
    fn own(&self, quantity: Quantity) -> (TokenStream, TokenStream) {
        let method = crate::identifiers::ident(&quantity.method(self.mechanism).unwrap_or_default());
        self.own_method(&method, &[quantity])
    }

    /// The call of a method that computes quantities with the parts of a `State`.
    fn own_method(&self, method: &Ident, quantities: &[Quantity]) -> (TokenStream, TokenStream) {
        let arguments = self.arguments(quantities);
        (self.unpack(arguments), {
            let passed = self.passed(arguments);
            quote!(Self::#method(self, #passed))
        })
    }

    /// The statements that write a quantity into a slice; if the mechanism does not have it, the slice must
    /// be empty.
    fn written(&self, quantity: Quantity) -> TokenStream {
        let (_, what) = quantity.description().slice;
        self.written_to(quantity, &slice_of(quantity), what)
    }

    /// [`Self::written`] into the given slice; `what` describes its content in messages.
    fn written_to(&self, quantity: Quantity, slice: &Ident, what: &str) -> TokenStream {
        let krate = self.krate;
        let Some(output) = self.program.output(quantity).filter(|output| !output.values.is_empty()) else {
            return quote! {
                DESCRIPTION.check(state)?;
                #krate::generated::check_length(#slice, 0, #what)
            };
        };
        let numbers = |count: usize| Literal::usize_unsuffixed(count);
        let write = |value: TokenStream| match self.record_of(quantity) {
            Some(record) => {
                let size = numbers(record.len());
                quote!(#krate::generated::write_array::<T, #size>(#slice, #value, #what))
            }
            None => {
                let (rows, columns) = (numbers(output.rows), numbers(output.columns));
                quote!(#krate::generated::write_rows::<T, #rows, #columns>(#slice, &#value, #what))
            }
        };
        let (unpack, call) = self.own(quantity);
        let method = quantity.method(self.mechanism).unwrap_or_default();
        if let Some(InPlace { put, .. }) = self.in_place(&method, &[quantity]) {
            // Without the result of the method, which would be stored first and then copied.
            let arguments = self.passed(self.arguments(&[quantity]));
            let write = write(quote!(value));
            return quote!(#unpack self.#put(#arguments |value| #write));
        }
        let write = write(quote!(#call?));
        quote! { #unpack #write }
    }

    /// The statement that converts a slice to the given rates of the independent speeds.
    fn given_accelerations(&self) -> TokenStream {
        let krate = self.krate;
        if self.speeds.is_empty() {
            return quote!(#krate::generated::check_length(accelerations, 0, "the accelerations")?;);
        }
        let size = Literal::usize_unsuffixed(self.speeds.len());
        quote! {
            let acceleration = &<Speeds<T> as ::core::convert::From<[T; #size]>>::from(
                #krate::generated::array::<T, #size>(accelerations, "the accelerations")?,
            );
        }
    }

    /// A `match` over the indices of a kind; indices without an arm are an error.
    fn by_number(&self, number: &str, kind: &str, arms: Vec<(usize, TokenStream)>) -> TokenStream {
        let krate = self.krate;
        let (number, kind) = (format_ident!("{number}"), format_ident!("{kind}"));
        let arms = arms.into_iter().map(|(index, body)| {
            let index = Literal::usize_unsuffixed(index);
            quote!(#index => { #body })
        });
        quote! {
            match #number {
                #(#arms)*
                index => ::core::result::Result::Err(::core::convert::From::from(
                    #krate::StateError::Missing { kind: #krate::ComponentKind::#kind, index },
                )),
            }
        }
    }

    /// The error for a quantity that the program does not have.
    fn undefined(&self, what: &str) -> TokenStream {
        let krate = self.krate;
        quote! {
            ::core::result::Result::Err(::core::convert::From::from(#krate::StateError::Undefined { what: #what }))
        }
    }
}

/// The slice into which the traits write a quantity.
fn slice_of(quantity: Quantity) -> Ident {
    format_ident!("{}", quantity.description().slice.0)
}
