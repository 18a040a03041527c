//! Puts the statements of a long function into groups: in builds with debug information the compiler recurses
//! into a scope for every variable of a function, and its stack overflows at about four thousand. The
//! variables of a group that are not used after it end with it.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

/// Functions with fewer statements are not grouped.
const MIN_STATEMENTS: usize = 3000;
/// Number of statements in a group.
const GROUP_SIZE: usize = 16;

/// A statement with the variables that it defines and those that it uses.
pub struct Statement {
    /// the statement
    pub tokens: TokenStream,
    /// the variables that it defines
    pub makes: Vec<String>,
    /// the variables that it uses
    pub takes: BTreeSet<String>,
}

/// The statements, in groups if there are many; `wanted` are variables that are used after them.
pub fn grouped(statements: Vec<Statement>, wanted: &BTreeSet<String>) -> TokenStream {
    if statements.len() <= MIN_STATEMENTS {
        let statements = statements.into_iter().map(|statement| statement.tokens);
        return quote!(#(#statements)*);
    }
    let mut needed = wanted.clone();
    let mut groups = Vec::new();
    for group in statements.chunks(GROUP_SIZE).rev() {
        let made = group.iter().flat_map(|statement| &statement.makes).filter(|name| needed.contains(*name));
        let made: Vec<_> = made.map(|name| format_ident!("{name}")).collect();
        let tokens = group.iter().map(|statement| &statement.tokens);
        groups.push(match &made[..] {
            [] => quote!({ #(#tokens)* }),
            [one] => quote!(let #one = { #(#tokens)* #one };),
            _ => quote!(let (#(#made),*) = { #(#tokens)* (#(#made),*) };),
        });
        needed.extend(group.iter().flat_map(|statement| statement.takes.iter().cloned()));
    }
    groups.reverse();
    quote!(#(#groups)*)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statement(number: usize, takes: &[usize]) -> Statement {
        let name = format_ident!("v{number}");
        let operands: Vec<_> = takes.iter().map(|operand| format_ident!("v{operand}")).collect();
        Statement {
            tokens: quote!(let #name = 0 #(+ #operands)*;),
            makes: vec![name.to_string()],
            takes: operands.iter().map(ToString::to_string).collect(),
        }
    }

    fn text(count: usize, wanted: usize) -> String {
        let statements = (0..count).map(|number| statement(number, &[number.saturating_sub(20)])).collect();
        grouped(statements, &BTreeSet::from([format!("v{wanted}")])).to_string()
    }

    #[test]
    fn few_statements_stay_as_they_are() {
        assert!(!text(MIN_STATEMENTS, 0).contains('{'));
    }

    #[test]
    fn a_group_gives_what_is_needed_after_it() {
        let text = text(MIN_STATEMENTS + 1, MIN_STATEMENTS - 7);
        assert_eq!(text.matches('{').count(), (MIN_STATEMENTS + 1).div_ceil(GROUP_SIZE));
        // v0 to v15 are each used by the statement 20 later; of the last full group only the wanted variable
        // is used.
        assert!(text.starts_with("let (v0 , v1 , v2 ,"), "{}", &text[..80]);
        assert!(text.contains(&format!("let v{} = {{", MIN_STATEMENTS - 7)));
    }
}
