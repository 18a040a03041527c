//! Converts names of links and joints to names of the model language.

use std::collections::{HashMap, HashSet};

/// Names that a model must not declare: predefined names, and keywords of Rust.
const RESERVED: &[&str] = &[
    "N", "O", "time", "pi", "_", "as", "break", "const", "continue", "crate", "else", "enum", "extern",
    "false", "fn", "for", "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref",
    "return", "self", "Self", "static", "struct", "super", "trait", "true", "type", "unsafe", "use", "where",
    "while", "async", "await", "dyn", "abstract", "become", "box", "do", "final", "gen", "macro", "override",
    "priv", "try", "typeof", "unsized", "virtual", "yield",
];

/// The largest number of letters of a name of a link, joint or actuator; the names that are formed from it
/// have up to 100, as many as the language allows.
const LONGEST: usize = 80;

/// Shorter names for the long ones of a description, which stay distinct.
#[derive(Default)]
pub struct Shortened {
    /// the names of the file and those that are taken
    taken: HashSet<String>,
    short: HashMap<String, String>,
}

impl Shortened {
    /// The names of a file.
    pub fn of<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        Shortened { taken: names.map(str::to_owned).collect(), short: HashMap::new() }
    }

    /// The name under which the model knows what has this name: its beginning, if it is long.
    pub fn name(&mut self, name: &str) -> String {
        if name.chars().count() <= LONGEST {
            return name.to_owned();
        }
        if let Some(short) = self.short.get(name) {
            return short.clone();
        }
        let beginning: String = name.chars().take(LONGEST - 10).collect();
        let mut all =
            std::iter::once(beginning.clone()).chain((2..).map(|count| numbered(&beginning, count)));
        let short = all.find(|short| self.taken.insert(short.clone())).unwrap_or(beginning);
        self.short.insert(name.to_owned(), short.clone());
        short
    }

    /// A sentence for each name that was shortened.
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self
            .short
            .iter()
            .map(|(name, short)| {
                format!("`{name}` is called `{short}`, because names are at most {LONGEST} letters long")
            })
            .collect();
        notes.sort_unstable();
        notes
    }
}

/// Assigns unique names.
#[derive(Debug)]
pub struct Names {
    taken: HashSet<String>,
    folded: HashSet<String>,
    /// the names that had to be changed beyond replacing characters
    pub renamed: Vec<String>,
}

impl Names {
    /// Only the reserved names are taken.
    pub fn new() -> Self {
        let taken = RESERVED.iter().map(|word| (*word).to_owned()).collect();
        Names { taken, folded: HashSet::new(), renamed: Vec::new() }
    }

    /// A free name as similar to `wish` as possible. Names that differ only by case and underscores count as
    /// equal, because they could become equal in generated code.
    pub fn give(&mut self, wish: &str) -> String {
        let [name] = self.give_together([wish]);
        name
    }

    /// Free names that end alike, for what belongs together by its names: the speed `u_hip_n2` is that of the
    /// coordinate `q_hip_n2`.
    pub fn give_together<const N: usize>(&mut self, wishes: [&str; N]) -> [String; N] {
        let first = wishes.map(identifier);
        let mut names = first.clone();
        let mut count = 1;
        while names.iter().any(|name| self.taken.contains(name) || self.folded.contains(&folded(name))) {
            count += 1;
            names = first.clone().map(|first| numbered(&first, count));
        }
        for (first, name) in first.iter().zip(&names).filter(|(first, name)| first != name) {
            self.renamed.push(format!("`{first}` is called `{name}`, because that name is taken"));
        }
        self.taken.extend(names.clone());
        self.folded.extend(names.iter().map(|name| folded(name)));
        names
    }
}

/// The names that a file states, of which those that the import makes up keep clear.
#[derive(Default)]
pub struct Stated(HashSet<String>);

impl Stated {
    /// Adds a name of the file.
    pub fn add(&mut self, name: &str) {
        self.0.insert(folded(&identifier(name)));
    }

    /// A name as similar to `wish` as possible that is neither stated nor made up already.
    pub fn make_up(&mut self, wish: &str) -> String {
        let all = std::iter::once(wish.to_owned()).chain((2..).map(|count| numbered(wish, count)));
        let free = all.into_iter().find(|name| self.0.insert(folded(&identifier(name))));
        free.unwrap_or_else(|| wish.to_owned())
    }
}

fn numbered(name: &str, count: usize) -> String {
    format!("{name}_n{count}")
}

/// `text` with `_` for every character that an identifier cannot have.
pub fn identifier(text: &str) -> String {
    let name: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match name.chars().next() {
        None => "unnamed".to_owned(),
        Some(first) if first.is_ascii_digit() => format!("_{name}"),
        Some(_) if name.chars().all(|c| c == '_') => "unnamed".to_owned(),
        Some(_) => name,
    }
}

/// `two sleds` as the name of a mechanism: `TwoSleds`.
pub fn mechanism(text: &str) -> String {
    let mut name = String::new();
    for word in text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()) {
        let mut letters = word.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        name.extend(letters);
    }
    match name.chars().next() {
        None => "Robot".to_owned(),
        Some(first) if first.is_ascii_digit() => format!("Robot{name}"),
        Some(_) => name,
    }
}

fn folded(name: &str) -> String {
    name.chars().filter(|&c| c != '_').map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_and_distinct() {
        let mut names = Names::new();
        assert_eq!(names.give("q_left-hip.roll"), "q_left_hip_roll");
        assert_eq!(names.give("q_left_hip_roll"), "q_left_hip_roll_n2");
        assert_eq!(names.give("7up"), "_7up");
        assert_eq!(names.give("N"), "N_n2");
        assert_eq!(names.give("Étage"), "_tage");
        assert_eq!(names.give("u_arm"), "u_arm");
        assert_eq!(names.give_together(["q_arm", "u_arm"]), ["q_arm_n2", "u_arm_n2"]);
        let mut stated = Stated::default();
        stated.add("hip-frame");
        assert_eq!(
            ["hip_frame", "hip_frame", "leg"].map(|wish| stated.make_up(wish)),
            ["hip_frame_n2", "hip_frame_n3", "leg"]
        );
        assert_eq!(mechanism("anymal_c v2"), "AnymalCV2");
        assert_eq!(mechanism("3d"), "Robot3d");
    }
}
