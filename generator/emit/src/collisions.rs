//! Emits the methods for the collision and the impact without collision of a contact, and their result type.

use proc_macro2::TokenStream;
use quote::quote;

use super::Emitter;
use super::interface::{Argument, Failure, Field, Group, Method, Signature, Struct, Type};
use super::record;
use super::routine::Arguments;
use super::values::local;
use hodograph_program::program::Output;
use hodograph_program::program::{ContactQuantity, Quantity, Structure};

/// The quantities of a contact that every collision needs.
const NEEDED: [ContactQuantity; 6] = [
    ContactQuantity::Normal,
    ContactQuantity::First,
    ContactQuantity::Second,
    ContactQuantity::Velocity,
    ContactQuantity::Reduced,
    ContactQuantity::Response,
];

impl Emitter<'_> {
    /// Whether the collision of this contact can be computed.
    pub fn collides(&self, contact: usize) -> bool {
        !self.is_feature(contact)
            && NEEDED.iter().all(|&quantity| self.contact_output(contact, quantity).is_some())
    }

    /// The type of solved collisions, if there is a contact with collisions.
    pub fn collision_structure(&self) -> Option<Struct> {
        (0..self.mechanism.contacts.len()).find(|&contact| self.collides(contact))?;
        let vector = |name: &str, docs: &str| Field::new(name, Type::Vector(3), docs);
        let dependent = (!self.dependent.is_empty()).then(|| {
            let of = Type::of_struct("DependentSpeeds");
            Field::new("dependent_speeds", of, "dependent speeds after the collision")
        });
        let speeds = Type::of_struct("Speeds");
        let mut fields = vec![Field::new("speeds", speeds, "independent speeds after the collision (12a)")];
        fields.extend(dependent);
        fields.extend([
            vector("impulse", "impulse on the striking point along n, t, s, in N s"),
            vector("impulse_on_point", "impulse on the striking point along N.x, N.y, N.z, in N s"),
            vector(
                "impulse_on_struck",
                "impulse on what is struck along N.x, N.y, N.z, in N s: the opposite of `impulse_on_point`",
            ),
            vector("normal", "n along N.x, N.y, N.z"),
            vector("tangent", "t along N.x, N.y, N.z"),
            vector("binormal", "s along N.x, N.y, N.z"),
            vector("approach", "velocity of approach along n, t, s, in m/s"),
            vector("separation", "velocity of separation along n, t, s, in m/s"),
            Field::new("reduced", Type::Reduced, "reduced mass matrix along n, t, s, in 1/kg"),
            Field::new(
                "energy_change",
                Type::Number,
                "change of the kinetic energy, in J; it differs from `impact.contact_work` where motion is prescribed (24)",
            ),
            Field::new("path", Type::Path, "the phases of the collision"),
            Field::new(
                "impact",
                Type::Impact,
                "the outcome of the impact solver, along n, t, s: works, phases, sensitivity",
            ),
        ]);
        let docs =
            "A solved collision. n is the contact's normal, t lies along the slip of approach, s = n x t.";
        Some(Struct::of_results("Collision", docs, fields))
    }

    /// The type of solved collisions with its trait implementations.
    pub fn collision_type(&self) -> Option<TokenStream> {
        let krate = self.krate;
        let structure = self.collision_structure()?;
        let written = record::outcome(krate, &structure.name, &structure.names());
        let structure = structure.tokens(krate, &quote!(#[non_exhaustive]));
        Some(quote! {
            #structure

            impl<T: #krate::Scalar> Collision<T> {
                /// The collision in the type that all mechanisms share, without the speeds after it.
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

            #written
        })
    }

    /// The quantities from which a collision is computed.
    pub fn collision_quantities(&self, contact: usize) -> Vec<Quantity> {
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

    /// The arguments of a collision, without the surface.
    pub fn collision_arguments(&self, contact: usize) -> Arguments {
        Arguments { speeds: true, ..self.arguments(&self.collision_quantities(contact)) }
    }

    /// The quantities of a contact that the runtime reads, as an expression of the type `Contact`.
    pub fn known_contact(&self, contact: usize) -> TokenStream {
        let krate = self.krate;
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
        quote! {
            #krate::generated::Contact {
                normal: #normal,
                first: #first,
                second: #second,
                velocity: #velocity,
                reduced: #reduced,
                remainder: #remainder,
                prescribed_work: #prescribed,
            }
        }
    }

    /// The values of a quantity, each increased by its response times the impulse `i0`, `i1`, `i2`.
    pub fn changed(
        &self,
        quantity: Quantity,
        contact: usize,
        response: ContactQuantity,
    ) -> Option<Vec<TokenStream>> {
        let output = self.program.output(quantity)?;
        let before = output.values.iter().map(|&value| local(value)).map(|value| quote!(#value)).collect();
        Some(self.after(before, self.contact_output(contact, response)))
    }

    /// The methods `collide_..` and `impact_without_collision_..`, and the routine that they share.
    pub fn collide(&self, contact: usize) -> Group {
        let krate = self.krate;
        let words = self.contact_words(contact);
        let named = |prefix: &str| self.contact_method(prefix, contact);
        let [collide, without] = ["collide", "impact_without_collision"].map(named);
        let shared = crate::identifiers::ident(&named("struck"));
        let docs = format!(
            "Solves the collision at {words}.\n\nThe coordinates do not change; the speeds change by M^-1 V^T I (12a), I being the impulse."
        );
        let docs_without = format!(
            "Solves the impact without collision at {words}. The contact is closed, slides with f < 0 (31) and is pressed together, so that no finite force \
             exists (Painleve's paradox). The normal velocity is taken for zero; the speeds change as in `{collide}`. Where f > 0 or without slip \
             a finite force exists, and the error is `NoImpact`."
        );
        let resolve = match self.structure(contact) {
            Some(marker) => {
                quote!(#krate::generated::resolve_structured::<#krate::structure::#marker, T>)
            }
            None => quote!(#krate::generated::resolve),
        };
        let taken = self.collision_arguments(contact);
        let (private, passed) = (self.signature(taken), self.passed(taken));
        let body = self.collision_statements(contact, &quote!(resolve(&contact)));
        let method = |name: String, docs: String, resolve: TokenStream| {
            let mut arguments = self.declared(taken);
            arguments.push(Argument { name: "surface", of: Type::BudgetedSurface });
            let answer = Type::of_struct("Collision");
            let signature =
                Signature { name, docs, arguments, answer, failure: Failure::Collision, in_place: None };
            let body = quote!(Self::#shared(self, #passed |contact| #resolve(contact, surface)));
            Method { signature, attributes: quote!(#[inline]), body }
        };
        let without_collision = quote!(#krate::generated::resolve_without_collision);
        Group {
            methods: vec![method(collide, docs, resolve), method(without, docs_without, without_collision)],
            in_lanes: false,
            private: quote! {
                #[inline]
                fn #shared(
                    #private
                    resolve: impl ::core::ops::FnOnce(
                        &#krate::generated::Contact<T>,
                    ) -> ::core::result::Result<#krate::generated::Resolved<T>, #krate::ImpactError<T>>,
                ) -> ::core::result::Result<Collision<T>, #krate::CollisionError<T>> {
                    #body
                }
            },
        }
    }

    /// The type of the closed-form solution that the structure of the reduced matrix allows.
    pub fn structure(&self, contact: usize) -> Option<TokenStream> {
        match self.program.structures.get(contact) {
            Some(Structure::Planar) => Some(quote!(Planar)),
            Some(Structure::Balanced) => Some(quote!(Balanced)),
            Some(Structure::Diagonal) => Some(quote!(Diagonal)),
            Some(Structure::Isotropic) => Some(quote!(Isotropic)),
            Some(Structure::General) | None => None,
        }
    }

    /// The statements from a state to a solved collision; `solved` is the expression that solves the
    /// collision of `contact`.
    pub fn collision_statements(&self, contact: usize, solved: &TokenStream) -> TokenStream {
        let known = self.known_contact(contact);
        let speeds: Vec<TokenStream> = self.speeds.fields().map(|field| quote!(u.#field)).collect();
        let speeds = self.after(speeds, self.contact_output(contact, ContactQuantity::Response));
        let speeds = self.speeds.construct(&speeds);
        let dependent = (!self.dependent.is_empty())
            .then(|| self.changed(Quantity::DependentSpeeds, contact, ContactQuantity::DependentResponse))
            .flatten()
            .map(|after| {
                let value = self.dependent.construct(&after);
                quote!(dependent_speeds: #value,)
            });
        let body = self.compute(&self.collision_quantities(contact));
        quote! {
            #body
            let contact = #known;
            let hit = #solved?;
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

    /// Speeds plus response times impulse; structural zeros are left out.
    pub fn after(&self, before: Vec<TokenStream>, response: Option<&Output>) -> Vec<TokenStream> {
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

    fn is_zero(&self, value: hodograph_program::program::operation::Value) -> bool {
        matches!(self.program.operation(value), hodograph_program::program::operation::Operation::Constant(bits) if bits.get() == 0.0)
    }
}
