//! Renaming in models with parts: the meaning is kept in every text, a clash is refused.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::rc::Rc;

use hodograph_language::rename_with_parts::{Known, Renamed, rename};
use hodograph_language::text::apply;
use hodograph_language::{Document, Span};
use hodograph_model::check;
use hodograph_model::parts::names::names;
use hodograph_model::parts::{Files, Imported};
use hodograph_model::source::{MAX_TOKENS, Source};
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::Token;
use hodograph_program::artifact::model_hash;

/// Texts by their names, which are their keys.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Texts(BTreeMap<String, String>);

impl Files for Texts {
    fn read(&self, _: Option<&Imported>, path: &str) -> Result<Imported, String> {
        let text = self.0.get(path).ok_or("is not there")?;
        Ok(Imported { key: path.to_owned(), name: path.to_owned(), text: text.clone() })
    }
}

impl Texts {
    fn of(texts: &[(&str, &str)]) -> Texts {
        Texts(texts.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect())
    }

    fn document(&self, name: &str) -> Document {
        Document::importing(self.0[name].as_str(), name, Rc::new(self.clone()))
    }

    /// Asks to rename what stands at a byte of a text, of all texts.
    fn ask(&self, name: &str, at: usize, new: &str) -> Result<Vec<Renamed>, String> {
        let documents: Vec<(&String, Document)> =
            self.0.keys().map(|name| (name, self.document(name))).collect();
        let all: Vec<Known<'_>> =
            documents.iter().map(|(key, document)| Known { key: key.as_str(), document }).collect();
        let of = all.iter().find(|known| known.key == name).unwrap();
        rename(*of, at as u32, new, &all)
    }

    fn after(&self, changes: &[Renamed]) -> Texts {
        let mut texts = self.clone();
        for change in changes {
            let text = texts.0.get_mut(&change.key).unwrap();
            assert_eq!(*text, change.text);
            *text = apply(text, &change.edits);
        }
        texts
    }

    /// The tokens without parts.
    fn expanded(&self, name: &str) -> Vec<Token> {
        let source = Source::file(name, self.0[name].as_str()).importing(self);
        let expansion = source.expansion().unwrap();
        assert!(expansion.mistakes.is_empty() && expansion.syntax.is_empty(), "{:?}", expansion.mistakes);
        expansion.tokens.clone()
    }
}

/// Which tokens of a model without parts are names of it, and not units or words.
fn named(tokens: &[Token]) -> Vec<bool> {
    let mut tokens = tokens.to_vec();
    for (i, token) in tokens.iter_mut().enumerate() {
        token.span = Span { start: i as u32, end: i as u32 + 1 };
    }
    let mut named = vec![false; tokens.len()];
    let symbols = check::analyse(&Source::inline("", tokens, Vec::new())).symbols;
    let declared = symbols.declared.iter().filter_map(|declared| declared.place);
    for place in declared.chain(symbols.uses.iter().map(|found| found.place)) {
        named[place.start as usize] = true;
    }
    named
}

/// The hash of a model without parts, with its names exchanged for those that another has there; these must
/// correspond one to one, and all else must be the same.
fn hash_with_names_of(other: &[Token], tokens: &[Token]) -> String {
    assert_eq!(tokens.len(), other.len());
    let is_name = named(tokens);
    assert_eq!(is_name, named(other));
    let (mut there, mut back) = (HashMap::new(), HashMap::new());
    let mut exchanged = tokens.to_vec();
    for (i, (a, b)) in tokens.iter().zip(other).enumerate().filter(|(i, _)| is_name[*i]) {
        assert_eq!(there.entry(&a.text).or_insert(&b.text), &&b.text);
        assert_eq!(back.entry(&b.text).or_insert(&a.text), &&a.text);
        exchanged[i].text.clone_from(&b.text);
    }
    model_hash(&Source::inline("", exchanged, Vec::new()))
}

fn shipped(names: &[&str]) -> Texts {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let name = |path: &str| path.rsplit_once('/').unwrap().1.to_owned();
    Texts(names.iter().map(|path| (name(path), text(path))).collect())
}

