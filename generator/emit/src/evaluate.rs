//! Emits one method for a set of quantities that the user chooses; values that they share are computed once.
//!
//! A set names routines of the module. Equal operations of their quantities are the same value of the
//! program, so that a single routine for all of them computes it once.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};

use super::interface::{Failure, Field, InPlace, Method, Signature, Struct, Type};
use super::routine::Routine;
use super::{Emitter, Requests};
use crate::identifiers::{RECORDS, ident, means_another, pascal_case};
use hodograph_model::rust_names::is_keyword;
use hodograph_model::suggest::nearest;
use hodograph_program::program::Quantity;

/// The largest number of names in a message about an unknown name.
const MAX_LISTED: usize = 16;

/// A set of quantities: `evaluate control(mass_matrix, forcing)`.
#[derive(Clone, Debug)]
pub struct Set {
    /// the name of its method
    pub name: Ident,
    /// the names of the methods whose results it returns
    pub quantities: Vec<Ident>,
}

impl Set {
    /// The name of the type of its result: that of the method in `PascalCase`.
    pub fn type_name(&self) -> String {
        pascal_case(&self.name.to_string())
    }
}

impl Emitter<'_> {
    /// The types and the methods of sets.
    pub fn sets(&self, sets: &[Set]) -> (Vec<Struct>, Vec<Method>) {
        sets.iter().map(|set| self.set(set)).unzip()
    }

    /// All routines of the module.
    fn all_routines(&self) -> Vec<Routine> {
        let mut routines = self.routines();
        for contact in 0..self.mechanism.contacts.len() {
            routines.extend(self.contact_routines(contact));
            routines.extend(self.contact_tangent(contact).filter(|_| self.collides(contact)));
            routines.extend(self.contact_derivatives(contact));
        }
        routines
    }

    fn set(&self, set: &Set) -> (Struct, Method) {
        let named = |routines: Vec<Routine>| -> Vec<Routine> {
            let mut all: Vec<Option<Routine>> = routines.into_iter().map(Some).collect();
            let is = |routine: &Option<Routine>, name: &Ident| {
                routine.as_ref().is_some_and(|routine| *name == routine.name)
            };
            let find = |name: &Ident| all.iter_mut().find(|routine| is(routine, name))?.take();
            set.quantities.iter().filter_map(find).collect()
        };
        let mut quantities: Vec<Quantity> = Vec::new();
        for quantity in named(self.all_routines()).into_iter().flat_map(|routine| routine.quantities) {
            if !quantities.contains(&quantity) {
                quantities.push(quantity);
            }
        }
        let routines = named(self.all_routines());
        let (name, of_type) = (&set.name, set.type_name());
        let fields: Vec<Field> = routines
            .iter()
            .map(|routine| Field::new(&routine.name, routine.answer.clone(), &routine.docs))
            .collect();
        let (names, values): (Vec<Ident>, Vec<_>) =
            routines.iter().map(|routine| (ident(&routine.name), &routine.value)).unzip();
        let about = format!("What [`{}::{name}`] gives: quantities of one state.", self.name);
        let listed: Vec<String> = names.iter().map(|field| format!("`{field}`")).collect();
        let docs = format!(
            "{} of one state in one call. What they have in common is computed once; each is the answer of the method of its name.",
            listed.join(", ")
        );
        let signature = Signature {
            name: name.to_string(),
            docs,
            arguments: self.declared(self.arguments(&quantities)),
            answer: Type::of_struct(&of_type),
            failure: Failure::State,
            in_place: Some(InPlace::of(&name.to_string())),
        };
        let record = format_ident!("{of_type}");
        let body = self.compute_and_put(&quantities, &quote!(#record { #(#names: #values),* }));
        let structure = Struct::of_results(&of_type, &about, fields);
        (structure, Method { signature, attributes: quote!(#[inline]), body })
    }

    /// The mistakes in requests.
    pub fn mistakes_of(&self, requests: &Requests) -> Vec<(Span, String)> {
        let Requests { sets, specialised } = requests;
        if sets.is_empty() && specialised.is_empty() {
            return Vec::new();
        }
        let routines: BTreeSet<String> =
            self.all_routines().into_iter().map(|routine| routine.name).collect();
        let (methods, traits) = (self.groups(), self.traits());
        let methods = methods.iter().map(|group| group.tokens(self.krate));
        let mechanism_type = self.mechanism_type();
        let taken = names_after("fn", quote!(#mechanism_type #(#methods)* #traits));
        let mut found = Vec::new();
        for (number, set) in sets.iter().enumerate() {
            if let Some(message) = self.name_mistake(set, &sets[..number], &taken) {
                found.push((set.name.span(), message));
            }
            for (place, quantity) in set.quantities.iter().enumerate() {
                if set.quantities[..place].contains(quantity) {
                    found.push((quantity.span(), format!("`{quantity}` is twice in the set `{}`", set.name)));
                } else if !routines.contains(&quantity.to_string()) {
                    found.push((quantity.span(), self.unknown(&quantity.to_string(), &routines, &taken)));
                }
            }
        }
        for (number, collision) in specialised.iter().enumerate() {
            let name = &collision.name;
            let before = sets.iter().map(|set| &set.name);
            let mut before = before.chain(specialised[..number].iter().map(|other| &other.name));
            if let Some(message) = self.method_mistake(name, &taken, "collision") {
                found.push((name.span(), message));
            } else if before.any(|other| other == name) {
                let message =
                    format!("there is a method `{name}` already: choose another name for the collision");
                found.push((name.span(), message));
            }
            found.extend(self.contact_mistake(collision));
        }
        found
    }

    /// The mistake in the name of a method, if any; `what` is the kind of the request.
    fn method_mistake(&self, name: &Ident, taken: &BTreeSet<String>, what: &str) -> Option<String> {
        let (name, machine) = (name.to_string(), &self.name);
        let starts_well = pascal_case(&name).starts_with(|c: char| c.is_alphabetic());
        if is_keyword(&name) || name.starts_with("r#") || !starts_well {
            Some(format!("`{name}` cannot be the name of a method: choose another name for the {what}"))
        } else if taken.contains(&name) || taken.contains(&format!("{name}_into")) {
            Some(format!("`{machine}` has a method `{name}` already: choose another name for the {what}"))
        } else {
            None
        }
    }

    /// The mistake in the name of a set, if any.
    fn name_mistake(&self, set: &Set, before: &[Set], taken: &BTreeSet<String>) -> Option<String> {
        let (name, of_type) = (set.name.to_string(), set.type_name());
        let records = RECORDS.contains(&of_type.as_str()) || self.name == of_type;
        if let Some(message) = self.method_mistake(&set.name, taken, "set") {
            Some(message)
        } else if records {
            Some(format!(
                "the set `{name}` gives a struct `{of_type}`, and the module has a type of this name already: choose another name"
            ))
        } else if means_another(&of_type) {
            Some(format!(
                "the set `{name}` gives a struct `{of_type}`, and this name means something else in generated code: choose another name"
            ))
        } else if before.iter().any(|other| {
            let other_name = other.name.to_string();
            let both = [(&name, &other_name), (&other_name, &name)];
            other.name == set.name
                || other.type_name() == of_type
                || both.iter().any(|(one, other)| **one == format!("{other}_into"))
        }) {
            Some(format!("there is a set `{name}` already: each set is a method with a name of its own"))
        } else {
            None
        }
    }

    /// The message about a name that no routine has.
    fn unknown(&self, name: &str, routines: &BTreeSet<String>, taken: &BTreeSet<String>) -> String {
        let machine = &self.name;
        if taken.contains(name) {
            return format!(
                "`{name}` cannot be in a set: it is not a quantity of one state alone, or is computed from others; call the method by itself"
            );
        }
        // `reduced_matrix` for `reduced_matrix_tip`
        let prefix = format!("{name}_");
        let begun = routines.iter().find(|routine| routine.starts_with(&prefix)).map(String::as_str);
        let meant = begun.or_else(|| nearest(name, routines.iter().map(String::as_str)));
        match meant {
            Some(meant) => format!("`{machine}` has no quantity `{name}`; did you mean `{meant}`?"),
            None => {
                let listed: Vec<String> =
                    routines.iter().take(MAX_LISTED).map(|name| format!("`{name}`")).collect();
                let more = routines.len().saturating_sub(MAX_LISTED);
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                format!(
                    "`{machine}` has no quantity `{name}`; a set takes the names of methods that give quantities of one state: {}{more}",
                    listed.join(", ")
                )
            }
        }
    }
}

/// The names that follow a word in tokens, at any depth.
fn names_after(word: &str, tokens: TokenStream) -> BTreeSet<String> {
    let (mut names, mut open) = (BTreeSet::new(), vec![tokens]);
    while let Some(tokens) = open.pop() {
        let mut after = false;
        for tree in tokens {
            match tree {
                TokenTree::Ident(name) if after => {
                    names.insert(name.to_string());
                    after = false;
                }
                TokenTree::Ident(name) => after = name == word,
                TokenTree::Group(group) => {
                    open.push(group.stream());
                    after = false;
                }
                _ => after = false,
            }
        }
    }
    names
}
