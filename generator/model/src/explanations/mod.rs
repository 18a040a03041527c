//! Explanations of all error codes, each with a wrong and a right example. `docs/errors.md` is generated from
//! them, and the tests run the examples.

mod mechanics;
mod names;
mod parts;
mod shapes;
mod silent;
mod syntax;
mod values;

use crate::diagnostics::Code;
use crate::diagnostics::codes::ALL;
use crate::syntax::tree::Section;

/// What a code means.
#[derive(Clone, Copy, Debug)]
pub struct Explanation {
    /// the code
    pub code: Code,
    /// what is wrong and why it matters
    pub text: &'static str,
    /// a model, or sections of [`FRAME`], with this mistake; absent where no text can show it
    pub wrong: Option<&'static str>,
    /// the same without it
    pub right: Option<&'static str>,
}

impl Explanation {
    /// The examples that there are, each with what it is.
    fn examples(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let named = [("wrong", self.wrong), ("right", self.right)];
        named.into_iter().filter_map(|(what, example)| Some((what, example?)))
    }
}

/// The model whose sections the examples replace or extend.
pub const FRAME: &str = "\
mechanism RodAndWall;
parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }
coordinates { q1: rad }
speeds { u1: rad/s }
frames { B = N.rotate(z, q1); }
points { G = O - l/2*B.y; P = O - l*B.y; }
bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
loads { gravity: -g*N.y; }
contacts { tip { point: P of Rod, normal: -N.x, gap: l - dot(position(P), N.x) } }
";

/// The explanation of a code.
pub fn explanation(code: Code) -> Option<&'static Explanation> {
    tables().find(|explanation| explanation.code == code)
}

fn tables() -> impl Iterator<Item = &'static Explanation> {
    let tables = [
        syntax::TABLE,
        names::TABLE,
        values::TABLE,
        mechanics::TABLE,
        shapes::TABLE,
        parts::TABLE,
        silent::TABLE,
    ];
    tables.into_iter().flatten()
}

/// The whole model of an example: its sections take the place of those of [`FRAME`]; a model with a head is
/// whole already.
pub fn whole(example: &str) -> String {
    within(FRAME, example)
}

/// The whole model of an example whose sections take the place of those of another model. Sections begin at
/// the beginning of a
/// line.
pub fn within(frame: &str, example: &str) -> String {
    if example.starts_with("mechanism") || example.starts_with("//!") {
        return example.to_owned();
    }
    let split = |text: &str| -> Vec<(Option<Section>, String)> {
        let mut parts: Vec<(Option<Section>, String)> = Vec::new();
        for line in text.lines() {
            let word = line.split([' ', '{']).next().unwrap_or("");
            match (Section::of_word(word), parts.last_mut()) {
                (None, Some((_, part))) => part.push_str(line),
                (section, _) => parts.push((section, line.to_owned())),
            }
            if let Some((_, part)) = parts.last_mut() {
                part.push('\n');
            }
        }
        parts
    };
    let own = split(example);
    let mut parts: Vec<(Option<Section>, String)> = split(frame)
        .into_iter()
        .filter(|(section, _)| own.iter().all(|(other, _)| other != section))
        .collect();
    parts.extend(own);
    // `None`, the head, sorts first
    parts.sort_by_key(|(section, _)| *section);
    parts.into_iter().map(|(_, part)| part).collect()
}

/// The page `docs/errors.md`.
pub fn page() -> String {
    let mut out = String::from(
        "# Errors and warnings\n\n\
         Every mistake in a model has a code. Codes keep their meaning from version to version. This page\n\
         is generated from the sources (`generator/model/src/explanations`); a test checks that each wrong example\n\
         gives its code and that each right one gives none. An example that does not begin with `mechanism`\n\
         shows sections that replace those of\n\
         this model:\n\n",
    );
    out.push_str(&format!("```text\n{FRAME}```\n\n"));
    out.push_str("| code | meaning |\n| --- | --- |\n");
    for (code, title) in ALL {
        let anchor = code.0.to_lowercase();
        out.push_str(&format!("| [{code}](#{anchor}) | {title} |\n"));
    }
    for (code, title) in ALL {
        out.push_str(&format!("\n## {code}\n\n*{}{}.* ", title[..1].to_uppercase(), &title[1..]));
        let Some(explanation) = explanation(*code) else { continue };
        out.push_str(explanation.text);
        out.push('\n');
        for (what, example) in explanation.examples() {
            out.push_str(&format!("\n```text\n// {what}\n{}\n```\n", example.trim_end()));
        }
    }
    out
}

/// What the page says of one code, for a terminal; `None`: there is no such code.
pub fn page_of(code: &str) -> Option<String> {
    let (code, title) = ALL.iter().find(|(known, _)| known.0 == code)?;
    let mut out = format!("{code}: {title}\n");
    let Some(explanation) = explanation(*code) else { return Some(out) };
    out.push_str(&format!("\n{}\n", explanation.text));
    for (what, example) in explanation.examples() {
        let lines = example.trim_end().lines().map(|line| format!("    {line}").trim_end().to_owned() + "\n");
        out.push_str(&format!("\n{what}:\n\n{}", lines.collect::<String>()));
    }
    let is_whole = |(_, example): (&str, &str)| whole(example) == example;
    if explanation.examples().any(|example| !is_whole(example)) {
        let lines: String = FRAME.lines().map(|line| format!("    {line}\n")).collect();
        out.push_str(&format!("\nSections stand in the place of those of this model:\n\n{lines}"));
    }
    Some(out)
}
