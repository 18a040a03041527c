//! The language service on models with parts, in one file and in several.

use std::collections::HashMap;
use std::rc::Rc;

use hodograph_language::fixes::Action;
use hodograph_language::text::apply;
use hodograph_language::{Document, Span};
use hodograph_model::parts::{Files, Imported};

const LINK: &str = "/// A rod on a hinge.
part Link(hinge: point, base: frame, length: m = 0.5) {
    parameters { shared m: kg }
    coordinates { q: rad = 0.1 }
    speeds { u: rad/s }
    frames { B = base.rotate(z, q); }
    points { tip = hinge - length*B.y; }
    particles { Bob { point: tip, mass: m } }
}
";
const CHAIN: &str = "mechanism Chain;
import \"link.mech\";
parameters { m: kg = 1, g: m/s^2 = 9.81, k: N*m = 1 }
loads { gravity: -g*N.y; torque on a.B: -k*a.q*N.z; }
use Link as a(hinge: O, base: N);
use Link as b(hinge: a.tip, base: a.B);
";

struct Map(HashMap<String, String>);

impl Files for Map {
    fn read(&self, _: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let text = self.0.get(path).ok_or("is not there")?;
        Ok(Imported { key: path.to_owned(), name: path.to_owned(), text: text.clone() })
    }
}

fn chain(text: &str, link: &str) -> Document {
    let files = Map(HashMap::from([("link.mech".to_owned(), link.to_owned())]));
    Document::importing(text, "chain.mech", Rc::new(files))
}

/// The text after a change: of the model itself or of the part.
fn mended(document: &Document, link: &str, action: &Action) -> (String, String) {
    let own = document.text().as_str();
    match action.file {
        0 => (apply(own, &action.edits), link.to_owned()),
        _ => (own.to_owned(), apply(link, &action.edits)),
    }
}

fn all(text: &str) -> Span {
    Span { start: 0, end: text.len() as u32 }
}

#[test]
fn mistakes_in_parts_and_in_their_uses_are_mended() {
    assert_eq!(chain(CHAIN, LINK).findings(), []);
    // what is wrong, in which text, and what the first change says
    let cases = [
        (1, "rotate(z, q)", "rotate(z, qq)", "Change to `q`"),
        (1, "hinge - length", "hinges - length", "Change to `hinge`"),
        (1, "mass: m }", "mass: mm }", "Change to `m`"),
        (1, "base.rotate", "base.rotat", "Change to `rotate`"),
        (1, "q: rad", "q: radd", "Change to `rad`"),
        (1, "particles", "particels", "Change to `particles`"),
        (1, "point: tip, mass: m", "point: tip", "Add `mass: m`"),
        (1, "mass: m }", "mass: m*g/g }", "Share it with the mechanism: `shared g: m/s^2`"),
        (1, "    parameters { shared m: kg }\n", "", "Share it with the mechanism: `shared m: kg`"),
        (1, "shared m: kg }", "shared m: kg, spare: m = 1 }", "Remove `spare`"),
        (0, "use Link as b", "use Lnk as b", "Change to `Link`"),
        (0, "hinge: O", "hing: O", "Change to `hinge`"),
        (0, "hinge: a.tip", "hinge: a.tipp", "Change to `tip`"),
        (0, "hinge: O, base: N", "hinge: O", "Add `base: N`"),
        (0, "a(hinge: O, base: N)", "a", "Write `(hinge: O, base: N)`"),
        (0, "on a.B:", "on a.BB:", "Change to `B`"),
        (0, "gravity: -g", "gravity: -gg", "Change to `g`"),
    ];
    for (file, right, wrong, title) in cases {
        let (text, link) = match file {
            0 => (CHAIN.replacen(right, wrong, 1), LINK.to_owned()),
            _ => (CHAIN.to_owned(), LINK.replacen(right, wrong, 1)),
        };
        assert_ne!((text.as_str(), link.as_str()), (CHAIN, LINK), "{right}");
        let document = chain(&text, &link);
        let findings = document.findings();
        assert!(!findings.is_empty(), "{wrong}");
        assert!(findings.iter().any(|found| found.place.file == file), "{wrong}: {findings:?}");
        let there = if file == 0 { all(&text) } else { all(&link) };
        let actions = document.fixes_with_parts(file, there);
        let Some(action) = actions.iter().find(|action| action.title == title) else {
            panic!("{wrong}: {findings:?}\n{actions:?}");
        };
        assert_eq!(action.file, file, "{wrong}");
        let (text, link) = mended(&document, &link, action);
        let left = chain(&text, &link).findings();
        let errors = left.iter().filter(|found| found.is_error).count();
        assert_eq!(errors, 0, "{wrong}: {left:?}\n{text}\n{link}");
    }
}

/// A name that fits one use of a part and not another is offered for neither.
#[test]
fn what_does_not_cure_is_not_offered() {
    // `a` has no `tipp`, and the part has no name near it
    let text = CHAIN.replacen("hinge: a.tip,", "hinge: a.elsewhere,", 1);
    let document = chain(&text, LINK);
    assert_eq!(document.findings()[0].code, "E020");
    assert_eq!(document.fixes(all(&text)), []);
    for action in chain(CHAIN, &LINK.replace("hinge - length", "hinges - length")).fixes(all(CHAIN)) {
        assert_eq!((action.title.as_str(), action.file), ("Change to `hinge`", 1));
    }
}

#[test]
fn definitions_lead_into_imported_files() {
    let document = chain(CHAIN, LINK);
    let at = |word: &str| CHAIN.find(word).unwrap() as u32;
    for (place, word, text) in [
        (at("Link as a"), "Link(", LINK),
        (at("a.q*N"), "q: rad", LINK),
        (at("\"link.mech"), "/// A rod", LINK),
        (at("g*N.y"), "g: m/s", CHAIN),
    ] {
        let found = document.definition(place).unwrap_or_else(|| panic!("{word}"));
        assert_eq!(found.file, usize::from(text == LINK), "{word}");
        assert!(text[found.span.start as usize..].starts_with(word), "{word}: {found:?}");
    }
}
