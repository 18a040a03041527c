//! Emits the methods of a contact: gap, velocities, reduced matrix, and those of `collisions` and `closed`.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::Emitter;
use super::interface::{Group, Type};
use super::methods::about;
use super::record::number;
use super::routine::Routine;
use super::values::local;
use hodograph_model::model::mechanism::Surface;
use hodograph_program::program::quantity::table::CONTACT;
use hodograph_program::program::{ContactQuantity, Output, Quantity};

impl Emitter<'_> {
    pub fn contact_output(&self, contact: usize, quantity: ContactQuantity) -> Option<&Output> {
        let output = self.program.output(Quantity::Contact(contact as u32, quantity))?;
        (!output.values.is_empty()).then_some(output)
    }

    /// The methods of all contacts.
    pub fn contacts(&self) -> Vec<Group> {
        (0..self.mechanism.contacts.len()).flat_map(|contact| self.contact(contact)).collect()
    }

    fn contact(&self, contact: usize) -> Vec<Group> {
        if self.is_feature(contact) {
            return self
                .surface(contact)
                .map(|private| Group { private, ..Group::default() })
                .into_iter()
                .collect();
        }
        let routines = self.contact_routines(contact);
        let methods = routines.iter().map(|routine| self.routine(routine)).collect();
        let mut groups = vec![Group { methods, in_lanes: true, ..Group::default() }];
        groups.extend(self.collides(contact).then(|| self.collide(contact)));
        groups.extend(self.closes(contact).then(|| self.closed(contact)));
        groups.extend(self.collides(contact).then(|| self.derivatives(contact)));
        groups.extend(self.surface(contact).map(|private| Group { private, ..Group::default() }));
        groups
    }

    /// The method that returns the surface that the model states, if it states one.
    fn surface(&self, contact: usize) -> Option<TokenStream> {
        let krate = self.krate;
        let stated = self.mechanism.contacts.get(contact)?;
        let Surface { mu, e, law } = stated.surface?;
        let name = crate::identifiers::ident(&self.contact_method("surface", contact));
        let docs = format!(
            " Friction and restitution that the model states for {}.",
            about(&stated.name, &stated.docs)
        );
        let law = format_ident!("{}", crate::law_variant(law));
        let [mu, e] = [mu, e].map(|value| number(krate, value));
        Some(quote! {
            #[doc = #docs]
            #[inline]
            #[must_use]
            pub fn #name() -> #krate::Surface<T> {
                #krate::Surface { mu: #mu, e: #e, law: #krate::Law::#law }
            }
        })
    }

    /// The routines of a contact without those of its derivatives.
    pub fn contact_routines(&self, contact: usize) -> Vec<Routine> {
        if self.is_feature(contact) {
            return Vec::new();
        }
        let queries = CONTACT.iter().filter_map(|&(quantity, _)| {
            let output = self.contact_output(contact, quantity)?;
            let (name, docs) = self.describe(output.quantity)?;
            let (answer, value) = self.shaped(output);
            Some(Routine { name, docs, quantities: vec![output.quantity], answer, value })
        });
        let several = [
            self.contact_basis(contact),
            self.reduced_matrix(contact),
            self.contact_matrices(contact),
            self.contact_state(contact),
        ];
        queries.chain(several.into_iter().flatten()).collect()
    }

    /// The quantities of the state of a contact.
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

    /// Gap, basis, velocity and reduced matrix in one routine.
    fn contact_state(&self, contact: usize) -> Option<Routine> {
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
            "Gap, contact basis, velocity and reduced mass matrix at {} in one call.",
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
        Some(Routine { name, docs, quantities, answer: Type::ContactState, value })
    }

    pub fn contact_words(&self, contact: usize) -> String {
        self.mechanism
            .contacts
            .get(contact)
            .map_or(String::new(), |contact| about(&contact.name, &contact.docs))
    }

    fn contact_basis(&self, contact: usize) -> Option<Routine> {
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
        Some(Routine { name, docs, quantities, answer: Type::Matrix(3, 3), value })
    }

    fn reduced_matrix(&self, contact: usize) -> Option<Routine> {
        let output = self.contact_output(contact, ContactQuantity::Reduced)?;
        let value = self.reduced(output);
        let docs = format!(
            "Reduced mass matrix V M^-1 V^T along the contact basis, in 1/kg, at {}.",
            self.contact_words(contact)
        );
        let name = self.contact_method("reduced_matrix", contact);
        Some(Routine { name, docs, quantities: vec![output.quantity], answer: Type::Reduced, value })
    }

    /// Partial velocities and reduced matrix in one routine, since they share values.
    fn contact_matrices(&self, contact: usize) -> Option<Routine> {
        let partial = self.contact_output(contact, ContactQuantity::PartialVelocities)?;
        let reduced = self.contact_output(contact, ContactQuantity::Reduced)?;
        let (shape, velocities) = self.matrix(partial);
        let matrix = self.reduced(reduced);
        let docs = format!(
            "Partial velocities and reduced mass matrix at {} in one call: those of `{}` and `{}`.",
            self.contact_words(contact),
            self.contact_method("partial_velocities", contact),
            self.contact_method("reduced_matrix", contact)
        );
        let name = self.contact_method("contact_matrices", contact);
        let answer = Type::Pair(Box::new(shape), Box::new(Type::Reduced));
        let quantities = vec![partial.quantity, reduced.quantity];
        Some(Routine { name, docs, quantities, answer, value: quote!((#velocities, #matrix)) })
    }

    pub fn reduced(&self, output: &Output) -> TokenStream {
        let krate = self.krate;
        let entries = output.values.iter().map(|&value| local(value));
        quote!(#krate::ReducedMatrix::new(#(#entries),*))
    }
}
