//! How names of a model are spelled in Rust.

const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self",
    "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield",
];

/// Is it a keyword of Rust, or reserved to become one?
pub fn is_keyword(name: &str) -> bool {
    KEYWORDS.contains(&name)
}

/// `BcAc` becomes `bc_ac`, `TwoSleds` `two_sleds`, `tip2Wall` `tip2_wall`, `HTTPPoint` `http_point`.
pub fn snake_case(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    let mut out = String::with_capacity(name.len() + 4);
    for (i, &c) in letters.iter().enumerate() {
        if c.is_uppercase() {
            let after_small = i > 0 && (letters[i - 1].is_lowercase() || letters[i - 1].is_numeric());
            let before_small = letters.get(i + 1).is_some_and(|n| n.is_lowercase());
            let within_capitals = i > 0 && letters[i - 1].is_uppercase();
            if after_small || (within_capitals && before_small) {
                out.push('_');
            }
            out.extend(c.to_lowercase());
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::snake_case;

    #[test]
    fn names_become_snake_case() {
        let pairs = [
            ("BcAc", "bc_ac"),
            ("TwoSleds", "two_sleds"),
            ("tip_wall", "tip_wall"),
            ("tip2Wall", "tip2_wall"),
            ("HTTPPoint", "http_point"),
            ("L", "l"),
            ("Arm7dof", "arm7dof"),
            ("WR_cont", "wr_cont"),
        ];
        for (name, rust) in pairs {
            assert_eq!(snake_case(name), rust);
        }
    }
}
