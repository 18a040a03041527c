//! Emits gaps and velocities of several contacts in one pass: a motion asks for them many times in every step.
//!
//! A routine computes the values that all contacts share, one for each pair of shapes those that its contacts do, and a
//! routine for each contact continues from there (see [`super::parts`]). The operations are those of the single methods,
//! and so are the bits.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::Emitter;
use super::super::routine::Arguments;
use super::super::values::local;
use super::parts::Part;
use hodograph_program::program::operation::Value;
use hodograph_program::program::{ContactQuantity, Quantity};

/// How far a contact is from being closed.
const NEAR: [ContactQuantity; 2] = [ContactQuantity::Gap, ContactQuantity::Validity];

/// Routines of several contacts: what they share, and one for each.
pub(super) struct Family {
    /// their common name
    name: &'static str,
    /// what each answers
    answer: TokenStream,
    /// the routines
    pub routines: TokenStream,
    /// statements that compute what all contacts share
    begin: TokenStream,
    /// pair by pair of shapes
    pairs: Vec<CallsOfPair>,
}

/// The calls of the routines of a pair of shapes.
pub(super) struct CallsOfPair {
    /// statements that compute what its contacts share beside what all do
    pub begin: TokenStream,
    /// for each contact, the call of its routine
    pub calls: Vec<(usize, TokenStream)>,
}

/// What the routines of contacts answer, and where that is put.
pub(super) struct Answer {
    /// its type
    pub of: TokenStream,
    /// the pattern of a slot
    pub slot: TokenStream,
    /// the statement that puts `found` there
    pub put: TokenStream,
    /// the answer of a contact that has no routine
    pub none: TokenStream,
}

impl CallsOfPair {
    /// The pattern of the contacts that have a routine.
    fn pattern(&self) -> TokenStream {
        pattern(self.calls.iter().map(|(contact, _)| *contact))
    }

