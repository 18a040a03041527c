//! Reads the arguments of `mechanism!` beside the model: sets of quantities, `evaluate control(mass_matrix,
//! forcing)`, and specialised collisions, `specialise strike(tip_wall, law = Stronge)`.

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::{Error, LitFloat, LitInt, Result, Token, parenthesized, token};

use hodograph_emit::{Requests, Set, Specialised, law_variant};
use hodograph_model::{suggest::nearest, words};

const SET: &str = "as in `evaluate control(mass_matrix, forcing)`";
const COLLISION: &str = "as in `specialise strike(tip_wall, law = Stronge, mu = 0.3)`";

/// The words that begin an argument.
pub const WORDS: [&str; 2] = ["evaluate", "specialise"];

/// The input without its arguments.
#[derive(Default)]
pub struct Arguments {
    /// what they ask for
    pub requests: Requests,
    /// what is wrong with them
    pub wrong: Option<Error>,
    /// the tokens that are no arguments
    pub rest: Vec<TokenTree>,
    /// the tokens of each argument
    pub taken: Vec<Vec<TokenTree>>,
}

impl Arguments {
    /// Takes the arguments out of the input. Each begins with its word and may end with a comma or a semicolon.
    pub fn take(trees: Vec<TokenTree>) -> Self {
        let mut arguments = Arguments::default();
        let mut trees = trees.into_iter().peekable();
        while let Some(tree) = trees.next() {
            let names_model = arguments.rest.last().is_some_and(|last| is_word(last, "mechanism"));
            let Some(word) = WORDS.into_iter().find(|word| is_word(&tree, word)).filter(|_| !names_model)
            else {
                arguments.rest.push(tree);
                continue;
            };
            let mut taken = vec![tree];
            taken.extend(trees.next_if(|tree| matches!(tree, TokenTree::Ident(_))));
            taken.extend(trees.next_if(|tree| matches!(tree, TokenTree::Group(_))));
            arguments.read(word, taken.iter().cloned().collect());
            taken.extend(trees.next_if(
                |tree| matches!(tree, TokenTree::Punct(sign) if matches!(sign.as_char(), ',' | ';')),
            ));
            arguments.taken.push(taken);
        }
        arguments
    }

    fn read(&mut self, word: &str, tokens: TokenStream) {
        let read = if word == "evaluate" {
            set(tokens).map(|set| self.requests.sets.push(set))
        } else {
            specialised(tokens).map(|collision| self.requests.specialised.push(collision))
        };
        if let Err(error) = read {
            also(&mut self.wrong, error);
        }
    }

    /// The errors of all mistakes, also of those that `more` names; `None` where there are none.
    pub fn errors(&self, more: &[(Span, String)]) -> Option<TokenStream> {
        let mut all = self.wrong.clone();
        more.iter().for_each(|(at, message)| also(&mut all, Error::new(*at, message)));
        all.map(|error| error.to_compile_error())
    }

    /// The types that sets give.
    pub fn types(&self) -> Vec<String> {
        self.requests.sets.iter().map(Set::type_name).collect()
    }
}

fn also(all: &mut Option<Error>, error: Error) {
    match all {
        Some(all) => all.combine(error),
        None => *all = Some(error),
    }
}

fn is_word(tree: &TokenTree, word: &str) -> bool {
    matches!(tree, TokenTree::Ident(ident) if ident == word)
}

/// The name of an argument, and what `read` reads in the parentheses after it.
fn named<R>(
    argument: TokenStream,
    [nameless, bare]: [&str; 2],
    read: impl FnOnce(&Ident, TokenStream, ParseStream) -> Result<R>,
) -> Result<R> {
    let whole = argument.clone();
    let parser = |input: ParseStream| {
        input.call(Ident::parse_any)?;
        if !input.peek(Ident::peek_any) {
            return Err(Error::new_spanned(&whole, nameless));
        }
        let from = input.cursor().token_stream();
        let name = input.call(Ident::parse_any)?;
        if !input.peek(token::Paren) {
            return Err(Error::new_spanned(&whole, bare.replace("NAME", &name.to_string())));
        }
        let content;
        parenthesized!(content in input);
        read(&name, from, &content)
    };
    parser.parse2(argument)
}

