//! Emits the methods for mode and force of a closed contact, and their result type.

use proc_macro2::TokenStream;
use quote::quote;

use super::Emitter;
use super::record;
use super::routine::Arguments;
use super::values::local;
use crate::identifiers::{docs, ident};
use hodograph_program::program::{ContactQuantity, Quantity};

/// What the mode needs of a contact beside what a collision needs.
const NEEDED: [ContactQuantity; 2] = [ContactQuantity::FreeAcceleration, ContactQuantity::PartialVelocities];

impl Emitter<'_> {
    /// Whether the mode of this contact can be computed.
    pub fn closes(&self, contact: usize) -> bool {
        self.collides(contact)
            && NEEDED.iter().all(|&quantity| self.contact_output(contact, quantity).is_some())
            && self.program.output(Quantity::Accelerations).is_some()
    }

    /// The type of closed contacts, where there is one.
    pub fn closed_type(&self) -> TokenStream {
        if !(0..self.mechanism.contacts.len()).any(|contact| self.closes(contact)) {
            return quote!();
        }
        let krate = self.krate;
        let vector = quote!(#krate::nalgebra::Vector3<T>);
        let has_dependent = !self.dependent.is_empty();
        let dependent = has_dependent.then(|| {
            quote! {
                /// rates of the dependent speeds under the contact force, in the units of the speeds per second
                pub dependent_accelerations: DependentSpeeds<T>,
            }
        });
        let dependent_field = has_dependent.then_some("dependent_accelerations");
        let fields = [
            "force",
            "force_on_point",
            "force_on_struck",
            "contact_acceleration",
            "direction",
            "margins",
            "outcome",
        ];
        let fields: Vec<&str> =
            ["mode", "selection", "accelerations"].into_iter().chain(dependent_field).chain(fields).collect();
        let written = record::outcome(krate, "ClosedContact", &fields);
        quote! {
            /// Mode, force and accelerations of a closed contact. n, t, s are the axes `normal`, `first`, `second` of the contact basis.
            #[derive(Clone, Copy, Debug, PartialEq)]
            #[must_use]
            #[non_exhaustive]
            pub struct ClosedContact<T: #krate::nalgebra::Scalar = f64> {
                /// whether it sticks, slides, begins to slip or separates
                pub mode: #krate::ContactMode,
                /// whether another mode would fit too
                pub selection: #krate::Selection,
                /// rates of the independent speeds under the contact force, in the units of the speeds per second
                pub accelerations: Speeds<T>,
                #dependent
                /// force on the striking point along n, t, s, in N
                pub force: #vector,
                /// force on the striking point along N.x, N.y, N.z, in N
                pub force_on_point: #vector,
                /// force on what is touched along N.x, N.y, N.z, in N: the opposite of `force_on_point`
                pub force_on_struck: #vector,
                /// rate of the contact velocity under the force, along n, t, s, in m/s^2
                pub contact_acceleration: #vector,
                /// direction of slip, or in which slip begins, along N.x, N.y, N.z; of length one
                pub direction: ::core::option::Option<#vector>,
                /// the mode holds while all margins that are `Some` are positive
                pub margins: #krate::Margins<T>,
                /// the same in the type that all mechanisms share, with the quantities from which it was computed
                pub outcome: #krate::ContactOutcome<T>,
            }

            #written
        }
    }

    /// What the mode is computed from.
    fn closed_quantities(&self, contact: usize) -> Vec<Quantity> {
        let mut quantities = self.collision_quantities(contact);
        quantities.extend(NEEDED.map(|quantity| Quantity::Contact(contact as u32, quantity)));
        quantities.push(Quantity::Accelerations);
        if !self.dependent.is_empty() {
            quantities.push(Quantity::DependentAccelerations);
        }
        quantities
    }

    /// The arguments of the mode but for the surface.
    pub fn closed_arguments(&self, contact: usize) -> Arguments {
        Arguments { speeds: true, ..self.arguments(&self.closed_quantities(contact)) }
    }

    /// `contact_mode_..` and `contact_force_..`, and the routine that they share.
    pub fn closed(&self, contact: usize) -> TokenStream {
        let krate = self.krate;
        let words = self.contact_words(contact);
        let named = |prefix: &str| ident(&self.contact_method(prefix, contact));
        let [mode, force, shared] = ["contact_mode", "contact_force", "touching"].map(named);
        let collision = self.contact_method("impact_without_collision", contact);
        let docs_mode = docs(&format!(
            "Selects the mode (stick, slide, begin to slip, separate) of the closed contact {words}, with its force, the accelerations under that force \
             and the margins of the mode. The contact had no force before.\n\nThe gap and the normal velocity are taken for zero and not read. Of the \
             surface only `mu` is read. Slip within rounding of zero counts as none. Where no finite force exists, the error says whether \
             `{collision}` follows or no mode fits."
        ));
        let docs_force = docs(&format!(
            "The force that keeps the closed contact {words} in a given mode, in the form of `{mode}`. A margin that is not positive says that the mode has \
             ended. Where no force keeps the mode the error is `NoMode`."
        ));
        let arguments = self.closed_arguments(contact);
        let (signature, passed) = (self.signature(arguments), self.passed(arguments));
        let body = self.touching(contact);
        let error = quote!(#krate::ClosedContactError<T>);
        let result = quote!(::core::result::Result<ClosedContact<T>, #error>);
        let vector = quote!(#krate::nalgebra::Vector3<T>);
        quote! {
            #docs_mode
            #[inline]
            pub fn #mode(#signature surface: &#krate::Surface<T>) -> #result {
                Self::#shared(self, #passed |contact, free, noise| {
                    #krate::generated::closed_contact(contact, free, noise, surface.mu)
                })
            }

            #docs_force
            #[inline]
            pub fn #force(#signature mode: #krate::ContactMode, surface: &#krate::Surface<T>) -> #result {
                Self::#shared(self, #passed |contact, free, _| {
                    #krate::generated::kept_contact(mode, contact, free, surface.mu)
                })
            }

            #[inline]
            fn #shared(
                #signature
                decide: impl ::core::ops::FnOnce(
                    &#krate::generated::Contact<T>,
                    &#vector,
                    T,
                ) -> ::core::result::Result<#krate::ContactOutcome<T>, #error>,
            ) -> #result {
                #body
            }
        }
    }

    /// The statements from a state to a closed contact; `decide` finds mode and force.
    fn touching(&self, contact: usize) -> TokenStream {
        let krate = self.krate;
        let known = self.known_contact(contact);
        let [free, partial] = NEEDED.map(|quantity| {
            let values = self.contact_output(contact, quantity).map(|output| output.values.as_slice());
            let values = values.unwrap_or_default().iter().map(|&value| local(value));
            quote!(#(#values),*)
        });
        let speeds = self.speeds.fields().map(|field| quote!(u.#field));
        let changed = |quantity, response| self.changed(quantity, contact, response).unwrap_or_default();
        let accelerations =
            self.speeds.construct(&changed(Quantity::Accelerations, ContactQuantity::Response));
        let dependent = (!self.dependent.is_empty()).then(|| {
            let after = changed(Quantity::DependentAccelerations, ContactQuantity::DependentResponse);
            let value = self.dependent.construct(&after);
            quote!(dependent_accelerations: #value,)
        });
        let body = self.compute(&self.closed_quantities(contact));
        quote! {
            #body
            let contact = #known;
            let free = #krate::nalgebra::Vector3::new(#free);
            let noise = #krate::generated::slip_noise::<T>(&[#partial], &[#(#speeds),*], &contact.remainder);
            let outcome = decide(&contact, &free, noise)?;
            let [[i0, i1, i2]] = outcome.answer.force.data.0;
            ::core::result::Result::Ok(ClosedContact {
                mode: outcome.answer.mode,
                selection: outcome.answer.selection,
                accelerations: #accelerations,
                #dependent
                force: outcome.answer.force,
                force_on_point: outcome.force_on_point,
                force_on_struck: -outcome.force_on_point,
                contact_acceleration: outcome.answer.acceleration,
                direction: outcome.direction,
                margins: outcome.answer.margins,
                outcome,
            })
        }
    }
}
