//! Emits a collision as a single routine that is specialised to its contact: the solver is inlined, and the
//! parts of the surface that are known at compile time are folded in.

use proc_macro2::{Ident, Span};
use quote::{format_ident, quote};

use super::interface::{Argument, Failure, Method, Signature, Type};
use super::{Emitter, record};
use hodograph_model::suggest::nearest;

/// The runtime's variant of a law of restitution that models name so.
pub fn law_variant(name: &str) -> String {
    let (initial, rest) = name.split_at_checked(1).unwrap_or((name, ""));
    initial.to_uppercase() + rest
}

/// A specialised collision: `specialise strike(tip_wall, law = Stronge, mu = 0.3)`.
#[derive(Clone, Debug)]
pub struct Specialised {
    /// the name of its method
    pub name: Ident,
    /// the name of its contact in the module, `tip_wall` for `collide_tip_wall`
    pub contact: Ident,
    /// the law of restitution, as models name it; `None`: an argument of the method, as for the next two
    pub law: Option<&'static str>,
    /// the coefficient of friction
    pub mu: Option<f64>,
    /// the coefficient of restitution
    pub e: Option<f64>,
    /// the greatest number of quadratures, if there is a limit
    pub budget: Option<u32>,
}

impl Emitter<'_> {
    /// The contact of this name in the module.
    fn named_contact(&self, name: &Ident) -> Option<usize> {
        let wanted = format!("collide_{name}");
        let mut contacts = 0..self.mechanism.contacts.len();
        contacts.find(|&contact| self.collides(contact) && self.contact_method("collide", contact) == wanted)
    }

    /// The mistake in the contact of a specialised collision, if any.
    pub fn contact_mistake(&self, specialised: &Specialised) -> Option<(Span, String)> {
        let name = &specialised.contact;
        if self.named_contact(name).is_some() {
            return None;
        }
        let collide: Vec<String> = (0..self.mechanism.contacts.len())
            .filter(|&contact| self.collides(contact))
            .map(|contact| self.contact_method("collide", contact))
            .collect();
        let known = || collide.iter().filter_map(|method| method.strip_prefix("collide_"));
        let machine = &self.name;
        let help = match nearest(&name.to_string(), known()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if collide.is_empty() => "it has none".to_owned(),
            None => {
                let listed: Vec<String> = known().map(|contact| format!("`{contact}`")).collect();
                format!("it has {}", listed.join(", "))
            }
        };
        Some((name.span(), format!("`{machine}` has no contact `{name}` that collides; {help}")))
    }

    /// The methods of specialised collisions.
    pub fn specialised(&self, all: &[Specialised]) -> Vec<Method> {
        // Long routines are not split here, and sines and cosines are inlined.
        let emitter = Emitter {
            inlined: true,
            longest: usize::MAX,
            ..Emitter::new(self.mechanism, self.program, self.krate)
        };
        all.iter().filter_map(|specialised| emitter.specialised_collision(specialised)).collect()
    }

    fn specialised_collision(&self, specialised: &Specialised) -> Option<Method> {
        let krate = self.krate;
        let Specialised { name, law, mu, e, budget, .. } = specialised;
        let contact = self.named_contact(&specialised.contact)?;
        let known = [mu.is_some(), e.is_some(), law.is_some()];
        let of_surface = [("mu", Type::Number), ("e", Type::Number), ("law", Type::Law)];
        let left = of_surface.into_iter().zip(known).filter(|(_, known)| !known);
        let mut arguments = self.declared(self.collision_arguments(contact));
        arguments.extend(left.map(|((name, of), _)| Argument { name, of }));
        let given = [("mu", mu), ("e", e)].map(|(name, value)| {
            let name = format_ident!("{name}");
            value.map(|value| {
                let value = record::number(krate, value);
                quote!(let #name = #value;)
            })
        });
        let law = law.map(|law| format_ident!("{}", law_variant(law))).map(|law| quote!(#krate::Law::#law));
        let known = match &law {
            Some(law) => quote!(#krate::generated::OneLaw<{ #law.number() }>),
            None => quote!(#krate::generated::AnyLaw),
        };
        let given_law = law.map(|law| quote!(let law = #law;));
        let budget = budget.map(|budget| quote!(.with_budget(#budget)));
        let solved = match self.structure(contact) {
            Some(structure) => quote! {
                #krate::generated::resolve_structured_inlined::<#krate::structure::#structure, #known, T>
            },
            None => quote!(#krate::generated::resolve_inlined::<#known, T>),
        };
        let struck = self.collision_statements(contact, &quote!(#solved(&contact, &surface)));
        let body = quote! {
            #(#given)*
            #given_law
            let surface = #krate::Surface { mu, e, law } #budget;
            #struck
        };
        let docs = self.about_specialised(specialised, contact);
        let answer = Type::of_struct("Collision");
        let signature = Signature {
            name: name.to_string(),
            docs,
            arguments,
            answer,
            failure: Failure::Collision,
            in_place: None,
        };
        Some(Method { signature, attributes: quote!(#[inline(never)]), body })
    }

    fn about_specialised(&self, specialised: &Specialised, contact: usize) -> String {
        let Specialised { law, mu, e, budget, .. } = specialised;
        let known = [
            law.map(|law| format!("{}'s law", law_variant(law))),
            mu.map(|mu| format!("mu = {mu}")),
            e.map(|e| format!("e = {e}")),
            budget.map(|budget| format!("a budget of {budget} quadratures")),
        ];
        let known: Vec<String> = known.into_iter().flatten().collect();
        let known = if known.is_empty() { String::new() } else { format!(" for {}", known.join(", ")) };
        format!(
            "Solves the collision at {}{known}, as `{}` does, with the same bits, in one routine: on the usual way it calls no function.",
            self.contact_words(contact),
            self.contact_method("collide", contact)
        )
    }
}