/// `evaluate control(mass_matrix, forcing)`
fn set(tokens: TokenStream) -> Result<Set> {
    let nameless = format!("a set of quantities needs a name, {SET}");
    let bare = format!("the set `NAME` needs its quantities in parentheses, {SET}");
    named(tokens, [&nameless, &bare], |name, from, content| {
        let mut quantities = Vec::new();
        while !content.is_empty() {
            let quantity = quantity(content)?;
            if !content.is_empty() && content.parse::<Token![,]>().is_err() {
                let message =
                    format!("expected a comma after `{quantity}`: quantities are separated by commas, {SET}");
                return Err(content.error(message));
            }
            quantities.push(quantity);
        }
        if quantities.is_empty() {
            let message = format!("the set `{name}` has no quantities: name some, {SET}");
            return Err(Error::new_spanned(from, message));
        }
        Ok(Set { name: name.clone(), quantities })
    })
}

/// The name of a quantity.
fn quantity(content: ParseStream) -> Result<Ident> {
    let quantity = content.call(Ident::parse_any).map_err(|error| {
        let message =
            format!("expected the name of a quantity, which is that of the method that gives it, {SET}");
        Error::new(error.span(), message)
    })?;
    if content.peek(token::Paren) || content.peek(token::Bracket) || content.peek(token::Brace) {
        let group = content.parse::<proc_macro2::Group>()?;
        let of = group.stream().to_string().replace(' ', "");
        let message = format!(
            "a quantity has the name of the method that gives it: not `{quantity}({of})`, but `contact_state_{of}` or `reduced_matrix_{of}`, for instance"
        );
        return Err(Error::new(quantity.span(), message));
    }
    Ok(quantity)
}

/// `specialise strike(tip_wall, law = Stronge, mu = 0.3, e = 0.8, budget = 8)`
fn specialised(tokens: TokenStream) -> Result<Specialised> {
    let nameless = format!("a specialised collision needs a name, {COLLISION}");
    let bare = format!("the collision `NAME` needs its contact in parentheses, {COLLISION}");
    named(tokens, [&nameless, &bare], |name, from, content| {
        let contact = match content.call(Ident::parse_any) {
            Ok(contact) if !content.peek(Token![=]) => contact,
            _ => {
                let message = format!("the collision `{name}` needs its contact first, {COLLISION}");
                return Err(Error::new_spanned(from, message));
            }
        };
        let mut found =
            Specialised { name: name.clone(), contact, law: None, mu: None, e: None, budget: None };
        let mut before = found.contact.clone();
        while !content.is_empty() {
            if content.parse::<Token![,]>().is_err() {
                return Err(content.error(format!("expected a comma after `{before}`, {COLLISION}")));
            }
            if !content.is_empty() {
                before = given(content, &mut found)?;
            }
        }
        Ok(found)
    })
}

