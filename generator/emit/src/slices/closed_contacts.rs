//! Emits the computation, in one pass, of the quantities for the forces of closed contacts: rates of the
//! mechanism, and partial velocities, responses, velocities and free accelerations of the contacts that the
//! caller names.
//!
//! One routine computes the rates and the values that all contacts share (kinematics, the factors of the mass
//! matrix), one for each pair of shapes those that its contacts do. Then a routine for each contact continues from
//! these values. The operations are those of the single methods, and so are the bits.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::Emitter;
use super::super::routine::Arguments;
use super::super::values::local;
use super::in_one_pass::{Answer, CallsOfPair};
use super::parts::{Divided, OfPair, Part};
use hodograph_program::program::operation::Value;
use hodograph_program::program::{ContactQuantity, Quantity};

/// The quantities of the whole mechanism.
const OF_MECHANISM: [Quantity; 2] = [Quantity::CoordinateRates, Quantity::Accelerations];
/// The quantities of each contact, in the order of the slices of its routine.
const OF_CONTACT: [ContactQuantity; 4] = [
    ContactQuantity::PartialVelocities,
    ContactQuantity::Response,
    ContactQuantity::Velocity,
    ContactQuantity::FreeAcceleration,
];
/// The names of these slices, and their descriptions in errors.
const SLICES: [(&str, &str); 4] = [
    ("partial_velocities", "the partial velocities"),
    ("response", "the response"),
    ("velocity", "the velocity"),
    ("free_acceleration", "the free acceleration"),
];

