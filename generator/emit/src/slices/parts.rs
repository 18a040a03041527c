//! Divides what is computed of several contacts into routines: what all of them share, what the contacts of a pair of
//! shapes share, and the rest of each contact. So several contacts cost no kinematics twice, and a pair nothing where
//! none of its contacts is asked for.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::Emitter;
use super::super::storage::Storage;
use super::super::values::local;
use hodograph_program::program::operation::{Operation, Stage, Value};
use hodograph_program::program::{ContactQuantity, Guard, Quantity};

/// The work of a routine: values in order, guards, results.
#[derive(Default)]
pub(super) struct Part<'p> {
    order: Vec<Value>,
    guards: Vec<&'p Guard>,
    pub results: Vec<Value>,
}

/// The routines of contacts of a pair of shapes, or of all others.
pub(super) struct OfPair<'p> {
    /// the contacts, with the rest of each
    pub contacts: Vec<(usize, Part<'p>)>,
    /// what they share, beside what all contacts do
    pub together: Part<'p>,
    /// the values of this that the contacts use
    pub shared: Vec<Value>,
}

/// What is computed of several contacts.
pub(super) struct Divided<'p> {
    /// what all share, and the quantities of the mechanism
    pub together: Part<'p>,
    /// the values of this that others use
    pub shared: Vec<Value>,
    /// pair by pair
    pub pairs: Vec<OfPair<'p>>,
}

impl Emitter<'_> {
    /// Divides quantities of the mechanism and of contacts.
    pub(super) fn divided(
        &self,
        of_mechanism: &[Quantity],
        contacts: &[usize],
        of: &[ContactQuantity],
    ) -> Divided<'_> {
        let quantities = |contact: usize| -> Vec<Quantity> {
            let there = of.iter().filter(|of| self.contact_output(contact, **of).is_some());
            there.map(|&of| Quantity::Contact(contact as u32, of)).collect()
        };
        let mut by_pair: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for &contact in contacts {
            by_pair.entry(self.mechanism.contacts[contact].first_of_pair).or_default().push(contact);
        }
        let alone = by_pair.len() == 1;
        let of_pairs: Vec<Vec<Quantity>> = match alone {
            true => contacts.iter().map(|&contact| quantities(contact)).collect(),
            false => by_pair.values().map(|of| of.iter().copied().flat_map(quantities).collect()).collect(),
        };
        let (together, parts) = self.split(of_mechanism, &of_pairs);
        let pairs: Vec<OfPair<'_>> = if alone {
            let contacts = contacts.iter().copied().zip(parts).collect();
            vec![OfPair { contacts, together: Part::default(), shared: Vec::new() }]
        } else {
            by_pair.into_values().map(|of| self.of_pair(of, &quantities, &together)).collect()
        };
        let parts =
            pairs.iter().flat_map(|pair| pair.contacts.iter().map(|(_, part)| part).chain([&pair.together]));
        let shared = self.shared(&together, parts);
        Divided { together, shared, pairs }
    }

    /// What the contacts of a pair share beside what all contacts do, and the rest of each.
    fn of_pair(
        &self,
        contacts: Vec<usize>,
        quantities: &impl Fn(usize) -> Vec<Quantity>,
        all: &Part<'_>,
    ) -> OfPair<'_> {
        let of_each: Vec<Vec<Quantity>> = contacts.iter().map(|&contact| quantities(contact)).collect();
        let (mut together, mut parts) = self.split(&[], &of_each);
        let known: BTreeSet<Value> = all.order.iter().copied().filter(|&value| self.is_work(value)).collect();
        let checked: BTreeSet<Value> = all.guards.iter().map(|guard| guard.value).collect();
        for part in parts.iter_mut().chain([&mut together]) {
            part.order.retain(|value| !known.contains(value));
            part.guards.retain(|guard| !checked.contains(&guard.value));
        }
        let shared = self.shared(&together, parts.iter());
        OfPair { contacts: contacts.into_iter().zip(parts).collect(), together, shared }
    }

    /// The work for quantities of the mechanism and what several of these lists share, and then for each of the lists.
    fn split(&self, of_mechanism: &[Quantity], of_each: &[Vec<Quantity>]) -> (Part<'_>, Vec<Part<'_>>) {
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

    /// The values of a routine that other routines use.
    fn shared<'a>(&self, together: &Part<'_>, parts: impl Iterator<Item = &'a Part<'a>>) -> Vec<Value> {
        let computed: BTreeSet<Value> =
            together.order.iter().copied().filter(|&value| self.is_work(value)).collect();
        let mut shared = BTreeSet::new();
        for part in parts {
            shared.extend(self.taken(part).into_iter().filter(|value| computed.contains(value)));
        }
        shared.into_iter().collect()
    }

    /// The values that a part computes from, checks or returns.
    fn taken(&self, part: &Part<'_>) -> BTreeSet<Value> {
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

    /// The statements that take the values that a part needs `from` those that are shared.
    pub(super) fn fetched(&self, part: &Part<'_>, shared: &[Value], from: &str) -> TokenStream {
        let from = format_ident!("{from}");
        let taken = self.taken(part);
        let statements =
            shared.iter().enumerate().filter(|(_, value)| taken.contains(value)).map(|(at, &value)| {
                let (at, name) = (Literal::usize_unsuffixed(at), local(value));
                quote!(let #name = #from[#at];)
            });
        quote!(#(#statements)*)
    }
}