    /// The answer for one of them.
    fn answer(&self) -> TokenStream {
        let arms = self.calls.iter().map(|(contact, call)| {
            let contact = Literal::usize_unsuffixed(*contact);
            quote!(#contact => #call,)
        });
        quote!(#(#arms)*)
    }
}

/// A pattern of numbers in ascending order.
fn pattern(numbers: impl Iterator<Item = usize>) -> TokenStream {
    let mut ranges: Vec<[usize; 2]> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => ranges.push([number, number]),
        }
    }
    let ranges = ranges.into_iter().map(|[first, last]| {
        let [from, to] = [first, last].map(Literal::usize_unsuffixed);
        if first == last { quote!(#from) } else { quote!(#from..=#to) }
    });
    quote!(#(#ranges)|*)
}

impl Emitter<'_> {
    /// The methods `gaps` and `contact_velocities` of the trait, and their routines. For a single contact the single
    /// methods suffice.
    pub(super) fn several_in_one_pass(&self) -> (TokenStream, TokenStream) {
        let krate = self.krate;
        let with = |quantity: ContactQuantity| -> Vec<usize> {
            let contacts = 0..self.mechanism.contacts.len();
            contacts.filter(|&contact| self.contact_output(contact, quantity).is_some()).collect()
        };
        let (mut methods, mut routines) = (TokenStream::new(), TokenStream::new());
        let mut add = |family: Family, method: TokenStream| {
            if (0..self.mechanism.contacts.len()).any(|contact| self.is_feature(contact)) {
                routines.extend(self.one_of(&family));
            }
            routines.extend(family.routines);
            methods.extend(method);
        };
        let known = with(ContactQuantity::Gap);
        if known.len() > 1 {
            let distance = quote!(#krate::Distance<T>);
            let family = self.family("near", &known, &NEAR, distance.clone(), |contact| {
                let [gap, validity] = NEAR.map(|quantity| match &self.values_of(contact, quantity)[..] {
                    [value] => quote!(::core::option::Option::Some(#value)),
                    _ => quote!(::core::option::Option::None),
                });
                quote!(#krate::Distance { gap: #gap, validity: #validity })
            });
            let none = quote!(::core::result::Result::Ok(#krate::Distance::default()));
            let method = self.each(&family, ("gaps", "distances", "the distances"), &none);
            add(family, method);
        }
        let known = with(ContactQuantity::Velocity);
        if known.len() > 1 {
            let vector = quote!(#krate::nalgebra::Vector3<T>);
            let family = self.family("moving", &known, &[ContactQuantity::Velocity], vector, |contact| {
                let values = self.values_of(contact, ContactQuantity::Velocity);
                quote!(#krate::nalgebra::Vector3::new(#(#values),*))
            });
            let none = self.undefined("velocity of this contact");
            let method = self.each(&family, ("contact_velocities", "velocities", "the velocities"), &none);
            add(family, method);
        }
        let known = with(ContactQuantity::Clearance);
        if !known.is_empty() {
            let family = self.family("clear", &known, &[ContactQuantity::Clearance], quote!(T), |pair| {
                let value = self.values_of(pair, ContactQuantity::Clearance);
                quote!(#(#value)*)
            });
            let none = self.undefined("clearance of this contact");
            methods.extend(self.pairs());
            methods.extend(self.each(&family, ("clearances", "clearances", "the clearances"), &none));
            routines.extend(family.routines);
        }
        (methods, routines)
    }

    /// The method of the trait that tells the first contact of a pair of shapes.
    fn pairs(&self) -> TokenStream {
        let contacts = &self.mechanism.contacts;
        let arms = contacts.chunk_by(|a, b| a.first_of_pair == b.first_of_pair).filter_map(|of_pair| {
            let first = of_pair.first()?.first_of_pair?;
            let pattern = pattern(first..first + of_pair.len());
            let first = Literal::usize_unsuffixed(first);
            Some(quote!(#pattern => ::core::option::Option::Some(#first),))
        });
        quote! {
            fn pair(&self, contact: usize) -> ::core::option::Option<usize> {
                match contact {
                    #(#arms)*
                    _ => ::core::option::Option::None,
                }
            }
        }
    }

    /// The local variables that hold a quantity of a contact.
    pub(super) fn values_of(&self, contact: usize, quantity: ContactQuantity) -> Vec<Ident> {
        let output = self.contact_output(contact, quantity);
        output.map_or(Vec::new(), |output| output.values.iter().map(|&value| local(value)).collect())
    }

    /// Routines of quantities of contacts.
    pub(super) fn family(
        &self,
        name: &'static str,
        known: &[usize],
        of: &[ContactQuantity],
        answer: TokenStream,
        result: impl Fn(usize) -> TokenStream,
    ) -> Family {
        let krate = self.krate;
        let divided = self.divided(&[], known, of);
        let arguments = self.arguments_of_contacts(known, of);
        let (unpack, passed) = (self.unpack(arguments), self.passed(arguments));
        let first = format_ident!("{name}_together");
        let mut routines =
            self.routine_that_shares(&first, arguments, &divided.together, &divided.shared, None);
        let several = divided.pairs.len() > 1;
        let count = Literal::usize_unsuffixed(divided.shared.len());
        let mut pairs = Vec::new();
        for pair in &divided.pairs {
            let number = pair.contacts.first().map_or(0, |(contact, _)| *contact);
            let first = format_ident!("{name}_of_pair_{number}");
            let mut begin = TokenStream::new();
            if several {
                let all = Some(&divided.shared[..]);
                routines.extend(self.routine_that_shares(
                    &first,
                    arguments,
                    &pair.together,
                    &pair.shared,
                    all,
                ));
                let count = Literal::usize_unsuffixed(pair.shared.len());
                begin = quote! {
                    let mut of_pair = [T::one(); #count];
                    Self::#first(self, #passed &shared, &mut of_pair)?;
                };
            }
            let (more, passed_more) = self.of_pair_as_argument(several, pair.shared.len());
            let mut calls = Vec::new();
            for (contact, part) in &pair.contacts {
                let name = format_ident!("{name}_{contact}");
                let fetched = self.fetched(part, &divided.shared, "shared");
                let of_pair = self.fetched(part, &pair.shared, "of_pair");
                let (body, result) = (self.body_of_part(part, &[]), result(*contact));
                let signature = self.signature(arguments);
                routines.extend(quote! {
                    fn #name(
                        #signature
                        shared: &[T; #count],
                        #more
                    ) -> ::core::result::Result<#answer, #krate::StateError> {
                        #fetched
                        #of_pair
                        #body
                        ::core::result::Result::Ok(#result)
                    }
                });
                calls.push((*contact, quote!(Self::#name(self, #passed &shared, #passed_more))));
            }
            pairs.push(CallsOfPair { begin, calls });
        }
        let begin = quote! {
            #unpack
            let mut shared = [T::one(); #count];
            Self::#first(self, #passed &mut shared)?;
        };
        Family { name, answer, routines, begin, pairs }
    }

    /// The arguments that quantities of contacts need.
    fn arguments_of_contacts(&self, contacts: &[usize], of: &[ContactQuantity]) -> Arguments {
        let has = |(contact, of): &(usize, ContactQuantity)| self.contact_output(*contact, *of).is_some();
        let all = contacts.iter().flat_map(|&contact| of.iter().map(move |&of| (contact, of)));
        let all = all.filter(has).map(|(contact, of)| Quantity::Contact(contact as u32, of));
        self.arguments(&all.collect::<Vec<_>>())
    }

    /// The routine that computes values which others share, from those that all contacts do.
    pub(super) fn routine_that_shares(
        &self,
        name: &Ident,
        arguments: Arguments,
        part: &Part<'_>,
        values: &[Value],
        all: Option<&[Value]>,
    ) -> TokenStream {
        let krate = self.krate;
        let signature = self.signature(arguments);
        let body = self.body_of_part(part, values);
        let count = Literal::usize_unsuffixed(values.len());
        let (from, to) = match all {
            Some(all) => {
                let count = Literal::usize_unsuffixed(all.len());
                (quote!(shared: &[T; #count],), format_ident!("of_pair"))
            }
            None => (quote!(), format_ident!("shared")),
        };
        let fetched = all.map(|all| self.fetched(part, all, "shared"));
        let values = values.iter().map(|&value| local(value));
        quote! {
            fn #name(
                #signature
                #from
                #to: &mut [T; #count],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #fetched
                #body
                *#to = [#(#values),*];
                ::core::result::Result::Ok(())
            }
        }
    }

    /// What the contacts of a pair share, as a parameter and as an argument, where there are several pairs.
    pub(super) fn of_pair_as_argument(&self, several: bool, count: usize) -> (TokenStream, TokenStream) {
        let count = Literal::usize_unsuffixed(count);
        match several {
            true => (quote!(of_pair: &[T; #count],), quote!(&of_pair,)),
            false => (quote!(), quote!()),
        }
    }

    /// The method that takes the number of a contact.
    pub(super) fn one_of(&self, family: &Family) -> TokenStream {
        let krate = self.krate;
        let Family { name, answer, begin, pairs, .. } = family;
        let (method, missing) = (format_ident!("{name}"), self.missing_contact());
        let arms = pairs.iter().map(|pair| {
            let (pattern, begin, answer) = (pair.pattern(), &pair.begin, pair.answer());
            match begin.is_empty() {
                true => answer,
                false => quote!(#pattern => { #begin match contact { #answer index => #missing } }),
            }
        });
        quote! {
            fn #method(
                &self,
                contact: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#answer, #krate::StateError> {
                #begin
                match contact {
                    #(#arms)*
                    index => #missing,
                }
            }
        }
    }

    /// The method of the trait that fills a slice, which `what` describes in errors; `none` is the answer for a contact
    /// that has no routine.
    fn each(
        &self,
        family: &Family,
        (method, slice, what): (&str, &str, &str),
        none: &TokenStream,
    ) -> TokenStream {
        let krate = self.krate;
        let Family { answer, begin, pairs, .. } = family;
        let (method, slice) = (format_ident!("{method}"), format_ident!("{slice}"));
        let each = self.pair_by_pair(
            pairs,
            &Answer {
                of: answer.clone(),
                slot: quote!(slot),
                put: quote!(*slot = found?;),
                none: none.clone(),
            },
        );
        quote! {
            fn #method(
                &self,
                contacts: &[usize],
                state: &#krate::State<'_, T>,
                #slice: &mut [#answer],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #krate::generated::check_length(#slice, contacts.len(), #what)?;
                #begin
                let slots = #slice.iter_mut();
                #each
                ::core::result::Result::Ok(())
            }
        }
    }

    /// The statements that compute the answers for `contacts` into `slots`. What the contacts of a pair share is computed
    /// once where they follow each other.
    pub(super) fn pair_by_pair(&self, pairs: &[CallsOfPair], answer: &Answer) -> TokenStream {
        let krate = self.krate;
        let Answer { of, slot, put, none } = answer;
        let missing = self.missing_contact();
        let found = quote!(let found: ::core::result::Result<#of, #krate::StateError>);
        let others = self.others(pairs);
        if let [all] = pairs {
            let answer = all.answer();
            let others = others.map(|others| quote!(#others => #none,));
            return quote! {
                for (&contact, #slot) in contacts.iter().zip(slots) {
                    #found = match contact {
                        #answer
                        #others
                        index => #missing,
                    };
                    #put
                }
            };
        }
        let arms = pairs.iter().map(|pair| {
            let (pattern, begin, answer) = (pair.pattern(), &pair.begin, pair.answer());
            quote! {
                #pattern => {
                    #begin
                    while let ::core::option::Option::Some((&contact, #slot)) =
                        rest.next_if(|(contact, _)| ::core::matches!(**contact, #pattern))
                    {
                        #found = match contact {
                            #answer
                            index => #missing,
                        };
                        #put
                    }
                }
            }
        });
        let others = others.map(|others| {
            quote! {
                #others => {
                    #found = #none;
                    if let ::core::option::Option::Some((_, #slot)) = rest.next() {
                        #put
                    }
                }
            }
        });
        quote! {
            let mut rest = contacts.iter().zip(slots).peekable();
            while let ::core::option::Option::Some(&(&contact, _)) = rest.peek() {
                match contact {
                    #(#arms)*
                    #others
                    index => return #missing,
                }
            }
        }
    }

    /// The pattern of contacts that have no routine, if there are any.
    fn others(&self, pairs: &[CallsOfPair]) -> Option<TokenStream> {
        let known: BTreeSet<usize> =
            pairs.iter().flat_map(|pair| pair.calls.iter().map(|(contact, _)| *contact)).collect();
        let all = 0..self.mechanism.contacts.len();
        (known.len() < all.len()).then(|| pattern(all.filter(|contact| !known.contains(contact))))
    }

    /// The error for a number `index` that no contact has.
    pub(super) fn missing_contact(&self) -> TokenStream {
        let krate = self.krate;
        quote! {
            ::core::result::Result::Err(#krate::StateError::Missing {
                kind: #krate::ComponentKind::Contact, index,
            })
        }
    }
}
