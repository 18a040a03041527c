//! Names of a model as Rust knows them: which words it keeps for itself, and how names of types become names of
//! values.

/// Words that Rust keeps for itself.
const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self",
    "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield",
];

/// Names that cannot be bound to a value in a generated module: in a pattern they mean variants of Rust's
/// prelude and a constant of the module.
const VALUES: &[&str] = &["Some", "None", "Ok", "Err", "DESCRIPTION"];

/// Whether a field of that name cannot be taken out of its struct by name, as generated code does.
pub fn is_value(name: &str) -> bool {
    VALUES.contains(&name)
}

/// Whether it is a Rust keyword.
pub fn is_keyword(name: &str) -> bool {
    KEYWORDS.contains(&name)
}

/// `BcAc` -> `bc_ac`, `tip_wall` -> `tip_wall`, `L2Norm` -> `l2_norm`.
pub fn snake_case(name: &str) -> String {
    let characters: Vec<char> = name.chars().collect();
    let mut snake = String::new();
    for (index, &character) in characters.iter().enumerate() {
        if character.is_uppercase() {
            let previous = index.checked_sub(1).map(|previous| characters[previous]);
            let starts_word = match previous {
                None | Some('_') => false,
                // An acronym's last capital begins the next word: `HTTPServer` -> `http_server`.
                Some(previous) if previous.is_uppercase() => {
                    characters.get(index + 1).is_some_and(|next| next.is_lowercase())
                }
                Some(_) => true,
            };
            if starts_word {
                snake.push('_');
            }
            snake.extend(character.to_lowercase());
        } else {
            snake.push(character);
        }
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases() {
        let cases = [
            ("BcAc", "bc_ac"),
            ("tip_wall", "tip_wall"),
            ("L", "l"),
            ("HTTPServer", "http_server"),
            ("A0", "a0"),
        ];
        for (name, snake) in cases {
            assert_eq!(snake_case(name), snake);
        }
    }
}