/// Every name of every text of the shipped models with parts, at the first place where it stands and at the last:
/// the expanded model is the same up to the name, and the way back leads to the same texts.
#[test]
fn every_name_of_models_with_parts_is_changed_and_back() {
    let mut count = 0;
    for (main, texts) in [
        ("chain.mech", shipped(&["tests/data/parts/chain.mech"])),
        ("hand.mech", shipped(&["tests/data/parts/hand.mech"])),
        ("dominoes.mech", shipped(&["models/shapes/dominoes.mech"])),
        ("quadruped.mech", shipped(&["tests/data/parts/quadruped.mech", "tests/data/parts/leg.mech"])),
    ] {
        let before = texts.expanded(main);
        for (name, text) in &texts.0 {
            let all = names(&lexer::tokens(text, MAX_TOKENS), &texts, MAX_TOKENS).unwrap();
            for (i, owned) in all.names.iter().enumerate() {
                let mut own = all.places.iter().filter(|place| place.file == 0 && place.names.contains(&i));
                let Some(place) = (if count % 2 == 0 { own.next() } else { own.next_back() }) else {
                    continue;
                };
                count += 1;
                let what = format!("{name}: {owned:?}");
                let changes = texts
                    .ask(name, place.span.start as usize, "other_name_2")
                    .unwrap_or_else(|why| panic!("{what}: {why}"));
                let changed = texts.after(&changes);
                assert_ne!(changed, texts);
                let after = changed.expanded(main);
                // where an equation was written down, as the names no longer state it, there are more tokens
                let stated =
                    changes.iter().flat_map(|change| &change.edits).any(|edit| edit.span.range().is_empty());
                if !stated {
                    let renamed = hash_with_names_of(&after, &before);
                    assert_eq!(renamed, model_hash(&Source::inline("", after, Vec::new())), "{what}");
                }
                let at = changed.0[name].find("other_name_2").unwrap_or_else(|| panic!("{what}"));
                let back = changed.ask(name, at, &owned.text).unwrap_or_else(|why| panic!("{what}: {why}"));
                let back = changed.after(&back);
                match stated {
                    false => assert_eq!(back, texts, "{what}"),
                    // with the equations it is the model as it was, and says what it said by names
                    true => {
                        let kinematics = |texts: &Texts| {
                            let model = texts.document(main).analysis().mechanism.clone().unwrap();
                            let count = model.kinematics.len();
                            (model.coordinates.len(), model.speeds.len(), count)
                        };
                        assert_eq!(kinematics(&back), kinematics(&texts), "{what}");
                        assert!(back.0[name].len() > texts.0[name].len(), "{what}");
                    }
                }
            }
        }
    }
    assert!(count > 140, "{count}");
}

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
use Link as b(hinge: a.tip, base: a.B, length: 0.3, q: 0.2);
";
const SINGLE: &str = "mechanism Single;
import \"link.mech\";
parameters { m: kg = 2, k: N*m = 3 }
loads { torque on rod.B: -k*rod.q*N.z; }
use Link as rod(hinge: O, base: N);
";

fn three() -> Texts {
    Texts::of(&[("link.mech", LINK), ("chain.mech", CHAIN), ("single.mech", SINGLE)])
}

