//! Emits the implementation of the trait `Contacts`.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::super::Emitter;
use crate::identifiers::ident;
use hodograph_model::model::mechanism::{ContactLaw, Named};
use hodograph_program::program::{ContactQuantity, Quantity};

impl Emitter<'_> {
    /// The surfaces that the model states, if it states any.
    fn stated_surfaces(&self) -> Option<TokenStream> {
        let krate = self.krate;
        let stated =
            self.mechanism.contacts.iter().enumerate().filter(|(_, contact)| contact.surface.is_some());
        let arms: Vec<TokenStream> = stated
            .map(|(index, _)| {
                let (index, name) =
                    (Literal::usize_unsuffixed(index), ident(&self.contact_method("surface", index)));
                quote!(#index => ::core::option::Option::Some(Self::#name()),)
            })
            .collect();
        (!arms.is_empty()).then(|| {
            quote! {
                fn surface(&self, contact: usize) -> ::core::option::Option<#krate::Surface<T>> {
                    match contact {
                        #(#arms)*
                        _ => ::core::option::Option::None,
                    }
                }
            }
        })
    }

    /// The implementation of the trait; a mechanism without contacts refuses every index.
    pub(super) fn contacts_trait(&self, in_one_pass: TokenStream) -> TokenStream {
        let (krate, name) = (self.krate, &self.name);
        let vector = quote!(#krate::nalgebra::Vector3<T>);
        let state =
            self.contact_values(ContactQuantity::Reduced, "contact_state", "reduced matrix of this contact");
        let gap = self.gaps();
        let validity = self.validities();
        let surface = self.stated_surfaces();
        let velocity =
            self.contact_values(ContactQuantity::Velocity, "contact_velocity", "velocity of this contact");
        let free = self.contact_values(
            ContactQuantity::FreeAcceleration,
            "free_acceleration",
            "free acceleration of this contact",
        );
        let partial = self.contact_matrix(ContactQuantity::PartialVelocities);
        let response = self.contact_matrix(ContactQuantity::Response);
        let collide = self.collisions("collide", "collision of this contact");
        let within = &collide;
        let without = self.collisions("impact_without_collision", "impact without collision of this contact");
        let mode = self.closed_contacts("contact_mode", "mode of this contact", &quote!());
        let force = self.closed_contacts("contact_force", "force of this contact", &quote!(mode,));
        let laws = self.stated_laws();
        let relative_rotation = self.relative_rotation();
        let outcome =
            quote!(::core::result::Result<#krate::ContactOutcome<T>, #krate::ClosedContactError<T>>);
        quote! {
            /// The methods for each contact, by its number, with slices.
            impl<T: #krate::Scalar> #krate::Contacts<T> for #name<T> {
                fn contact_state(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<#krate::ContactState<T>, #krate::StateError> {
                    #state
                }
                fn gap(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<::core::option::Option<T>, #krate::StateError> {
                    #gap
                }
                #validity
                #surface
                fn contact_velocity(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<#vector, #krate::StateError> {
                    #velocity
                }
                fn free_acceleration(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<#vector, #krate::StateError> {
                    #free
                }
                fn partial_velocities(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    partial_velocities: &mut [T],
                ) -> ::core::result::Result<(), #krate::StateError> {
                    #partial
                }
                fn response(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    response: &mut [T],
                ) -> ::core::result::Result<(), #krate::StateError> {
                    #response
                }
                fn collide(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    surface: &#krate::Surface<T>,
                    speeds: &mut [T],
                ) -> ::core::result::Result<#krate::CollisionOutcome<T>, #krate::CollisionError<T>> {
                    #collide
                }
                fn collide_with_budget(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    surface: &#krate::Budgeted<T>,
                    speeds: &mut [T],
                ) -> ::core::result::Result<#krate::CollisionOutcome<T>, #krate::CollisionError<T>> {
                    #within
                }
                fn impact_without_collision(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    surface: &#krate::Surface<T>,
                    speeds: &mut [T],
                ) -> ::core::result::Result<#krate::CollisionOutcome<T>, #krate::CollisionError<T>> {
                    #without
                }
                fn contact_mode(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                    surface: &#krate::Surface<T>,
                    accelerations: &mut [T],
                ) -> #outcome {
                    #mode
                }
                fn contact_force(
                    &self,
                    contact: usize,
                    mode: #krate::ContactMode,
                    state: &#krate::State<'_, T>,
                    surface: &#krate::Surface<T>,
                    accelerations: &mut [T],
                ) -> #outcome {
                    #force
                }
                #in_one_pass
                #laws
                #relative_rotation
            }
        }
    }

    /// The laws beyond mu, e and law that the model states, if it states any.
    fn stated_laws(&self) -> Option<TokenStream> {
        let krate = self.krate;
        let laws: Vec<_> = self.mechanism.contacts.iter().map(|contact| &contact.law).collect();
        if laws.iter().all(|law| **law == ContactLaw::default()) {
            return None;
        }
        let option = |value: Option<TokenStream>| match value {
            Some(value) => quote!(::core::option::Option::Some(#value)),
            None => quote!(::core::option::Option::None),
        };
        let number = |value: f64| Literal::f64_suffixed(value);
        let named = |law: &Option<Named>| {
            option(law.as_ref().map(|Named { name, numbers }| {
                let numbers = numbers.iter().map(|value| number(*value));
                quote!((#name, &[#(#numbers),*]))
            }))
        };
        let arms = laws.iter().enumerate().filter(|(_, law)| ***law != ContactLaw::default()).map(|(index, law)| {
            let index = Literal::usize_unsuffixed(index);
            let [mu_static, mu_impact, rolling, spinning] =
                [law.mu_static, law.mu_impact, law.rolling, law.spinning].map(|mu| option(mu.map(|mu| quote::ToTokens::to_token_stream(&number(mu)))));
            let [sliding, restitution] = [&law.sliding, &law.restitution].map(named);
            quote! {
                #index => #krate::StatedLaw {
                    mu_static: #mu_static, mu_impact: #mu_impact, sliding: #sliding, restitution: #restitution,
                    rolling: #rolling, spinning: #spinning,
                },
            }
        });
        Some(quote! {
            fn stated_law(&self, contact: usize) -> #krate::StatedLaw<'_> {
                match contact {
                    #(#arms)*
                    _ => ::core::default::Default::default(),
                }
            }
        })
    }

    /// The relative rotation of the bodies in contact, if the model requires it.
    fn relative_rotation(&self) -> Option<TokenStream> {
        let has = |contact| self.contact_output(contact, ContactQuantity::AngularVelocity).is_some();
        if !(0..self.mechanism.contacts.len()).any(has) {
            return None;
        }
        let krate = self.krate;
        let parts = [
            (ContactQuantity::AngularVelocity, "angular_velocity", "the angular velocity"),
            (ContactQuantity::FreeAngularAcceleration, "free_acceleration", "the free angular acceleration"),
            (
                ContactQuantity::PartialAngularVelocities,
                "partial_velocities",
                "the partial angular velocities",
            ),
            (ContactQuantity::AngularResponse, "response", "the angular response"),
        ];
        let body = self.by_contact(|contact| {
            if !has(contact) {
                return quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(false)
                };
            }
            let parts = parts.map(|(quantity, field, what)| {
                let slice = ident(field);
                let write = self.written_to(Quantity::Contact(contact as u32, quantity), &slice, what);
                quote! {
                    let #slice = &mut *values.#slice;
                    let written: ::core::result::Result<(), #krate::StateError> = { #write };
                    written?;
                }
            });
            quote! { #(#parts)* ::core::result::Result::Ok(true) }
        });
        Some(quote! {
            fn relative_rotation(
                &self,
                contact: usize,
                state: &#krate::State<'_, T>,
                values: &mut #krate::RelativeRotation<'_, T>,
            ) -> ::core::result::Result<bool, #krate::StateError> {
                #body
            }
        })
    }

    /// An arm for every contact.
    pub(super) fn by_contact(&self, body: impl Fn(usize) -> TokenStream) -> TokenStream {
        let arms = (0..self.mechanism.contacts.len()).map(|contact| (contact, body(contact)));
        self.by_number("contact", "Contact", arms.collect())
    }

    /// The result of the method `prefix_<contact>`, if the program has this quantity.
    fn contact_values(&self, quantity: ContactQuantity, prefix: &str, what: &str) -> TokenStream {
        self.by_contact(|contact| {
            if self.contact_output(contact, quantity).is_none() {
                return self.undefined(what);
            }
            if self.is_feature(contact) {
                let feature = quote!(Self::feature(self, contact, state)?);
                return match prefix {
                    "contact_state" => quote!(::core::result::Result::Ok(#feature.state())),
                    "contact_velocity" => quote!(Self::moving(self, contact, state)),
                    _ => quote!(::core::result::Result::Ok(#feature.free_acceleration)),
                };
            }
            let quantities = match prefix {
                "contact_state" => self.contact_state_quantities(contact),
                _ => vec![Quantity::Contact(contact as u32, quantity)],
            };
            let method = ident(&self.contact_method(prefix, contact));
            let (unpack, call) = self.own_method(&method, &quantities);
            quote!(#unpack #call)
        })
    }

    fn gaps(&self) -> TokenStream {
        self.lengths(ContactQuantity::Gap)
    }

    /// The validities, if the contacts of the model have any.
    fn validities(&self) -> Option<TokenStream> {
        let krate = self.krate;
        let quantity = ContactQuantity::Validity;
        let mut contacts = 0..self.mechanism.contacts.len();
        contacts.any(|contact| self.contact_output(contact, quantity).is_some()).then(|| {
            let validity = self.lengths(quantity);
            quote! {
                fn validity(
                    &self,
                    contact: usize,
                    state: &#krate::State<'_, T>,
                ) -> ::core::result::Result<::core::option::Option<T>, #krate::StateError> {
                    #validity
                }
            }
        })
    }

    /// A length that only some contacts have.
    fn lengths(&self, quantity: ContactQuantity) -> TokenStream {
        self.by_contact(|contact| {
            if self.contact_output(contact, quantity).is_none() {
                return quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(::core::option::Option::None)
                };
            }
            if self.is_feature(contact) {
                let which = ident(if quantity == ContactQuantity::Validity { "validity" } else { "gap" });
                return quote!(::core::result::Result::Ok(Self::near(self, contact, state)?.#which));
            }
            let (unpack, call) = self.own(Quantity::Contact(contact as u32, quantity));
            quote!(#unpack ::core::result::Result::map(#call, ::core::option::Option::Some))
        })
    }

    fn contact_matrix(&self, quantity: ContactQuantity) -> TokenStream {
        self.by_contact(|contact| {
            if self.is_feature(contact) {
                let krate = self.krate;
                let (slice, what) = Quantity::Contact(contact as u32, quantity).description().slice;
                let (field, slice) = (ident(slice), ident(slice));
                return quote! {
                    let feature = Self::feature(self, contact, state)?;
                    #krate::generated::check_length(#slice, feature.#field.len(), #what)?;
                    #slice.copy_from_slice(&feature.#field);
                    ::core::result::Result::Ok(())
                };
            }
            self.written(Quantity::Contact(contact as u32, quantity))
        })
    }

    fn collisions(&self, prefix: &str, what: &str) -> TokenStream {
        let krate = self.krate;
        let size = Literal::usize_unsuffixed(self.speeds.len());
        self.by_contact(|contact| {
            if self.is_feature(contact) {
                let resolve = match prefix {
                    "collide" => quote!(resolve(known, surface)),
                    _ => quote!(resolve_without_collision(known, surface)),
                };
                return quote! {
                    let feature = Self::feature(self, contact, state)?;
                    feature.struck(state, speeds, |known| #krate::generated::#resolve)
                };
            }
            if !self.collides(contact) {
                return self.undefined(what);
            }
            let arguments = self.collision_arguments(contact);
            let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
            let method = ident(&self.contact_method(prefix, contact));
            quote! {
                #unpack
                let hit = Self::#method(self, #passed surface)?;
                #krate::generated::write_array::<T, #size>(speeds, hit.speeds, "the speeds after the collision")?;
                ::core::result::Result::Ok(hit.outcome())
            }
        })
    }

    /// `contact_mode` or `contact_force`; the latter takes the mode before the surface.
    fn closed_contacts(&self, prefix: &str, what: &str, mode: &TokenStream) -> TokenStream {
        let krate = self.krate;
        let size = Literal::usize_unsuffixed(self.speeds.len());
        self.by_contact(|contact| {
            if self.is_feature(contact) {
                let decide = match prefix {
                    "contact_mode" => quote!(closed_contact(known, free, noise, surface.mu)),
                    _ => quote!(kept_contact(mode, known, free, surface.mu)),
                };
                let noise = if prefix == "contact_mode" { quote!(noise) } else { quote!(_) };
                return quote! {
                    let feature = Self::feature(self, contact, state)?;
                    #krate::Mechanism::accelerations(self, state, accelerations)?;
                    feature.touching(state, accelerations, |known, free, #noise| #krate::generated::#decide)
                };
            }
            if !self.closes(contact) {
                return self.undefined(what);
            }
            let arguments = self.closed_arguments(contact);
            let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
            let method = ident(&self.contact_method(prefix, contact));
            quote! {
                #unpack
                let closed = Self::#method(self, #passed #mode surface)?;
                #krate::generated::write_array::<T, #size>(accelerations, closed.accelerations, "the accelerations")?;
                ::core::result::Result::Ok(closed.outcome)
            }
        })
    }
}
