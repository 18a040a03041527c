//! What may be chosen as the new name of something.

use hodograph_model::model::names;
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Name;

/// Whether this can be a name.
pub(crate) fn valid_name(new: &str) -> Result<(), String> {
    let tokens = lexer::tokens(new, 4);
    let name = match tokens.as_slice() {
        [token] if token.kind == TokenKind::Name && token.span.range() == (0..new.len()) => {
            Name { text: token.text.clone(), span: token.span }
        }
        _ => return Err(format!("`{new}` is no name: names are made of letters, digits and `_`")),
    };
    names::reserved(&name).map_or(Ok(()), |reserved| Err(reserved.message))
}
