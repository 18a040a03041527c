//! Emits the computation, in one pass, of the quantities for the forces of closed contacts: rates of the
//! mechanism, and partial velocities, responses, velocities and free accelerations of the contacts that the
//! caller names.
//!
//! One routine computes the rates and every value that two contacts share (kinematics, the factors of the
//! mass matrix). Then a routine for each contact continues from these values. The operations are those of the
//! single methods, and so are the bits.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::Emitter;
use super::super::routine::Arguments;
use super::super::storage::Storage;
use super::super::values::local;
use hodograph_program::program::operation::{Operation, Stage, Value};
use hodograph_program::program::{ContactQuantity, Guard, Quantity};

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

/// The work of a routine: values in order, guards, results.
pub(super) struct Part<'p> {
    order: Vec<Value>,
    guards: Vec<&'p Guard>,
    results: Vec<Value>,
}

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
        let each =
            known.iter().map(|&contact| OF_CONTACT.map(|of| Quantity::Contact(contact as u32, of)).to_vec());
        let (together, parts) = self.parts_of_contacts(&OF_MECHANISM, &each.collect::<Vec<_>>());
        let shared = self.shared(&together, &parts);
        let arguments = self.arguments_in_one_pass(&known);
        let mut routines = self.routine_together(arguments, &together, &shared);
        for (&contact, part) in known.iter().zip(&parts) {
            routines.extend(self.routine_of_contact(arguments, contact, part, &shared));
        }
        Some((self.method_in_one_pass(arguments, &known, shared.len()), routines))
    }

    fn arguments_in_one_pass(&self, known: &[usize]) -> Arguments {
        let each = |&contact: &usize| OF_CONTACT.map(|of| Quantity::Contact(contact as u32, of));
        let quantities: Vec<Quantity> = OF_MECHANISM.into_iter().chain(known.iter().flat_map(each)).collect();
        self.arguments(&quantities)
    }

    /// The work for quantities of the mechanism and for all contacts, and then for each of these.
    pub(super) fn parts_of_contacts(
        &self,
        of_mechanism: &[Quantity],
        of_each: &[Vec<Quantity>],
    ) -> (Part<'_>, Vec<Part<'_>>) {
        let late = |guard: &&Guard| self.guard_stage(guard) > Stage::Parameter;
        let part = |quantities: &[Quantity]| {
            let slice = self.program.slice(quantities);
            let results: Vec<Value> =
                slice.outputs.iter().flat_map(|output| output.values.iter().copied()).collect();
            let needed = self.needed(&results, &slice.guards);
            let order = slice.order.iter().copied().filter(|value| needed.contains(value)).collect();
            Part { order, guards: slice.guards.into_iter().filter(late).collect(), results }
        };
        let mut together = part(of_mechanism);
        let mut parts: Vec<Part<'_>> = of_each.iter().map(|quantities| part(quantities)).collect();
        let mut uses: BTreeMap<Value, usize> = together.order.iter().map(|&value| (value, 2)).collect();
        for &value in parts.iter().flat_map(|part| &part.order).filter(|&&value| self.is_work(value)) {
            *uses.entry(value).or_default() += 1;
        }
        let is_shared = |value: Value| uses.get(&value).is_some_and(|&count| count > 1);
        let mut common: BTreeSet<Value> =
            uses.keys().copied().filter(|&value| self.is_work(value) && is_shared(value)).collect();
        // A sine or cosine is computed in the same routine as its pair.
        for &value in parts.iter().flat_map(|part| &part.order) {
            if let Operation::Sine(pair) | Operation::Cosine(pair) = self.program.operation(value)
                && common.contains(&pair)
            {
                common.insert(value);
            }
        }
        let checked: BTreeSet<Value> = together.guards.iter().map(|guard| guard.value).collect();
        let mut known: BTreeSet<Value> = together.order.iter().copied().collect();
        for part in &mut parts {
            for &value in &part.order {
                if (common.contains(&value) || !self.is_work(value)) && known.insert(value) {
                    together.order.push(value);
                }
            }
            part.order.retain(|value| !common.contains(value));
            part.guards.retain(|guard| !checked.contains(&guard.value));
        }
        let order = |order: &[Value]| self.program.with_few_live(order, |value| !self.is_work(value));
        together.order = order(&together.order);
        parts.iter_mut().for_each(|part| part.order = order(&part.order));
        (together, parts)
    }

    /// The values of the common routine that the routines of contacts use.
    pub(super) fn shared(&self, together: &Part<'_>, parts: &[Part<'_>]) -> Vec<Value> {
        let computed: BTreeSet<Value> =
            together.order.iter().copied().filter(|&value| self.is_work(value)).collect();
        let mut shared = BTreeSet::new();
        for part in parts {
            shared.extend(self.taken(part).into_iter().filter(|value| computed.contains(value)));
        }
        shared.into_iter().collect()
    }

    /// The values that a part computes from, checks or returns.
    pub(super) fn taken(&self, part: &Part<'_>) -> BTreeSet<Value> {
        let operands = part.order.iter().flat_map(|&value| self.program.operation(value).operands());
        let checked = part.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten();
        operands.chain(checked).chain(part.results.iter().copied()).collect()
    }

    /// The statements of a part, its guards, and the error if a result is not finite.
    pub(super) fn body_of_part(&self, part: &Part<'_>, also: &[Value]) -> TokenStream {
        let krate = self.krate;
        let checked = part.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten();
        let results: BTreeSet<Value> = part.results.iter().copied().collect();
        let wanted = results.iter().copied().chain(checked).chain(also.iter().copied()).collect();
        let statements = self.statements(&part.order, &wanted, &Storage::default());
        let guards = part.guards.iter().map(|guard| self.guard(guard));
        let wrong = self.not_finite(&results, &[]).map(|wrong| {
            quote! {
                if #wrong {
                    return ::core::result::Result::Err(#krate::StateError::NotFinite);
                }
            }
        });
        quote! { #statements #(#guards)* #wrong }
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
        shared: &[Value],
    ) -> TokenStream {
        let krate = self.krate;
        let name = ident_of(contact);
        let signature = self.signature(arguments);
        let count = Literal::usize_unsuffixed(shared.len());
        let fetched = self.fetched(part, shared);
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
                #(#slices: &mut [T],)*
            ) -> ::core::result::Result<(), #krate::StateError> {
                #fetched
                #body
                #(#written)*
                ::core::result::Result::Ok(())
            }
        }
    }

    fn method_in_one_pass(&self, arguments: Arguments, known: &[usize], shared: usize) -> TokenStream {
        let krate = self.krate;
        let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
        let [n, p, three_p, shared] =
            [self.coordinates.len(), self.speeds.len(), 3 * self.speeds.len(), shared]
                .map(Literal::usize_unsuffixed);
        let slices = SLICES.map(|(slice, _)| format_ident!("{slice}"));
        let arms = self.by_contact(|contact| {
            if !known.contains(&contact) {
                return self.undefined("closed contact");
            }
            let name = ident_of(contact);
            quote!(Self::#name(self, #passed &shared, #(#slices),*))
        });
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
                let slices = matrices.zip(vectors);
                for (&contact, ((partial_velocities, response), (velocity, free_acceleration))) in
                    contacts.iter().zip(slices)
                {
                    let done: ::core::result::Result<(), #krate::StateError> = #arms;
                    done?;
                }
                ::core::result::Result::Ok(())
            }
        }
    }
}

/// The name of the routine of a contact.
fn ident_of(contact: usize) -> Ident {
    format_ident!("closed_{contact}")
}
