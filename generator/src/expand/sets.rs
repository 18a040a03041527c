//! Reads the sets of quantities in the input of `mechanism!`: `evaluate control(mass_matrix, forcing)`.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};

use super::report;
use crate::emit::Set;

const AS_IN: &str = "as in `evaluate control(mass_matrix, forcing)`";

/// The input without its sets.
#[derive(Default)]
pub struct Sets {
    /// the sets
    pub sets: Vec<Set>,
    /// what is wrong with them: from where, to where, and what
    pub wrong: Vec<(Span, Span, String)>,
    /// the tokens that are no sets
    pub rest: Vec<TokenTree>,
    /// the tokens of each set
    pub taken: Vec<Vec<TokenTree>>,
}

impl Sets {
    /// Takes the sets out of the input. Each begins with the word `evaluate` and may end with a comma or a
    /// semicolon.
    pub fn take(trees: Vec<TokenTree>) -> Self {
        let mut sets = Sets::default();
        let mut trees = trees.into_iter().peekable();
        while let Some(tree) = trees.next() {
            let names_model = sets.rest.last().is_some_and(|last| is_word(last, "mechanism"));
            if !is_word(&tree, "evaluate") || names_model {
                sets.rest.push(tree);
                continue;
            }
            let mut taken = vec![tree];
            taken.extend(trees.next_if(|tree| matches!(tree, TokenTree::Ident(_))));
            taken.extend(trees.next_if(|tree| matches!(tree, TokenTree::Group(_))));
            sets.read(&taken);
            taken.extend(trees.next_if(
                |tree| matches!(tree, TokenTree::Punct(sign) if matches!(sign.as_char(), ',' | ';')),
            ));
            sets.taken.push(taken);
        }
        sets
    }

    fn read(&mut self, taken: &[TokenTree]) {
        let (first, last) = (taken[0].span(), taken[taken.len() - 1].span());
        match taken {
            [_, TokenTree::Ident(name), TokenTree::Group(group)]
                if group.delimiter() == Delimiter::Parenthesis =>
            {
                if let Some(quantities) = self.quantities(name, group) {
                    self.sets.push(Set { name: name.clone(), quantities });
                }
            }
            [_, TokenTree::Ident(name), ..] => {
                let message = format!("the set `{name}` needs its quantities in parentheses, {AS_IN}");
                self.wrong.push((first, last, message));
            }
            _ => self.wrong.push((first, last, format!("a set of quantities needs a name, {AS_IN}"))),
        }
    }

    fn quantities(&mut self, name: &Ident, group: &Group) -> Option<Vec<Ident>> {
        let mut quantities = Vec::new();
        let mut trees = group.stream().into_iter();
        while let Some(tree) = trees.next() {
            let TokenTree::Ident(quantity) = tree else {
                let message = format!(
                    "expected the name of a quantity, which is that of the method that gives it, {AS_IN}"
                );
                self.wrong.push((tree.span(), tree.span(), message));
                return None;
            };
            match trees.next() {
                Some(TokenTree::Group(of)) => {
                    let of = of.stream().to_string().replace(' ', "");
                    let message = format!(
                        "a quantity has the name of the method that gives it: not `{quantity}({of})`, but `contact_state_{of}` or `reduced_matrix_{of}`, for instance"
                    );
                    self.wrong.push((quantity.span(), quantity.span(), message));
                    return None;
                }
                Some(TokenTree::Punct(sign)) if sign.as_char() == ',' => {}
                None => {}
                Some(other) => {
                    let message = format!(
                        "expected a comma after `{quantity}`: quantities are separated by commas, {AS_IN}"
                    );
                    self.wrong.push((other.span(), other.span(), message));
                    return None;
                }
            }
            quantities.push(quantity);
        }
        if quantities.is_empty() {
            let message = format!("the set `{name}` has no quantities: name some, {AS_IN}");
            self.wrong.push((name.span(), group.span(), message));
            return None;
        }
        Some(quantities)
    }

    /// The errors of all mistakes, also of those that `more` names; `None` where there are none.
    pub fn errors(&self, more: &[(Span, String)]) -> Option<TokenStream> {
        let own = self.wrong.iter().map(|(first, last, message)| report::error(*first, *last, message));
        let more = more.iter().map(|(at, message)| report::error(*at, *at, message));
        let all: Vec<TokenStream> = own.chain(more).collect();
        (!all.is_empty()).then(|| all.into_iter().collect())
    }

    /// The types that sets give.
    pub fn types(&self) -> Vec<String> {
        self.sets.iter().map(Set::type_name).collect()
    }
}

fn is_word(tree: &TokenTree, word: &str) -> bool {
    matches!(tree, TokenTree::Ident(ident) if ident == word)
}

#[cfg(test)]
mod tests {
    use std::str::FromStr;

    use super::*;

    fn taken(text: &str) -> (Vec<String>, Vec<String>, String) {
        let sets = Sets::take(TokenStream::from_str(text).unwrap().into_iter().collect());
        let read = sets.sets.iter().map(|set| {
            let quantities: Vec<String> = set.quantities.iter().map(ToString::to_string).collect();
            format!("{} = {}", set.name, quantities.join(" "))
        });
        let rest: TokenStream = sets.rest.into_iter().collect();
        let wrong = sets.wrong.into_iter().map(|(.., message)| message);
        (read.collect(), wrong.collect(), rest.to_string())
    }

    #[test]
    fn sets_are_taken_from_files_and_models() {
        let (sets, wrong, rest) = taken("\"a.mech\", evaluate x(a, b,), evaluate y(c)");
        assert_eq!(
            (sets, wrong, rest.as_str()),
            (vec!["x = a b".into(), "y = c".into()], vec![], "\"a.mech\" ,")
        );
        let (sets, wrong, rest) = taken("mechanism A; evaluate x(a); points { evaluate = O; }");
        assert_eq!((sets, wrong.len()), (vec!["x = a".into()], 0));
        assert_eq!(rest, "mechanism A ; points { evaluate = O ; }");
        let (sets, wrong, rest) = taken("mechanism evaluate; points { }");
        assert_eq!((sets.len(), wrong.len(), rest.as_str()), (0, 0, "mechanism evaluate ; points { }"));
    }

    #[test]
    fn mistakes_say_what_a_set_looks_like() {
        for (text, says) in [
            ("evaluate", "needs a name"),
            ("evaluate(a)", "needs a name"),
            ("evaluate x", "in parentheses"),
            ("evaluate x { a }", "in parentheses"),
            ("evaluate x()", "has no quantities"),
            ("evaluate x(a b)", "separated by commas"),
            ("evaluate x(name = \"y\")", "separated by commas"),
            ("evaluate x(\"a\")", "the name of a quantity"),
            ("evaluate x(contact(tip))", "`contact_state_tip`"),
        ] {
            let (sets, wrong, _) = taken(text);
            assert_eq!((sets.len(), wrong.len()), (0, 1), "{text}");
            assert!(wrong[0].contains(says), "{text}: {}", wrong[0]);
        }
    }
}