/// What is known of the surface while compiling: `law = Stronge`.
fn given(content: ParseStream, collision: &mut Specialised) -> Result<Ident> {
    const KNOWN: [&str; 4] = ["law", "mu", "e", "budget"];
    let wants = "a specialised collision takes `law`, `mu`, `e` and `budget` after its contact";
    let word = content
        .call(Ident::parse_any)
        .map_err(|error| Error::new(error.span(), format!("{wants}, {COLLISION}")))?;
    let name = word.to_string();
    if !KNOWN.contains(&name.as_str()) {
        let help = nearest(&name, KNOWN.into_iter()).map(|meant| format!("; did you mean `{meant}`?"));
        let help = help.unwrap_or_else(|| format!(": {wants}"));
        return Err(Error::new(word.span(), format!("`{name}` is not known here{help}")));
    }
    if content.parse::<Token![=]>().is_err() {
        return Err(content.error(format!("expected `=` and a value after `{name}`, {COLLISION}")));
    }
    let twice = match name.as_str() {
        "law" => collision.law.replace(law(content)?).is_some(),
        "mu" => collision.mu.replace(coefficient(content, "mu", f64::INFINITY)?).is_some(),
        "e" => collision.e.replace(coefficient(content, "e", 1.0)?).is_some(),
        _ => {
            let wrong = "a budget is a whole number of quadratures, from 0 to 4294967294";
            let wrong = |error: Error| Error::new(error.span(), wrong);
            let number = content.parse::<LitInt>().map_err(wrong)?;
            let budget = number.base10_parse().ok().filter(|&budget: &u32| budget < u32::MAX);
            let Some(budget) = budget else { return Err(wrong(Error::new(number.span(), ""))) };
            collision.budget.replace(budget).is_some()
        }
    };
    if twice { Err(Error::new(word.span(), format!("`{name}` is given twice"))) } else { Ok(word) }
}

fn law(content: ParseStream) -> Result<&'static str> {
    let laws: Vec<String> = words::LAWS.iter().map(|law| law_variant(law.text)).collect();
    let listed = laws.iter().map(|law| format!("`{law}`")).collect::<Vec<_>>().join(", ");
    let law = content
        .call(Ident::parse_any)
        .map_err(|error| Error::new(error.span(), format!("a law of restitution is one of {listed}")))?;
    let name = law.to_string();
    let known = laws.iter().position(|law| *law == name).and_then(|place| words::LAWS.get(place));
    known.map(|law| law.text).ok_or_else(|| {
        let help =
            nearest(&name, laws.iter().map(String::as_str)).map(|meant| format!("did you mean `{meant}`?"));
        let help = help.unwrap_or_else(|| format!("there are {listed}"));
        Error::new(law.span(), format!("there is no law of restitution `{name}`; {help}"))
    })
}

