//! Emits gaps and velocities of several contacts in one pass: a motion asks for them many times in every step.
//!
//! A routine computes the values that two contacts share, and a routine for each contact continues from there, as in
//! [`super::closed_contacts`]. The operations are those of the single methods, and so are the bits.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::Emitter;
use super::super::values::local;
use super::closed_contacts::Part;
use hodograph_program::program::operation::Value;
use hodograph_program::program::{ContactQuantity, Quantity};

/// How far a contact is from being closed.
const NEAR: [ContactQuantity; 2] = [ContactQuantity::Gap, ContactQuantity::Validity];

/// Routines of several contacts: what they share, and one for each.
pub(super) struct Family {
    /// their common name
    name: &'static str,
    /// what each answers
    answer: TokenStream,
    /// the routines
    pub routines: TokenStream,
    /// statements that compute what the contacts share
    begin: TokenStream,
    /// for each contact, the call of its routine
    calls: Vec<(usize, TokenStream)>,
}

impl Family {
    /// The call of the routine of a contact.
    fn call(&self, contact: usize) -> Option<&TokenStream> {
        self.calls.iter().find(|(of, _)| *of == contact).map(|(_, call)| call)
    }
}

impl Emitter<'_> {
    /// The methods `gaps` and `contact_velocities` of the trait, and their routines. For a single contact the single
    /// methods suffice.
    pub(super) fn several_in_one_pass(&self) -> (TokenStream, TokenStream) {
        let krate = self.krate;
        let with = |quantity: ContactQuantity| -> Vec<usize> {
            let contacts = 0..self.mechanism.contacts.len();
            contacts.filter(|&contact| self.contact_output(contact, quantity).is_some()).collect()
        };
        let (mut methods, mut routines) = (TokenStream::new(), TokenStream::new());
        let mut add = |family: Family, method: TokenStream| {
            if (0..self.mechanism.contacts.len()).any(|contact| self.is_feature(contact)) {
                routines.extend(self.one_of(&family));
            }
            routines.extend(family.routines);
            methods.extend(method);
        };
        let known = with(ContactQuantity::Gap);
        if known.len() > 1 {
            let distance = quote!(#krate::Distance<T>);
            let family = self.family("near", &known, &NEAR, distance.clone(), |contact| {
                let [gap, validity] = NEAR.map(|quantity| match &self.values_of(contact, quantity)[..] {
                    [value] => quote!(::core::option::Option::Some(#value)),
                    _ => quote!(::core::option::Option::None),
                });
                quote!(#krate::Distance { gap: #gap, validity: #validity })
            });
            let none = quote!(::core::result::Result::Ok(#krate::Distance::default()));
            let method = self.each(&family, ("gaps", "distances", "the distances"), &none);
            add(family, method);
        }
        let known = with(ContactQuantity::Velocity);
        if known.len() > 1 {
            let vector = quote!(#krate::nalgebra::Vector3<T>);
            let family = self.family("moving", &known, &[ContactQuantity::Velocity], vector, |contact| {
                let values = self.values_of(contact, ContactQuantity::Velocity);
                quote!(#krate::nalgebra::Vector3::new(#(#values),*))
            });
            let none = self.undefined("velocity of this contact");
            let method = self.each(&family, ("contact_velocities", "velocities", "the velocities"), &none);
            add(family, method);
        }
        (methods, routines)
    }

    /// The local variables that hold a quantity of a contact.
    pub(super) fn values_of(&self, contact: usize, quantity: ContactQuantity) -> Vec<Ident> {
        let output = self.contact_output(contact, quantity);
        output.map_or(Vec::new(), |output| output.values.iter().map(|&value| local(value)).collect())
    }

    /// Routines of quantities of contacts.
    pub(super) fn family(
        &self,
        name: &'static str,
        known: &[usize],
        of: &[ContactQuantity],
        answer: TokenStream,
        result: impl Fn(usize) -> TokenStream,
    ) -> Family {
        let krate = self.krate;
        let quantities = |contact: usize| -> Vec<Quantity> {
            let there = of.iter().filter(|of| self.contact_output(contact, **of).is_some());
            there.map(|&of| Quantity::Contact(contact as u32, of)).collect()
        };
        let of_each: Vec<Vec<Quantity>> = known.iter().map(|&contact| quantities(contact)).collect();
        let arguments = self.arguments(&of_each.concat());
        let (together, parts) = self.parts_of_contacts(&[], &of_each);
        let shared = self.shared(&together, &parts);
        let signature = self.signature(arguments);
        let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
        let count = Literal::usize_unsuffixed(shared.len());
        let first = format_ident!("{name}_together");
        let each = |contact: usize| format_ident!("{name}_{contact}");
        let begins = self.body_of_part(&together, &shared);
        let values = shared.iter().map(|&value| local(value));
        let routines = known.iter().zip(&parts).map(|(&contact, part)| {
            let (name, fetched) = (each(contact), self.fetched(part, &shared));
            let (body, result) = (self.body_of_part(part, &[]), result(contact));
            quote! {
                fn #name(
                    #signature
                    shared: &[T; #count],
                ) -> ::core::result::Result<#answer, #krate::StateError> {
                    #fetched
                    #body
                    ::core::result::Result::Ok(#result)
                }
            }
        });
        let routines = quote! {
            fn #first(
                #signature
                shared: &mut [T; #count],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #begins
                *shared = [#(#values),*];
                ::core::result::Result::Ok(())
            }
            #(#routines)*
        };
        let begin = quote! {
            #unpack
            let mut shared = [T::one(); #count];
            Self::#first(self, #passed &mut shared)?;
        };
        let call = |contact: usize| {
            let name = each(contact);
            quote!(Self::#name(self, #passed &shared))
        };
        let calls = known.iter().map(|&contact| (contact, call(contact))).collect();
        Family { name, answer, routines, begin, calls }
    }

    /// The method that takes the number of a contact.
    pub(super) fn one_of(&self, family: &Family) -> TokenStream {
        let krate = self.krate;
        let Family { name, answer, begin, calls, .. } = family;
        let method = format_ident!("{name}");
        let arms = calls.iter().map(|(contact, call)| {
            let number = Literal::usize_unsuffixed(*contact);
            quote!(#number => #call,)
        });
        quote! {
            fn #method(
                &self,
                contact: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#answer, #krate::StateError> {
                #begin
                match contact {
                    #(#arms)*
                    index => ::core::result::Result::Err(#krate::StateError::Missing {
                        kind: #krate::ComponentKind::Contact, index,
                    }),
                }
            }
        }
    }

    /// The method of the trait that fills a slice, which `what` describes in errors; `none` is the answer for a contact
    /// that has no routine.
    fn each(
        &self,
        family: &Family,
        (method, slice, what): (&str, &str, &str),
        none: &TokenStream,
    ) -> TokenStream {
        let krate = self.krate;
        let Family { answer, begin, .. } = family;
        let (method, slice) = (format_ident!("{method}"), format_ident!("{slice}"));
        let arms = self.by_contact(|contact| family.call(contact).unwrap_or(none).clone());
        quote! {
            fn #method(
                &self,
                contacts: &[usize],
                state: &#krate::State<'_, T>,
                #slice: &mut [#answer],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #krate::generated::check_length(#slice, contacts.len(), #what)?;
                #begin
                for (&contact, slot) in contacts.iter().zip(#slice) {
                    let found: ::core::result::Result<#answer, #krate::StateError> = #arms;
                    *slot = found?;
                }
                ::core::result::Result::Ok(())
            }
        }
    }

    /// The statements that take the shared values that a part needs.
    pub(super) fn fetched(&self, part: &Part<'_>, shared: &[Value]) -> TokenStream {
        let taken = self.taken(part);
        let statements =
            shared.iter().enumerate().filter(|(_, value)| taken.contains(value)).map(|(at, &value)| {
                let (at, name) = (Literal::usize_unsuffixed(at), local(value));
                quote!(let #name = shared[#at];)
            });
        quote!(#(#statements)*)
    }
}
