//! Emits contacts that have no methods of their own: those of edges, as of two boxes, of which a pair has dozens. The trait reaches
//! them by number.
//!
//! Gaps and velocities are those of [`super::in_one_pass`]; one routine gives everything else, in the same form.

use std::ops::Range;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::super::Emitter;
use super::in_one_pass::Family;
use hodograph_program::program::ContactQuantity;

/// Everything but gaps and velocities alone.
const WHOLE: [ContactQuantity; 11] = [
    ContactQuantity::Gap,
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::Reduced,
    ContactQuantity::Response,
    ContactQuantity::Remainder,
    ContactQuantity::PrescribedWork,
    ContactQuantity::FreeAcceleration,
    ContactQuantity::PartialVelocities,
];

impl Emitter<'_> {
    /// Whether a contact has no methods of its own.
    pub fn is_feature(&self, contact: usize) -> bool {
        self.mechanism.contacts.get(contact).is_some_and(|contact| contact.is_one_of_many())
    }

    fn features(&self) -> Vec<usize> {
        let contacts: Range<usize> = 0..self.mechanism.contacts.len();
        contacts.filter(|&contact| self.is_feature(contact)).collect()
    }

    /// The routines of these contacts, if there are any.
    pub(super) fn feature_routines(&self) -> Option<TokenStream> {
        let known = self.features();
        if known.is_empty() {
            return None;
        }
        let krate = self.krate;
        let room = Literal::usize_unsuffixed(3 * self.speeds.len());
        let feature = quote!(#krate::generated::Feature<T, #room>);
        let whole = self.family("feature", &known, &WHOLE, feature, |contact| {
            let known = self.known_contact(contact);
            let [gap, response, partial, free] = [
                ContactQuantity::Gap,
                ContactQuantity::Response,
                ContactQuantity::PartialVelocities,
                ContactQuantity::FreeAcceleration,
            ]
            .map(|quantity| self.values_of(contact, quantity));
            quote! {
                #krate::generated::Feature {
                    gap: #(#gap)*,
                    contact: #known,
                    response: [#(#response),*],
                    partial_velocities: [#(#partial),*],
                    free_acceleration: #krate::nalgebra::Vector3::new(#(#free),*),
                }
            }
        });
        let one = self.one_of(&whole);
        let Family { routines, .. } = whole;
        Some(quote! { #one #routines })
    }
}