/// A number from 0 to `most`.
fn coefficient(content: ParseStream, name: &str, most: f64) -> Result<f64> {
    let minus = content.parse::<Option<Token![-]>>()?;
    let (at, number) = if content.peek(LitFloat) {
        let number = content.parse::<LitFloat>()?;
        (number.to_token_stream(), number.base10_parse::<f64>().ok())
    } else if content.peek(LitInt) {
        let number = content.parse::<LitInt>()?;
        (number.to_token_stream(), number.base10_parse::<u64>().ok().map(|number| number as f64))
    } else {
        let message = format!(
            "`{name}` is a number here, as in `{name} = 0.3`; left out, it is an argument of the method"
        );
        return Err(content.error(message));
    };
    let at = quote::quote!(#minus #at);
    let signed = number.map(|number| if minus.is_some() { -number } else { number });
    let range =
        if most.is_finite() { format!("lies between 0 and {most}") } else { "is not negative".to_owned() };
    match signed {
        Some(number) if (0.0..=most).contains(&number) && number.is_finite() => Ok(number),
        _ => Err(Error::new_spanned(at, format!("`{name}` {range}"))),
    }
}

#[cfg(test)]
mod tests {
    use std::str::FromStr;

    use super::*;

    fn taken(text: &str) -> Arguments {
        Arguments::take(TokenStream::from_str(text).unwrap().into_iter().collect())
    }

    fn wrong(arguments: &Arguments) -> Vec<String> {
        let all = arguments.wrong.iter().flat_map(|error| error.clone().into_iter());
        all.map(|error| error.to_string()).collect()
    }

    fn sets(text: &str) -> (Vec<String>, Vec<String>, String) {
        let arguments = taken(text);
        let read = arguments.requests.sets.iter().map(|set| {
            let quantities: Vec<String> = set.quantities.iter().map(ToString::to_string).collect();
            format!("{} = {}", set.name, quantities.join(" "))
        });
        let (read, wrong) = (read.collect(), wrong(&arguments));
        let rest: TokenStream = arguments.rest.into_iter().collect();
        (read, wrong, rest.to_string())
    }

    #[test]
    fn sets_are_taken_from_files_and_models() {
        let (read, wrong, rest) = sets("\"a.mech\", evaluate x(a, b,), evaluate y(c)");
        assert_eq!(
            (read, wrong, rest.as_str()),
            (vec!["x = a b".into(), "y = c".into()], vec![], "\"a.mech\" ,")
        );
        let (read, wrong, rest) = sets("mechanism A; evaluate x(a); points { evaluate = O; }");
        assert_eq!((read, wrong.len()), (vec!["x = a".into()], 0));
        assert_eq!(rest, "mechanism A ; points { evaluate = O ; }");
        for name in WORDS {
            let text = format!("mechanism {name} ; points {{ }}");
            let arguments = taken(&text);
            assert!(arguments.taken.is_empty() && arguments.wrong.is_none());
            assert_eq!(arguments.rest.into_iter().collect::<TokenStream>().to_string(), text);
        }
    }

    #[test]
    fn specialised_collisions_are_taken() {
        let arguments = taken(
            "\"a.mech\", evaluate x(a), specialise hit(tip), specialise b(c_d, law = Newton, e = 1, mu = 0.25, budget = 8,)",
        );
        assert_eq!(wrong(&arguments), Vec::<String>::new());
        let [hit, b] = &arguments.requests.specialised[..] else { panic!("two collisions") };
        assert_eq!((hit.name.to_string(), hit.contact.to_string()), ("hit".into(), "tip".into()));
        assert_eq!((hit.law, hit.mu, hit.e, hit.budget), (None, None, None, None));
        assert_eq!((b.name.to_string(), b.contact.to_string()), ("b".into(), "c_d".into()));
        assert_eq!((b.law, b.mu, b.e, b.budget), (Some("newton"), Some(0.25), Some(1.0), Some(8)));
    }

    #[test]
    fn mistakes_say_what_an_argument_looks_like() {
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
            ("specialise", "needs a name"),
            ("specialise x", "in parentheses"),
            ("specialise x[tip]", "in parentheses"),
            ("specialise x()", "needs its contact first"),
            ("specialise x(law = Newton)", "needs its contact first"),
            ("specialise x(tip law = Newton)", "a comma after `tip`"),
            ("specialise x(tip, 3)", "takes `law`, `mu`, `e` and `budget`"),
            ("specialise x(tip, lw = Newton)", "did you mean `law`?"),
            ("specialise x(tip, law)", "expected `=`"),
            ("specialise x(tip, law = 3)", "one of `Newton`, `Poisson`, `Stronge`"),
            ("specialise x(tip, law = Strong)", "did you mean `Stronge`?"),
            ("specialise x(tip, law = Newton e = 1)", "a comma after `law`"),
            ("specialise x(tip, mu = friction)", "`mu` is a number here"),
            ("specialise x(tip, mu = -0.1)", "`mu` is not negative"),
            ("specialise x(tip, mu = 1e400)", "`mu` is not negative"),
            ("specialise x(tip, e = 1.5)", "`e` lies between 0 and 1"),
            ("specialise x(tip, e = 0.5, e = 0.5)", "`e` is given twice"),
            ("specialise x(tip, budget = 1.5)", "whole number"),
            ("specialise x(tip, budget = 4294967295)", "whole number"),
        ] {
            let arguments = taken(text);
            let asked = arguments.requests.sets.len() + arguments.requests.specialised.len();
            let wrong = wrong(&arguments);
            assert_eq!((asked, wrong.len()), (0, 1), "{text}: {wrong:?}");
            assert!(wrong[0].contains(says), "{text}: {}", wrong[0]);
        }
    }
}