impl Emitter<'_> {
    /// The method of the trait and its routines; `None` if the program lacks a quantity that they need.
    pub(super) fn closed_in_one_pass(&self) -> Option<(TokenStream, TokenStream)> {
        let has = |quantity| self.program.output(quantity).is_some_and(|output| !output.values.is_empty());
        let known: Vec<usize> = (0..self.mechanism.contacts.len())
            .filter(|&contact| OF_CONTACT.into_iter().all(|of| self.contact_output(contact, of).is_some()))
            .collect();
        // For a single contact the single methods suffice, and the module stays shorter.
        if known.len() < 2 || !OF_MECHANISM.into_iter().all(has) {
            return None;
        }
        let divided = self.divided(&OF_MECHANISM, &known, &OF_CONTACT);
        let arguments = self.arguments_in_one_pass(&known);
        let mut routines = self.routine_together(arguments, &divided.together, &divided.shared);
        let several = divided.pairs.len() > 1;
        for pair in &divided.pairs {
            if several {
                let (name, all) = (ident_of_pair(pair), Some(&divided.shared[..]));
                routines.extend(self.routine_that_shares(
                    &name,
                    arguments,
                    &pair.together,
                    &pair.shared,
                    all,
                ));
            }
            for (contact, part) in &pair.contacts {
                let shared = [&divided.shared[..], &pair.shared];
                routines.extend(self.routine_of_contact(arguments, *contact, part, shared, several));
            }
        }
        Some((self.method_in_one_pass(arguments, &divided), routines))
    }

    fn arguments_in_one_pass(&self, known: &[usize]) -> Arguments {
        let each = |&contact: &usize| OF_CONTACT.map(|of| Quantity::Contact(contact as u32, of));
        let quantities: Vec<Quantity> = OF_MECHANISM.into_iter().chain(known.iter().flat_map(each)).collect();
        self.arguments(&quantities)
    }

    /// The statement that writes results into a slice.
    fn fill(&self, slice: &Ident, values: &[Value], what: &str) -> TokenStream {
        let krate = self.krate;
        let (size, values) =
            (Literal::usize_unsuffixed(values.len()), values.iter().map(|&value| local(value)));
        quote!(#krate::generated::write_array::<T, #size>(#slice, [#(#values),*], #what)?;)
    }

    fn routine_together(&self, arguments: Arguments, part: &Part<'_>, shared: &[Value]) -> TokenStream {
        let krate = self.krate;
        let signature = self.signature(arguments);
        let body = self.body_of_part(part, shared);
        let count = Literal::usize_unsuffixed(shared.len());
        let shared = shared.iter().map(|&value| local(value));
        let rates = part.results.split_at(self.coordinates.len());
        let coordinates =
            self.fill(&format_ident!("coordinate_rates"), rates.0, "the rates of the coordinates");
        let speeds = self.fill(&format_ident!("accelerations"), rates.1, "the accelerations");
        quote! {
            fn closed_together(
                #signature
                coordinate_rates: &mut [T],
                accelerations: &mut [T],
                shared: &mut [T; #count],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #body
                *shared = [#(#shared),*];
                #coordinates
                #speeds
                ::core::result::Result::Ok(())
            }
        }
    }

    fn routine_of_contact(
        &self,
        arguments: Arguments,
        contact: usize,
        part: &Part<'_>,
        [shared, of_pair]: [&[Value]; 2],
        several: bool,
    ) -> TokenStream {
        let krate = self.krate;
        let name = ident_of(contact);
        let signature = self.signature(arguments);
        let count = Literal::usize_unsuffixed(shared.len());
        let (more, _) = self.of_pair_as_argument(several, of_pair.len());
        let (fetched, fetched_of_pair) =
            (self.fetched(part, shared, "shared"), self.fetched(part, of_pair, "of_pair"));
        let body = self.body_of_part(part, &[]);
        let mut results = &part.results[..];
        let written = OF_CONTACT.into_iter().zip(SLICES).map(|(of, (slice, what))| {
            let count = self.contact_output(contact, of).map_or(0, |output| output.values.len());
            let (these, rest) = results.split_at(count);
            results = rest;
            self.fill(&format_ident!("{slice}"), these, what)
        });
        let written: Vec<TokenStream> = written.collect();
        let slices = SLICES.map(|(slice, _)| format_ident!("{slice}"));
        quote! {
            fn #name(
                #signature
                shared: &[T; #count],
                #more
                #(#slices: &mut [T],)*
            ) -> ::core::result::Result<(), #krate::StateError> {
                #fetched
                #fetched_of_pair
                #body
                #(#written)*
                ::core::result::Result::Ok(())
            }
        }
    }

    fn method_in_one_pass(&self, arguments: Arguments, divided: &Divided<'_>) -> TokenStream {
        let krate = self.krate;
        let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
        let [n, p, three_p, shared] =
            [self.coordinates.len(), self.speeds.len(), 3 * self.speeds.len(), divided.shared.len()]
                .map(Literal::usize_unsuffixed);
        let pairs: Vec<CallsOfPair> = divided
            .pairs
            .iter()
            .map(|pair| self.calls_of_pair(pair, &passed, divided.pairs.len() > 1))
            .collect();
        let answer = Answer {
            of: quote!(()),
            slot: quote!(((partial_velocities, response), (velocity, free_acceleration))),
            put: quote!(found?;),
            none: self.undefined("closed contact"),
        };
        let each = self.pair_by_pair(&pairs, &answer);
        quote! {
            fn closed_contacts(
                &self,
                contacts: &[usize],
                state: &#krate::State<'_, T>,
                values: &mut #krate::ClosedContacts<'_, T>,
            ) -> ::core::result::Result<(), #krate::StateError> {
                values.check(contacts.len(), #n, #p)?;
                #unpack
                let mut shared = [T::one(); #shared];
                Self::closed_together(
                    self, #passed &mut *values.coordinate_rates, &mut *values.accelerations, &mut shared,
                )?;
                let matrices = values
                    .partial_velocities
                    .chunks_exact_mut(#three_p)
                    .zip(values.responses.chunks_exact_mut(#three_p));
                let vectors =
                    values.velocities.chunks_exact_mut(3).zip(values.free_accelerations.chunks_exact_mut(3));
                let slots = matrices.zip(vectors);
                #each
                ::core::result::Result::Ok(())
            }
        }
    }

    fn calls_of_pair(&self, pair: &OfPair<'_>, passed: &TokenStream, several: bool) -> CallsOfPair {
        let mut begin = TokenStream::new();
        if several {
            let (first, count) = (ident_of_pair(pair), Literal::usize_unsuffixed(pair.shared.len()));
            begin = quote! {
                let mut of_pair = [T::one(); #count];
                Self::#first(self, #passed &shared, &mut of_pair)?;
            };
        }
        let (_, more) = self.of_pair_as_argument(several, pair.shared.len());
        let slices = SLICES.map(|(slice, _)| format_ident!("{slice}"));
        let calls = pair.contacts.iter().map(|(contact, _)| {
            let name = ident_of(*contact);
            (*contact, quote!(Self::#name(self, #passed &shared, #more #(#slices),*)))
        });
        CallsOfPair { begin, calls: calls.collect() }
    }
}

/// The name of the routine of what the contacts of a pair share.
fn ident_of_pair(pair: &OfPair<'_>) -> Ident {
    format_ident!("closed_of_pair_{}", pair.contacts.first().map_or(0, |(contact, _)| *contact))
}

/// The name of the routine of a contact.
fn ident_of(contact: usize) -> Ident {
    format_ident!("closed_{contact}")
}
