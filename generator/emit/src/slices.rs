//! Emits the implementation of the traits `Mechanism` and `Contacts`: it converts slices to the arguments of
//! the type's own methods, and their results to slices.

mod closed_contacts;
mod contacts;
mod description;
mod geometry;
mod quantities;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::Emitter;
use super::record::Record;
use super::routine::Arguments;
use hodograph_program::program::Quantity;

impl Emitter<'_> {
    /// Both implementations, with the names and units that they tell.
    pub fn traits(&self) -> TokenStream {
        let krate = self.krate;
        let description = self.description();
        let mechanism = self.mechanism_trait();
        let (in_one_pass, routines) = self.closed_in_one_pass().unzip();
        let contacts = self.contacts_trait(in_one_pass);
        let name = &self.name;
        let routines = routines.map(|routines| {
            quote! {
                /// Parts of `Contacts::closed_contacts`.
                impl<T: #krate::Scalar> #name<T> { #routines }
            }
        });
        quote! { #description #mechanism #contacts #routines }
    }

    fn mechanism_trait(&self) -> TokenStream {
        let (krate, name) = (self.krate, &self.name);
        let told = self.told();
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

    /// The statements that make the arguments of a method of a `State`.
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

    /// The type's own method of a quantity, called with what a `State` gives.
    fn own(&self, quantity: Quantity) -> (TokenStream, TokenStream) {
        let method = crate::identifiers::ident(&quantity.method(self.mechanism).unwrap_or_default());
        self.own_method(&method, &[quantity])
    }

    /// The type's own method that computes quantities, called with what a `State` gives.
    fn own_method(&self, method: &Ident, quantities: &[Quantity]) -> (TokenStream, TokenStream) {
        let arguments = self.arguments(quantities);
        (self.unpack(arguments), {
            let passed = self.passed(arguments);
            quote!(Self::#method(self, #passed))
        })
    }

    /// The statements that write a quantity into a slice; where the mechanism has none, the slice must be
    /// empty.
    fn written(&self, quantity: Quantity) -> TokenStream {
        let (_, what) = quantity.description().slice;
        self.written_to(quantity, &slice_of(quantity), what)
    }

    /// [`Self::written`], into that slice; `what` is in it.
    fn written_to(&self, quantity: Quantity, slice: &Ident, what: &str) -> TokenStream {
        let krate = self.krate;
        let Some(output) = self.program.output(quantity).filter(|output| !output.values.is_empty()) else {
            return quote! {
                DESCRIPTION.check(state)?;
                #krate::generated::check_length(#slice, 0, #what)
            };
        };
        let (unpack, call) = self.own(quantity);
        if quantity == Quantity::MassMatrix && self.answers_in_place(&[quantity]) {
            // Computed here: the method's answer would be stored in one place and then in the other.
            let (compute, (_, value)) = (self.compute(&[quantity]), self.shaped(output));
            let (rows, columns) =
                (Literal::usize_unsuffixed(output.rows), Literal::usize_unsuffixed(output.columns));
            return quote! {
                #unpack
                #compute
                #krate::generated::write_rows::<T, #rows, #columns>(#slice, &#value, #what)
            };
        }
        let write = match self.record_of(quantity) {
            Some(record) => {
                let size = Literal::usize_unsuffixed(record.len());
                quote!(#krate::generated::write_array::<T, #size>(#slice, #call?, #what))
            }
            None => {
                let (rows, columns) =
                    (Literal::usize_unsuffixed(output.rows), Literal::usize_unsuffixed(output.columns));
                quote!(#krate::generated::write_rows::<T, #rows, #columns>(#slice, &#call?, #what))
            }
        };
        quote! { #unpack #write }
    }

    /// The statement that makes the given rates of the independent speeds of a slice.
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

    /// A `match` over the numbers of a kind; what has no arm has no such thing.
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

    /// What is written where the program does not have a quantity.
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
