//! Emits the methods for mode and force of a closed contact, and their result type.

use proc_macro2::TokenStream;
use quote::quote;

use super::Emitter;
use super::interface::{Argument, Failure, Field, Group, Method, Signature, Struct, Type};
use super::record;
use super::routine::Arguments;
use super::values::local;
use crate::identifiers::ident;
use hodograph_program::program::{ContactQuantity, Quantity};

/// The quantities of a contact that its mode needs in addition to those of a collision.
const NEEDED: [ContactQuantity; 2] = [ContactQuantity::FreeAcceleration, ContactQuantity::PartialVelocities];

impl Emitter<'_> {
    /// Whether the mode of this contact can be computed.
    pub fn closes(&self, contact: usize) -> bool {
        self.collides(contact)
            && NEEDED.iter().all(|&quantity| self.contact_output(contact, quantity).is_some())
            && self.program.output(Quantity::Accelerations).is_some()
    }

    /// The type of closed contacts, if there is a contact whose mode can be computed.
    pub fn closed_structure(&self) -> Option<Struct> {
        (0..self.mechanism.contacts.len()).find(|&contact| self.closes(contact))?;
        let vector = |name: &str, docs: &str| Field::new(name, Type::Vector(3), docs);
        let dependent = (!self.dependent.is_empty()).then(|| {
            Field::new(
                "dependent_accelerations",
                Type::of_struct("DependentSpeeds"),
                "rates of the dependent speeds under the contact force, in the units of the speeds per second",
            )
        });
        let mut fields = vec![
            Field::new("mode", Type::Mode, "whether it sticks, slides, begins to slip or separates"),
            Field::new("selection", Type::Selection, "whether another mode would fit too"),
            Field::new(
                "accelerations",
                Type::of_struct("Speeds"),
                "rates of the independent speeds under the contact force, in the units of the speeds per second",
            ),
        ];
        fields.extend(dependent);
        fields.extend([
            vector("force", "force on the striking point along n, t, s, in N"),
            vector("force_on_point", "force on the striking point along N.x, N.y, N.z, in N"),
            vector(
                "force_on_struck",
                "force on what is touched along N.x, N.y, N.z, in N: the opposite of `force_on_point`",
            ),
            vector(
                "contact_acceleration",
                "rate of the contact velocity under the force, along n, t, s, in m/s^2",
            ),
            Field::new(
                "direction",
                Type::Optional(Box::new(Type::Vector(3))),
                "direction of slip, or in which slip begins, along N.x, N.y, N.z; of length one",
            ),
            Field::new(
                "margins",
                Type::Margins,
                "the mode holds while all margins that are `Some` are positive",
            ),
            Field::new(
                "outcome",
                Type::ContactOutcome,
                "the same in the type that all mechanisms share, with the quantities from which it was computed",
            ),
        ]);
        let docs = "Mode, force and accelerations of a closed contact. n, t, s are the axes `normal`, `first`, `second` of the contact basis.";
        Some(Struct::of_results("ClosedContact", docs, fields))
    }

    /// The type of closed contacts with its trait implementations.
    pub fn closed_type(&self) -> Option<TokenStream> {
        let structure = self.closed_structure()?;
        let written = record::outcome(self.krate, &structure.name, &structure.names());
        let structure = structure.tokens(self.krate, &quote!(#[non_exhaustive]));
        Some(quote! { #structure #written })
    }

    /// The quantities from which the mode is computed.
    fn closed_quantities(&self, contact: usize) -> Vec<Quantity> {
        let mut quantities = self.collision_quantities(contact);
        quantities.extend(NEEDED.map(|quantity| Quantity::Contact(contact as u32, quantity)));
        quantities.push(Quantity::Accelerations);
        if !self.dependent.is_empty() {
            quantities.push(Quantity::DependentAccelerations);
        }
        quantities
    }

    /// The arguments of the methods for the mode, without the surface.
    pub fn closed_arguments(&self, contact: usize) -> Arguments {
        Arguments { speeds: true, ..self.arguments(&self.closed_quantities(contact)) }
    }

    /// `contact_mode_..` and `contact_force_..`, and the routine that they share.
    pub fn closed(&self, contact: usize) -> Group {
        let krate = self.krate;
        let words = self.contact_words(contact);
        let named = |prefix: &str| self.contact_method(prefix, contact);
        let [mode, force, collision] =
            ["contact_mode", "contact_force", "impact_without_collision"].map(named);
        let shared = ident(&named("touching"));
        let docs_mode = format!(
            "Selects the mode (stick, slide, begin to slip, separate) of the closed contact {words}, with its force, the accelerations under that force \
             and the margins of the mode. The contact had no force before.\n\nThe gap and the normal velocity are taken for zero and not read. Of the \
             surface only `mu` is read. Slip within rounding of zero counts as none. Where no finite force exists, the error says whether \
             `{collision}` follows or no mode fits."
        );
        let docs_force = format!(
            "The force that keeps the closed contact {words} in a given mode, in the form of `{mode}`. A margin that is not positive says that the mode has \
             ended. Where no force keeps the mode the error is `NoMode`."
        );
        let taken = self.closed_arguments(contact);
        let (private, passed) = (self.signature(taken), self.passed(taken));
        let body = self.closed_contact_statements(contact);
        let (of_mode, surface) =
            (Argument { name: "mode", of: Type::Mode }, Argument { name: "surface", of: Type::Surface });
        let method = |name: String, docs: String, more: Vec<Argument>, decide: TokenStream| {
            let arguments = self.declared(taken).into_iter().chain(more).collect();
            let answer = Type::of_struct("ClosedContact");
            let signature =
                Signature { name, docs, arguments, answer, failure: Failure::ClosedContact, in_place: None };
            Method {
                signature,
                attributes: quote!(#[inline]),
                body: quote!(Self::#shared(self, #passed #decide)),
            }
        };
        let selects = quote! {
            |contact, free, noise| #krate::generated::closed_contact(contact, free, noise, surface.mu)
        };
        let keeps = quote! {
            |contact, free, _| #krate::generated::kept_contact(mode, contact, free, surface.mu)
        };
        let error = quote!(#krate::ClosedContactError<T>);
        Group {
            methods: vec![
                method(mode, docs_mode, vec![surface.clone()], selects),
                method(force, docs_force, vec![of_mode, surface], keeps),
            ],
            in_lanes: false,
            private: quote! {
                #[inline]
                fn #shared(
                    #private
                    decide: impl ::core::ops::FnOnce(
                        &#krate::generated::Contact<T>,
                        &#krate::nalgebra::Vector3<T>,
                        T,
                    ) -> ::core::result::Result<#krate::ContactOutcome<T>, #error>,
                ) -> ::core::result::Result<ClosedContact<T>, #error> {
                    #body
                }
            },
        }
    }

    /// The statements from a state to a closed contact; `decide` determines mode and force.
    fn closed_contact_statements(&self, contact: usize) -> TokenStream {
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