fn replaced(text: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// A coordinate of a part is seen from outside by its name; both models that import the part change with it,
/// whichever text was asked, and what the names `q` and `u` stated is written down.
#[test]
fn a_name_of_an_imported_part_changes_in_all_models_that_import_it() {
    let expected = Texts::of(&[
        (
            "link.mech",
            &replaced(
                LINK,
                &[
                    ("q: rad", "angle: rad"),
                    ("(z, q)", "(z, angle)"),
                    (
                        "Bob { point: tip, mass: m } }",
                        "Bob { point: tip, mass: m } }\n    kinematics { d(angle)/dt = u; }",
                    ),
                ],
            ),
        ),
        ("chain.mech", &replaced(CHAIN, &[("a.q*", "a.angle*"), ("q: 0.2", "angle: 0.2")])),
        ("single.mech", &replaced(SINGLE, &[("rod.q", "rod.angle")])),
    ]);
    for (name, word, behind) in [
        ("link.mech", "q: rad", 0),
        ("chain.mech", "a.q", 2),
        ("chain.mech", "q: 0.2", 0),
        ("single.mech", "rod.q", 4),
    ] {
        let texts = three();
        let at = texts.0[name].find(word).unwrap() + behind;
        let changes = texts.ask(name, at, "angle").unwrap();
        assert_eq!(texts.after(&changes), expected, "{name}: {word}");
    }
    for name in ["chain.mech", "single.mech"] {
        assert_eq!(expected.document(name).findings(), three().document(name).findings());
    }
}

/// What a part shares is the mechanism's, and so that of each mechanism that uses the part.
#[test]
fn a_shared_parameter_changes_with_that_of_the_mechanisms() {
    let texts = three();
    let changes = texts.ask("chain.mech", CHAIN.find("m: kg").unwrap(), "mass_of_bob").unwrap();
    let changed = texts.after(&changes);
    assert_eq!(changed.0["chain.mech"], CHAIN.replace("m: kg", "mass_of_bob: kg"));
    assert_eq!(changed.0["single.mech"], SINGLE.replace("m: kg", "mass_of_bob: kg"));
    let link = replaced(LINK, &[("shared m:", "shared mass_of_bob:"), ("mass: m ", "mass: mass_of_bob ")]);
    assert_eq!(changed.0["link.mech"], link);
    // what only one mechanism has leaves the others alone
    let changes = texts.ask("chain.mech", CHAIN.find("k: N*m").unwrap(), "stiffness").unwrap();
    let keys: Vec<&str> = changes.iter().map(|change| change.key.as_str()).collect();
    assert_eq!(keys, ["chain.mech"]);
}

#[test]
fn arguments_parts_and_instances_are_renamed_where_they_are_used() {
    let texts = three();
    let ask = |name: &str, word: &str, new: &str| {
        let at = texts.0[name].find(word).unwrap();
        texts.after(&texts.ask(name, at, new).unwrap())
    };
    let changed = ask("link.mech", "hinge: point", "pivot");
    assert_eq!(changed.0["link.mech"], LINK.replace("hinge:", "pivot:").replace("= hinge", "= pivot"));
    assert_eq!(changed.0["chain.mech"], CHAIN.replace("hinge:", "pivot:"));
    let changed = ask("chain.mech", "Link as a", "Rod");
    assert_eq!(changed.0["single.mech"], SINGLE.replace("Link", "Rod"));
    assert_eq!(changed.0["link.mech"], LINK.replace("part Link", "part Rod"));
    let changed = ask("chain.mech", "a(hinge: O", "upper");
    assert_eq!(changed.0["chain.mech"], CHAIN.replace("a.", "upper.").replace("as a(", "as upper("));
    assert_eq!(
        (&changed.0["link.mech"], &changed.0["single.mech"]),
        (&texts.0["link.mech"], &texts.0["single.mech"])
    );
}

#[test]
fn a_clash_is_refused_and_says_where() {
    for (name, word, new, why) in [
        ("link.mech", "q: rad", "u", "the part `Link` has a name `u` already"),
        ("link.mech", "q: rad", "length", "the part `Link` has a name `length` already"),
        ("chain.mech", "a(hinge: O", "b", "the mechanism has a name `b` already"),
        ("chain.mech", "m: kg", "tip", "the part `Link` has a name `tip` already"),
        // another model has this name, which shares the parameter too
        ("chain.mech", "m: kg", "rod", "the mechanism has a name `rod` already"),
        ("link.mech", "q: rad", "N", "`N` is given"),
        ("link.mech", "q: rad", "2q", "is no name"),
        ("link.mech", "q: rad", "fn", "keyword of Rust"),
        ("chain.mech", "O, base", "M", "`O` is given"),
        ("chain.mech", "mechanism", "M", "no name of the model stands here"),
    ] {
        let texts = three();
        let at = texts.0[name].find(word).unwrap();
        let refused = texts.ask(name, at, new).unwrap_err();
        assert!(refused.contains(why), "{name}: {word} -> {new}: {refused}");
    }
    // `a_q` of the mechanism and `q` of the instance `a` would be one name of the model without parts
    let chain = CHAIN.replace("k: N*m = 1", "a_angle: N*m = 1").replace("-k*", "-a_angle*");
    let texts = Texts::of(&[("link.mech", LINK), ("chain.mech", &chain)]);
    let refused = texts.ask("link.mech", LINK.find("q: rad").unwrap(), "angle").unwrap_err();
    assert!(refused.contains("`chain.mech` has a mistake") && refused.contains("a.angle"), "{refused}");
    // a model that imports the part and cannot be read may use the name
    let texts =
        Texts::of(&[("link.mech", LINK), ("single.mech", &SINGLE.replace("rod.q*N.z; }", "rod.q*N.z;"))]);
    let refused = texts.ask("link.mech", LINK.find("q: rad").unwrap(), "angle").unwrap_err();
    assert!(refused.contains("`single.mech` may have this name too"), "{refused}");
    let mistaken = LINK.replace("tip = hinge", "tip hinge");
    let texts = Texts::of(&[("link.mech", &mistaken)]);
    let refused = texts.ask("link.mech", LINK.find("q: rad").unwrap(), "angle").unwrap_err();
    assert!(refused.contains("correct its mistakes first"), "{refused}");
}

const ROW: &str = "mechanism Row;
count n = 3;
part Slide(base: point, size: count = 2) {
    parameters { M: kg = 1 }
    for i in 1..size {
        coordinates { q[i]: m = 0.1 }
        speeds { u[i]: m/s }
        points { P[i] = base + q[i]*N.x; }
        particles { Bob[i] { point: P[i], mass: M } }
    }
}
parameters { k: N/m = 2, d: m = 1 }
for i in 1..n { use Slide as s[i](base: O + i*d*N.y, size: n - i + 1); }
for i in 1..2 { loads { force on s[i].P[i]: -s[i].q[i]*k*N.x; } }
";

/// Counts, indices, and names with indices.
#[test]
fn names_with_indices_counts_and_indices_are_renamed() {
    let row = ROW;
    let texts = Texts::of(&[("row.mech", row)]);
    assert_eq!(texts.document("row.mech").findings(), []);
    for (word, new, changes) in [
        ("n = 3", "number", &[("count n", "count number"), ("..n", "..number"), ("n - i", "number - i")][..]),
        (
            "i in 1..n",
            "j",
            &[
                ("for i in 1..n", "for j in 1..n"),
                ("s[i](base: O + i*", "s[j](base: O + j*"),
                ("n - i", "n - j"),
            ],
        ),
        (
            "i in 1..2",
            "j",
            &[("for i in 1..2", "for j in 1..2"), ("s[i].P[i]: -s[i].q[i]", "s[j].P[j]: -s[j].q[j]")],
        ),
        ("s[i](", "slide", &[("s[i]", "slide[i]")]),
        ("size: count", "links", &[("size", "links")]),
        (
            "q[i]: m",
            "x",
            &[
                ("q[i]", "x[i]"),
                ("mass: M } }\n", "mass: M } }\n        kinematics { d(x[i])/dt = u[i]; }\n"),
            ],
        ),
        (
            "u[i]: m",
            "v",
            &[
                ("u[i]", "v[i]"),
                ("mass: M } }\n", "mass: M } }\n        kinematics { d(q[i])/dt = v[i]; }\n"),
            ],
        ),
    ] {
        let at = row.find(word).unwrap();
        let changed =
            texts.after(&texts.ask("row.mech", at, new).unwrap_or_else(|why| panic!("{word}: {why}")));
        assert_eq!(changed.0["row.mech"], replaced(row, changes), "{word}");
        assert_eq!(changed.document("row.mech").findings(), []);
    }
    // the index would be that of the loop around it
    let nested = row
        .replace("for i in 1..2 {", "for j in 1..2 { for i in j..j {")
        .replace("*k*N.x; } }", "*k*N.x; } } }");
    let texts = Texts::of(&[("row.mech", &nested)]);
    assert_eq!(texts.document("row.mech").findings(), []);
    let refused = texts.ask("row.mech", nested.find("j in").unwrap(), "i");
    assert!(refused.is_ok_and(|changes| changes[0].edits.len() == 3));
}

/// `arm[i].tip` is a name of two parts, where some of `arm` are of one and some of the other.
#[test]
fn a_place_that_stands_for_names_of_two_parts_changes_both() {
    let part = |name: &str, axis: &str| {
        LINK.replace("part Link", &format!("part {name}")).replace("rotate(z", &format!("rotate({axis}"))
    };
    let mechanism = "parameters { m: kg = 1 }
use Hinge as arm[1](hinge: O, base: N);
use Swing as arm[2](hinge: arm[1].tip, base: arm[1].B);
for i in 1..2 { loads { force on arm[i].tip: -m*9.81*N.y*arm[i].length/arm[i].length; } }
";
    let mechanism = mechanism.replace("*arm[i].length/arm[i].length", "").replace("9.81", "g");
    let mechanism = mechanism.replace("m: kg = 1 }", "m: kg = 1, g: m/s^2 = 9.81 }");
    let text = format!("mechanism Two;\n{}{}{mechanism}", part("Hinge", "z"), part("Swing", "x"));
    let texts = Texts::of(&[("two.mech", &text)]);
    assert_eq!(texts.document("two.mech").findings(), []);
    let at = text.find("tip = hinge").unwrap();
    let changed = texts.after(&texts.ask("two.mech", at, "end").unwrap());
    let expected =
        text.replace("tip = ", "end = ").replace("point: tip", "point: end").replace("].tip", "].end");
    assert_eq!(changed.0["two.mech"], expected);
}
