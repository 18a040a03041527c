//! The methods of a contact: gap, velocities, reduced matrix, collision.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::methods::about;
use super::routine::Arguments;
use super::values::local;
use crate::program::Output;
use crate::program::{ContactQuantity, Quantity, Structure};

/// What a collision needs of its contact, in any case.
const NEEDED: [ContactQuantity; 6] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::Reduced,
    ContactQuantity::Response,
];

impl Emitter<'_> {
    pub fn contact_output(&self, contact: usize, quantity: ContactQuantity) -> Option<&Output> {
        let output = self.program.output(Quantity::Contact(contact as u32, quantity))?;
        (!output.values.is_empty()).then_some(output)
    }

    /// Can the collision of this contact be computed?
    pub fn collides(&self, contact: usize) -> bool {
        NEEDED.iter().all(|&quantity| self.contact_output(contact, quantity).is_some())
    }

    /// The type of solved collisions, where there is a contact.
    pub fn collision_type(&self) -> TokenStream {
        if !(0..self.mechanism.contacts.len()).any(|contact| self.collides(contact)) {
            return quote!();
        }
        let krate = self.krate;
        let vector = quote!(#krate::nalgebra::Vector3<T>);
        let dependent = (!self.dependent.is_empty()).then(|| {
            quote! {
                /// dependent speeds after the collision
                pub dependent_speeds: DependentSpeeds<T>,
            }
        });
        let dependent_field = (!self.dependent.is_empty()).then(|| quote!(dependent_speeds));
        let count = Literal::usize_unsuffixed(13 + usize::from(!self.dependent.is_empty()));
        quote! {
            /// A solved collision. n is the contact's normal, t lies along the slip of approach, s = n x t.
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct Collision<T: #krate::nalgebra::Scalar = f64> {
                /// independent speeds after the collision: (12a)
                pub speeds: Speeds<T>,
                #dependent
                /// impulse on the striking point along n, t, s, in N s
                pub impulse: #vector,
                /// impulse on the striking point along N.x, N.y, N.z, in N s
                pub impulse_on_point: #vector,
                /// impulse on what is struck along N.x, N.y, N.z, in N s: the opposite
                pub impulse_on_struck: #vector,
                /// n along N.x, N.y, N.z
                pub normal: #vector,
                /// t along N.x, N.y, N.z
                pub tangent: #vector,
                /// s along N.x, N.y, N.z
                pub binormal: #vector,
                /// velocity of approach along n, t, s, in m/s
                pub approach: #vector,
                /// velocity of separation along n, t, s, in m/s
                pub separation: #vector,
                /// reduced mass matrix along n, t, s, in 1/kg
                pub reduced: #krate::ReducedMatrix<T>,
                /// change of the kinetic energy, in J; it differs from `impact.contact_work` where motion is prescribed: (24)
                pub energy_change: T,
                /// the phases gone through
                pub path: #krate::Path,
                /// everything that the solver tells
                pub impact: #krate::Impact<T>,
            }

            impl<T: #krate::Scalar> Collision<T> {
                /// The collision without the speeds after it, in the type that all mechanisms share.
                #[inline]
                #[must_use]
                pub fn outcome(&self) -> #krate::CollisionOutcome<T> {
                    #krate::CollisionOutcome {
                        normal: self.normal,
                        tangent: self.tangent,
                        binormal: self.binormal,
                        approach: self.approach,
                        reduced: self.reduced,
                        impulse_on_point: self.impulse_on_point,
                        energy_change: self.energy_change,
                        impact: self.impact,
                    }
                }
            }

            #krate::generated::serialize_outcome! {
                Collision #count speeds #dependent_field impulse impulse_on_point impulse_on_struck normal tangent binormal
                approach separation reduced energy_change path impact
            }
        }
    }

    /// The methods of all contacts.
    pub fn contacts(&self) -> TokenStream {
        let methods = (0..self.mechanism.contacts.len()).map(|contact| self.contact(contact));
        quote! { #(#methods)* }
    }

    fn contact(&self, contact: usize) -> TokenStream {
        let queries = [
            (ContactQuantity::Gap, "gap", "Distance at"),
            (
                ContactQuantity::Velocity,
                "contact_velocity",
                "Velocity of the striking point relative to what is struck, along the contact basis (rows: normal, first, second), in m/s, at",
            ),
            (
                ContactQuantity::PartialVelocities,
                "partial_velocities",
                "Partial velocities V_n, V_t, V_s of the relative velocity along the contact basis (rows) for the independent speeds (columns) at",
            ),
            (
                ContactQuantity::Response,
                "response",
                "Response M^-1 V^T: change of the independent speeds (rows) per unit of impulse along the contact basis (columns), and of their rates per unit of force, at",
            ),
            (
                ContactQuantity::FreeAcceleration,
                "free_acceleration",
                "Rates of the contact velocity along the contact basis (rows: normal, first, second) without contact forces, in m/s^2: the derivative of its components as functions of time, coordinates and speeds along (1, q', u'), at",
            ),
            (
                ContactQuantity::Remainder,
                "remainder_velocity",
                "The part of the relative velocity that prescribed motion causes, along the contact basis, in m/s, at",
            ),
        ];
        let queries = queries.into_iter().filter_map(|(quantity, prefix, docs)| {
            let output = self.contact_output(contact, quantity)?;
            let (result, value) = self.shaped(output);
            let docs = format!("{docs} {}.", self.contact_words(contact));
            Some(self.routine(
                &self.contact_method(prefix, contact),
                &docs,
                &[output.quantity],
                result,
                value,
            ))
        });
        let basis = self.contact_basis(contact);
        let reduced = self.reduced_matrix(contact);
        let matrices = self.contact_matrices(contact);
        let collide = self.collides(contact).then(|| self.collide(contact));
        let derivatives = self.collides(contact).then(|| self.derivatives(contact));
        let state = self.contact_state(contact);
        quote! { #(#queries)* #basis #reduced #matrices #state #collide #derivatives }
    }

    /// What the state of a contact is made of.
    pub fn contact_state_quantities(&self, contact: usize) -> Vec<Quantity> {
        let all = [
            ContactQuantity::Gap,
            ContactQuantity::Normal,
            ContactQuantity::First,
            ContactQuantity::Second,
            ContactQuantity::Velocity,
            ContactQuantity::Reduced,
        ];
        all.into_iter()
            .filter_map(|quantity| self.contact_output(contact, quantity))
            .map(|output| output.quantity)
            .collect()
    }

    /// Gap, basis, velocity and reduced matrix at once.
    fn contact_state(&self, contact: usize) -> Option<TokenStream> {
        let krate = self.krate;
        let reduced = self.reduced(self.contact_output(contact, ContactQuantity::Reduced)?);
        let vector = |quantity: ContactQuantity| {
            let output = self.contact_output(contact, quantity)?;
            let entries = output.values.iter().map(|&value| local(value));
            Some(quote!(#krate::nalgebra::Vector3::new(#(#entries),*)))
        };
        let [normal, first, second, velocity] = [
            vector(ContactQuantity::Normal)?,
            vector(ContactQuantity::First)?,
            vector(ContactQuantity::Second)?,
            vector(ContactQuantity::Velocity)?,
        ];
        let gap = self.contact_output(contact, ContactQuantity::Gap).and_then(|output| output.values.first());
        let gap = match gap.map(|&value| local(value)) {
            Some(gap) => quote!(::core::option::Option::Some(#gap)),
            None => quote!(::core::option::Option::None),
        };
        let docs = format!(
            "Gap, basis, velocity and reduced mass matrix at {} at once.",
            self.contact_words(contact)
        );
        let value = quote! {
            #krate::ContactState {
                gap: #gap,
                normal: #normal,
                first: #first,
                second: #second,
                velocity: #velocity,
                reduced: #reduced,
            }
        };
        let name = self.contact_method("contact_state", contact);
        let quantities = self.contact_state_quantities(contact);
        Some(self.routine(&name, &docs, &quantities, quote!(#krate::ContactState<T>), value))
    }

    pub fn contact_words(&self, contact: usize) -> String {
        self.mechanism
            .contacts
            .get(contact)
            .map_or(String::new(), |contact| about(&contact.name, &contact.docs))
    }

    fn contact_basis(&self, contact: usize) -> Option<TokenStream> {
        let axes = [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second];
        let outputs: Vec<&Output> =
            axes.iter().filter_map(|&axis| self.contact_output(contact, axis)).collect();
        if outputs.len() != 3 {
            return None;
        }
        let krate = self.krate;
        let quantities: Vec<Quantity> = outputs.iter().map(|output| output.quantity).collect();
        let columns = outputs.iter().map(|output| {
            let entries = output.values.iter().map(|&value| local(value));
            quote!([#(#entries),*])
        });
        let value = quote!(#krate::nalgebra::SMatrix::from([#(#columns),*]));
        let docs = format!(
            "Contact basis (columns: normal, first, second) along N.x, N.y, N.z at {}.",
            self.contact_words(contact)
        );
        let name = self.contact_method("contact_basis", contact);
        Some(self.routine(&name, &docs, &quantities, quote!(#krate::nalgebra::Matrix3<T>), value))
    }

    fn reduced_matrix(&self, contact: usize) -> Option<TokenStream> {
        let krate = self.krate;
        let output = self.contact_output(contact, ContactQuantity::Reduced)?;
        let value = self.reduced(output);
        let docs = format!(
            "Reduced mass matrix V M^-1 V^T along the contact basis, in 1/kg, at {}.",
            self.contact_words(contact)
        );
        let name = self.contact_method("reduced_matrix", contact);
        Some(self.routine(&name, &docs, &[output.quantity], quote!(#krate::ReducedMatrix<T>), value))
    }

    /// Both at once, for what they share.
    fn contact_matrices(&self, contact: usize) -> Option<TokenStream> {
        let krate = self.krate;
        let partial = self.contact_output(contact, ContactQuantity::PartialVelocities)?;
        let reduced = self.contact_output(contact, ContactQuantity::Reduced)?;
        let (shape, velocities) = self.matrix(partial);
        let matrix = self.reduced(reduced);
        let docs = format!(
            "Partial velocities and reduced mass matrix at {} together, as `{}` and `{}` give them one by one.",
            self.contact_words(contact),
            self.contact_method("partial_velocities", contact),
            self.contact_method("reduced_matrix", contact)
        );
        let name = self.contact_method("contact_matrices", contact);
        let result = quote!((#shape, #krate::ReducedMatrix<T>));
        Some(self.routine(
            &name,
            &docs,
            &[partial.quantity, reduced.quantity],
            result,
            quote!((#velocities, #matrix)),
        ))
    }

    pub fn reduced(&self, output: &Output) -> TokenStream {
        let krate = self.krate;
        let entries = output.values.iter().map(|&value| local(value));
        quote!(#krate::ReducedMatrix::new(#(#entries),*))
    }

    /// What a collision is computed from.
    fn collision_quantities(&self, contact: usize) -> Vec<Quantity> {
        let index = contact as u32;
        let mut quantities: Vec<Quantity> =
            NEEDED.iter().map(|&quantity| Quantity::Contact(index, quantity)).collect();
        let optional = [
            Quantity::Contact(index, ContactQuantity::Remainder),
            Quantity::Contact(index, ContactQuantity::PrescribedWork),
            Quantity::Contact(index, ContactQuantity::DependentResponse),
        ];
        quantities.extend(optional.into_iter().filter(|&quantity| self.program.output(quantity).is_some()));
        if !self.dependent.is_empty() {
            quantities.push(Quantity::DependentSpeeds);
        }
        quantities
    }

    /// The arguments of a collision but for the surface.
    pub fn collision_arguments(&self, contact: usize) -> Arguments {
        Arguments { speeds: true, ..self.arguments(&self.collision_quantities(contact)) }
    }

    fn collide(&self, contact: usize) -> TokenStream {
        let krate = self.krate;
        let quantities = self.collision_quantities(contact);
        let vector = |quantity: ContactQuantity| match self.contact_output(contact, quantity) {
            Some(output) => {
                let entries = output.values.iter().map(|&value| local(value));
                quote!(#krate::nalgebra::Vector3::new(#(#entries),*))
            }
            None => quote!(#krate::nalgebra::Vector3::zeros()),
        };
        let [normal, first, second] =
            [ContactQuantity::Normal, ContactQuantity::First, ContactQuantity::Second].map(vector);
        let [velocity, remainder, prescribed] =
            [ContactQuantity::Velocity, ContactQuantity::Remainder, ContactQuantity::PrescribedWork]
                .map(vector);
        let reduced =
            self.contact_output(contact, ContactQuantity::Reduced).map(|output| self.reduced(output));

        let speeds: Vec<TokenStream> = self.speeds.fields().map(|field| quote!(u.#field)).collect();
        let speeds = self.after(speeds, self.contact_output(contact, ContactQuantity::Response));
        let speeds = self.speeds.construct(&speeds);
        let dependent =
            self.program.output(Quantity::DependentSpeeds).filter(|_| !self.dependent.is_empty()).map(
                |output| {
                    let before =
                        output.values.iter().map(|&value| local(value)).map(|value| quote!(#value)).collect();
                    let after =
                        self.after(before, self.contact_output(contact, ContactQuantity::DependentResponse));
                    let value = self.dependent.construct(&after);
                    quote!(dependent_speeds: #value,)
                },
            );

        let name = crate::rust_names::ident(&self.contact_method("collide", contact));
        let docs = crate::rust_names::docs(&format!(
            "Solves the collision at {}.\n\nConfiguration and time stay, the speeds jump: du = M^-1 V^T I (12a).\n\n# Errors\n\n\
             Where the state is singular, or the collision has no outcome.",
            self.contact_words(contact)
        ));
        // What the symbols of the reduced matrix show selects a closed form.
        let closed = |marker: TokenStream| quote!(#krate::generated::resolve_structured::<#krate::structure::#marker, T>);
        let resolve = match self.program.structures.get(contact) {
            Some(Structure::Planar) => closed(quote!(Planar)),
            Some(Structure::Balanced) => closed(quote!(Balanced)),
            Some(Structure::Diagonal) => closed(quote!(Diagonal)),
            Some(Structure::Isotropic) => closed(quote!(Isotropic)),
            Some(Structure::General) | None => quote!(#krate::generated::resolve),
        };
        let signature = self.signature(self.collision_arguments(contact));
        let body = self.compute(&quantities);
        quote! {
            #docs
            #[inline]
            pub fn #name(
                #signature surface: &#krate::Surface<T>,
            ) -> ::core::result::Result<Collision<T>, #krate::CollisionError<T>> {
                #body
                let contact = #krate::generated::Contact {
                    normal: #normal,
                    first: #first,
                    second: #second,
                    velocity: #velocity,
                    reduced: #reduced,
                    remainder: #remainder,
                    prescribed_work: #prescribed,
                };
                let hit = #resolve(&contact, surface)?;
                let [[i0, i1, i2]] = hit.impulse.data.0;
                ::core::result::Result::Ok(Collision {
                    speeds: #speeds,
                    #dependent
                    impulse: hit.impact.impulse,
                    impulse_on_point: hit.impulse_on_point,
                    impulse_on_struck: -hit.impulse_on_point,
                    normal: contact.normal,
                    tangent: hit.tangent,
                    binormal: hit.binormal,
                    approach: hit.approach,
                    separation: hit.impact.velocity,
                    reduced: hit.reduced,
                    energy_change: hit.energy_change,
                    path: hit.impact.path,
                    impact: hit.impact,
                })
            }
        }
    }

    /// Speeds plus response times impulse; structural zeros are left out.
    fn after(&self, before: Vec<TokenStream>, response: Option<&Output>) -> Vec<TokenStream> {
        let impulse = [quote!(i0), quote!(i1), quote!(i2)];
        let after = before.into_iter().enumerate().map(|(row, before)| {
            let terms = impulse.iter().enumerate().filter_map(|(column, impulse)| {
                let value = *response?.values.get(row * 3 + column)?;
                if self.is_zero(value) {
                    return None;
                }
                let value = local(value);
                Some(quote!(#value * #impulse))
            });
            quote!(#before #(+ #terms)*)
        });
        after.collect()
    }

    fn is_zero(&self, value: crate::program::operation::Value) -> bool {
        matches!(self.program.operation(value), crate::program::operation::Operation::Constant(bits) if bits.get() == 0.0)
    }
}
