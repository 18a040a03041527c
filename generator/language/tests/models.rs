//! The language service on all models of the repository and on all cases of mistakes.

use std::path::Path;

use hodograph_language::completion::Proposed;
use hodograph_language::text::{Encoding, apply};
use hodograph_language::{Document, Span};
use hodograph_model::check::check;
use hodograph_model::diagnostics::Diagnostic;
use hodograph_model::format;
use hodograph_model::source::Source;
use hodograph_model::syntax::lexer;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Section;

fn folder(path: &str) -> Vec<(String, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path);
    let mut out: Vec<(String, String)> = std::fs::read_dir(path)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mech"))
        .map(|path| {
            (path.display().to_string(), String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned())
        })
        .collect();
    out.sort();
    assert!(!out.is_empty());
    out
}

fn models() -> Vec<(String, String)> {
    folder("models")
}

fn mistaken() -> Vec<(String, String)> {
    folder("generator/tests/diagnostics")
}

/// The names of a text that stand for something declared, by its tokens alone: neither units nor words of the
/// language.
fn names_by_tokens(text: &str, declared: &[&str]) -> Vec<Span> {
    let tokens = lexer::tokens(text, 1_000_000);
    let mut found = Vec::new();
    // brackets and, of the innermost braces, whether a unit is being read
    let (mut open, mut section, mut in_unit) = (Vec::new(), None, false);
    for (i, token) in tokens.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| &tokens[i]);
        let next = tokens.get(i + 1);
        match token.kind {
            TokenKind::Open(_) => {
                open.push(i);
                in_unit = false;
            }
            TokenKind::Close(_) => {
                open.pop();
            }
            TokenKind::Sign(':') if open.len() == 1 => {
                use Section::*;
                in_unit = matches!(
                    section,
                    Some(Parameters | Inputs | Coordinates | Speeds | Dependent | Definitions)
                );
            }
            TokenKind::Sign('=' | ',' | ';') => in_unit = false,
            TokenKind::Name => {
                let opens = next.is_some_and(|next| next.kind == TokenKind::Open('{'));
                if open.is_empty() && opens {
                    section = Section::of_word(&token.text);
                }
                let member = before.is_some_and(|before| before.is_sign('.'));
                let call = next.is_some_and(|next| next.kind == TokenKind::Open('('));
                let field = open.len() > 1 && next.is_some_and(|next| next.is_sign(':'));
                let axis = section == Some(Section::Frames)
                    && ["x", "y", "z"].contains(&token.text.as_str())
                    && open.len() == 2;
                let load = section == Some(Section::Loads)
                    && open.len() == 1
                    && next.is_some_and(|n| n.is_sign(':'))
                    && before.is_some_and(|b| b.is_sign(';') || b.kind == TokenKind::Open('{'));
                let rate = before.is_some_and(|b| b.is_sign('/')) && token.text == "dt";
                let name =
                    !in_unit && !member && !call && !field && !axis && !load && !rate && !open.is_empty();
                if name && declared.contains(&token.text.as_str()) {
                    found.push(token.span);
                }
            }
            _ => {}
        }
    }
    found
}

#[test]
fn the_table_holds_all_names_and_only_these() {
    for (path, text) in models() {
        let document = Document::new(text.as_str());
        let symbols = document.symbols();
        let mut places: Vec<Span> = symbols.uses.iter().map(|found| found.place).collect();
        places.extend(symbols.declared.iter().filter_map(|declared| declared.place));
        places.sort();
        places.dedup();
        let declared: Vec<&str> = symbols.declared.iter().map(|declared| declared.name.as_str()).collect();
        assert_eq!(places, names_by_tokens(&text, &declared), "{path}");
        for found in &symbols.uses {
            assert_eq!(text[found.place.range()], symbols.of(found.symbol).unwrap().name, "{path}");
        }
    }
}

#[test]
fn a_name_is_changed_everywhere_and_back() {
    for (path, text) in models() {
        let document = Document::new(text.as_str());
        // some of all kinds
        let names = &document.symbols().declared;
        for declared in names.iter().rev().step_by(1 + names.len() / 6) {
            let Some(place) = declared.place else { continue };
            let edits =
                document.rename(place.start, "other_name_2").unwrap_or_else(|why| panic!("{path}: {why}"));
            let stated = edits.len() > document.references(place.start, true).len();
            let changed = apply(&text, &edits);
            assert_ne!(changed, text);
            let other = Document::new(changed.as_str());
            let at = other.symbols().named("other_name_2").unwrap().place.unwrap();
            assert!(check(&Source::file(&path, changed.as_str())).mechanism.is_some(), "{path}");
            let back = apply(&changed, &other.rename(at.start, &declared.name).unwrap());
            if !stated {
                assert_eq!(back, text, "{path}: {}", declared.name);
                continue;
            }
            // a rate that held by name is an equation now
            let kinematics =
                |text: &str| check(&Source::file(&path, text)).mechanism.unwrap().kinematics.len();
            assert_eq!(kinematics(&back), kinematics(&text), "{path}: {}", declared.name);
            assert!(back.len() > text.len() && back.contains("d(q") && back.contains(")/dt = u"));
        }
    }
}

#[test]
fn a_name_that_is_taken_or_none_is_refused() {
    let (_, text) = models().into_iter().find(|(path, _)| path.ends_with("slider_crank.mech")).unwrap();
    let document = Document::new(text.as_str());
    let at = text.find("l1: m").unwrap() as u32;
    for (new, why) in [
        ("l2", "is a parameter of this model already"),
        ("N", "is a frame of this model already"),
        ("fn", "keyword of Rust"),
        ("a b", "is no name"),
        ("2l", "is no name"),
        ("", "is no name"),
        ("_", "needs a letter"),
    ] {
        let refused = document.rename(at, new).unwrap_err();
        assert!(refused.contains(why), "{new}: {refused}");
    }
    assert!(document.rename(text.find("N.rotate").unwrap() as u32, "M").unwrap_err().contains("is given"));
    // points whose routines would have one name in Rust
    let refused = document.rename(text.find("GA = ").unwrap() as u32, "pa").unwrap_err();
    assert!(refused.contains("both become `pa`"), "{refused}");
    // where a part could not be read the name may be meant
    let broken = text.replace("S = O + q3*N.x;", "S = O + q3*N.x; T = l1 l2;");
    let document = Document::new(broken.as_str());
    let refused = document.rename(broken.find("l1: m").unwrap() as u32, "l9").unwrap_err();
    assert!(refused.contains("could not be read"), "{refused}");
}

#[test]
fn findings_are_those_of_check() {
    for (path, text) in models().into_iter().chain(mistaken()) {
        let found = Document::new(text.as_str()).findings();
        let source = Source::file(&path, text.as_str());
        let checked = check(&source).diagnostics;
        assert_eq!(found.len(), checked.len(), "{path}");
        for (finding, diagnostic) in found.iter().zip(&checked) {
            // of what stands in a part, or in another file, the place in this text
            let place = source.in_itself(diagnostic.primary.span);
            assert_eq!((finding.span, finding.code), (place, diagnostic.code.0), "{path}");
            // and besides where it stands itself
            let (file, itself) = source.place(diagnostic.primary.span);
            assert_eq!((finding.place.file, finding.place.span), (file, itself));
            assert_eq!(finding.related.len(), diagnostic.related.len());
            let says =
                |text: &Option<String>| text.as_ref().is_none_or(|text| finding.message.contains(text));
            assert!(finding.message.starts_with(&diagnostic.message) && says(&diagnostic.help));
        }
    }
}

/// The mistakes that stay and those that come.
fn codes(all: &[Diagnostic]) -> Vec<&'static str> {
    all.iter().map(|found| found.code.0).collect()
}

#[test]
fn fixes_cure() {
    let (mut offered, mut cured, mut kinds) = (0, 0, std::collections::BTreeSet::new());
    for (path, text) in mistaken() {
        let document = Document::new(text.as_str());
        let all = Span { start: 0, end: text.len() as u32 };
        let before = codes(&document.analysis().diagnostics);
        for action in document.fixes(all) {
            let after = apply(&text, &action.edits);
            assert_ne!(after, text, "{path}: {}", action.title);
            let left = codes(&check(&Source::file(&path, after.as_str())).diagnostics);
            let code = before[action.finding];
            let count = |list: &[&str]| list.iter().filter(|other| **other == code).count();
            offered += 1;
            if count(&left) < count(&before) {
                cured += 1;
                kinds.insert(code);
            } else if std::env::var_os("HODOGRAPH_SHOW").is_some() {
                eprintln!("{path}: {} {code}: {left:?}", action.title);
            }
        }
    }
    println!("{cured} of {offered} fixes cure their mistake; codes {kinds:?}");
    assert!(cured * 10 >= offered * 8, "{cured} of {offered}");
    for code in ["E006", "E007", "E013", "E020", "E030", "E041", "E052", "E063", "E070", "W001"] {
        assert!(kinds.contains(code), "no fix cures {code}: {kinds:?}");
    }
}

#[test]
fn completion_offers_what_stands_there() {
    let (mut offered, mut first, mut absent) = (0, 0, Vec::new());
    for (path, text) in models() {
        let document = Document::new(text.as_str());
        for found in document.symbols().uses.iter().step_by(8) {
            let name = &document.symbols().of(found.symbol).unwrap().name;
            // as if it was about to be written
            let without = [&text[..found.place.start as usize], &text[found.place.end as usize..]].concat();
            let proposals = Document::new(without).completion(found.place.start);
            match proposals.iter().find(|proposal| proposal.label == *name) {
                Some(proposal) => {
                    offered += 1;
                    first += usize::from(proposal.rank < 2);
                }
                None => {
                    absent.push(format!("{path}:{} {name}", document.text().line_of(found.place.start) + 1))
                }
            }
        }
    }
    println!("{offered} offered, {first} not ranked last, {} absent", absent.len());
    assert!(absent.len() * 200 < offered, "{absent:#?}");
    assert!(first * 100 >= offered * 80, "{first} of {offered}");
}

#[test]
fn what_fits_the_dimension_comes_first() {
    let head = "mechanism A;\nparameters { m: kg = 1, l: m = 1, k: N/m = 1, h: m = 2 }\ncoordinates { q: m = 1, a: rad = 0 }\nspeeds { u: m/s, w: rad/s }\n";
    let names = |tail: &str| -> Vec<String> {
        let text = format!("{head}{}", tail.replace('|', ""));
        let at = head.len() + tail.find('|').unwrap();
        let proposals = Document::new(text).completion(at as u32);
        let fits = proposals.into_iter().filter(|p| p.rank == 0 && matches!(p.kind, Proposed::Name(_)));
        fits.map(|proposal| proposal.label).collect()
    };
    assert_eq!(names("definitions { f: N = k*(q - |); }"), ["l", "h", "q"]);
    assert_eq!(names("definitions { f: N = k*(q - | }"), ["l", "h", "q"]);
    assert_eq!(names("definitions { f: m = | }"), ["l", "h", "q"]);
    assert_eq!(names("definitions { f: N = m*u*| }"), ["w"]);
    assert_eq!(names("bodies { B { mass: | } }"), ["m"]);
    assert_eq!(names("kinematics { d(q)/dt = | }"), ["u"]);
    assert_eq!(names("frames { B = N.rotate(z, |); }"), ["a", "pi"]);
    assert_eq!(names("frames { B = |; }"), ["N"]);
    assert_eq!(names("points { P = O + q*|; }"), ["N", "O"]);
    assert_eq!(names("contacts { c { point: O, normal: N.y, gap: q - | } }"), ["l", "h", "q"]);
    assert_eq!(names("particles { P { point: |"), ["O"]);
}

fn labels(text: &str) -> Vec<String> {
    let at = text.find('|').unwrap();
    let proposals = Document::new(text.replace('|', "")).completion(at as u32);
    proposals.into_iter().map(|proposal| proposal.label).collect()
}

#[test]
fn words_are_completed_where_they_belong() {
    assert_eq!(labels("|"), ["mechanism"]);
    assert_eq!(labels("mech|"), ["mechanism"]);
    assert_eq!(labels("mechanism A;\nparameters { }\n|")[..2], ["inputs", "coordinates"]);
    assert_eq!(labels("mechanism A;\nparameters { |"), ["fixed"]);
    assert_eq!(labels("mechanism A;\nparameters { a: kg = 1, b: |")[0], "kg");
    assert_eq!(
        labels("mechanism A;\nframes { B = N.| }"),
        ["rotate", "euler", "space", "quaternion", "spin"]
    );
    assert_eq!(labels("mechanism A;\nframes { B = N.rotate(|"), ["x", "y", "z"]);
    assert_eq!(labels("mechanism A;\npoints { P = O + N.|"), ["x", "y", "z", "vec"]);
    assert_eq!(labels("mechanism A;\nbodies { B { frame: N, | } }"), ["centre", "mass", "inertia", "shape"]);
    let shapes = "mechanism A;\nshapes { Ball { sphere: 1 }, Floor { plane: N.z } }\n";
    assert_eq!(labels(&format!("{shapes}contacts {{ c {{ Ball on |"))[..2], ["Ball", "Floor"]);
    assert_eq!(labels(&format!("{shapes}contacts {{ c {{ Ball |")), ["on", "in"]);
    assert_eq!(labels("mechanism A;\nshapes { Ball { |")[..3], ["of", "at", "axis"]);
    assert_eq!(labels("mechanism A;\nshapes { Ball { of: |"), ["N"]);
    assert_eq!(labels("mechanism A;\nloads { |"), ["gravity", "force", "torque", "spring", "torsion"]);
    assert_eq!(labels("mechanism A;\nloads { spring O to O: { |"), ["stiffness", "length", "damping"]);
    assert_eq!(labels("mechanism A;\ncontacts { c { surface: { law: |"), ["newton", "poisson", "stronge"]);
    assert_eq!(labels("mechanism A;\ncontacts { c { surface: { mu: 0.3, | } } }")[0], "e");
    assert!(labels("mechanism A; // param|").is_empty());
    assert!(labels("mechanism A;\nparameters { a: kg = 1.2| }").is_empty());
}

#[test]
fn every_word_of_every_model_is_known() {
    for (path, text) in models() {
        let document = Document::new(text.as_str());
        for token in lexer::tokens(&text, 1_000_000) {
            // what is not documented: the name of the mechanism
            let name = document.name_place() == Some(token.span);
            let followed = text[token.span.end as usize..].trim_start();
            if token.kind == TokenKind::Name && !name && token.text != "dt" && !followed.starts_with("://") {
                let hover = document.hover(token.span.start);
                let axes = ["xyz", "zxz", "zyx", "x", "y", "z", "yxz", "xzy", "zxy", "yzx"]
                    .contains(&token.text.as_str());
                assert!(hover.is_some() || axes, "{path}: nothing is known of `{}`", token.text);
            }
        }
    }
}

#[test]
fn hovering_tells_kind_unit_value_and_chain() {
    let text = "mechanism A;\nparameters {\n    /// length of the rod\n    l: cm = 50,\n}\ncoordinates { q: deg = 30 }\nspeeds { u: rad/s }\nframes { B = N.rotate(z, q); C = B.rotate(z, q); }\npoints { P = O + l*B.x; Q = P + l*C.x; }\n";
    let document = Document::new(text);
    let at = |word: &str| document.hover(text.find(word).unwrap() as u32).unwrap().text;
    let length = at("l*B");
    for part in ["l: cm = 50", "a parameter: in m", "value 50 cm = 0.5 in SI units", "length of the rod"] {
        assert!(length.contains(part), "{length}");
    }
    assert!(at("q)").contains("initial value 30 deg = 0.523599 in SI units"), "{}", at("q)"));
    let frame = at("C.x");
    assert!(frame.contains("C = B.rotate(z, q)") && frame.contains("\nB = N.rotate(z, q)\n"), "{frame}");
    assert!(at("Q =").contains("\nP = O + l*B.x\n"), "{}", at("Q ="));
    assert!(at("rotate").contains("right-handed"), "{}", at("rotate"));
    assert!(at("cm").contains("= 0.01 SI: in m"), "{}", at("cm"));
    assert!(at("coordinates").contains("generalised coordinates"));
}

#[test]
fn colours_stand_in_order_and_cover_all_names() {
    for (path, text) in models().into_iter().chain(mistaken()) {
        let document = Document::new(text.as_str());
        let colours = document.colours();
        for pair in colours.windows(2) {
            assert!(pair[0].span.end <= pair[1].span.start, "{path}: {pair:?}");
        }
        for found in colours {
            assert!(!text[found.span.range()].contains('\n'), "{path}: {found:?}");
        }
    }
}

#[test]
fn the_layout_is_that_of_fmt() {
    for (path, text) in models().into_iter().chain(mistaken()) {
        for text in
            [text.clone(), text.replace(": ", ":").replace("\n    ", "\n  "), text.replace('\n', "\r\n")]
        {
            let formatted = format::format(&Source::file(&path, text.as_str()));
            let edits = Document::new(text.as_str()).layout();
            assert_eq!(edits.map(|edits| apply(&text, &edits)), formatted.ok(), "{path}");
        }
    }
}

#[test]
fn the_outline_names_all_that_is_declared() {
    for (path, text) in models() {
        let document = Document::new(text.as_str());
        let outline = document.outline();
        assert_eq!(outline.len(), document.tree().sections.len(), "{path}");
        let named =
            outline.iter().flat_map(|section| &section.items).filter(|item| item.symbol.is_some()).count();
        let declared = document.symbols().declared.iter().filter(|declared| declared.place.is_some()).count();
        assert_eq!(named, declared, "{path}");
        for fold in document.folds() {
            assert!(fold.first < fold.last && fold.last < document.text().lines(), "{path}: {fold:?}");
        }
    }
}

#[test]
fn names_of_a_text_with_open_brackets_are_known() {
    let (_, text) = models().into_iter().find(|(path, _)| path.ends_with("slider_crank.mech")).unwrap();
    let broken = text.replace("GA = O + l1/2*A.x;", "GA = O + (l1/2*A.x;");
    let document = Document::new(broken.as_str());
    assert_eq!(document.findings().len(), 1);
    let whole = Document::new(text.as_str());
    assert_eq!(document.symbols().declared.len(), whole.symbols().declared.len());
    let use_of = broken.find("l1/2").unwrap() as u32;
    assert_eq!(document.definition(use_of).unwrap().span.start as usize, broken.find("l1: m").unwrap());
}

#[test]
fn hints_tell_dimensions_that_are_not_stated() {
    let text = "mechanism A;\nparameters { m: kg = 1, k: N/m = 1 }\ncoordinates { q: m = 1 }\nspeeds { u: m/s }\ndefinitions { f = k*q; g: N = f; }\nkinematics { d(q)/dt = u; }\n";
    let document = Document::new(text);
    let hints = document.hints(Span { start: 0, end: text.len() as u32 });
    let shown: Vec<(&str, &str)> = hints
        .iter()
        .map(|hint| (&text[hint.offset as usize - 1..hint.offset as usize], hint.label.as_str()))
        .collect();
    assert_eq!(shown, [("f", ": N"), ("u", ": m/s")]);
}

#[test]
fn nothing_stops_at_any_place_of_any_text() {
    let odd = [
        "",
        "\u{feff}",
        "\0\0\0",
        "mechanism",
        "mechanism A",
        "{{{{((((",
        "}}}}))))",
        "a\rb",
        "/* /*",
        "π𝛼 = \u{301}",
    ];
    let odd = odd.into_iter().map(|text| (String::new(), text.to_owned()));
    for (_, text) in mistaken().into_iter().step_by(7).chain(odd) {
        let document = Document::new(text.as_str());
        let all = Span { start: 0, end: text.len() as u32 };
        document.fixes(all);
        document.colours();
        document.outline();
        document.folds();
        document.hints(all);
        let _ = document.layout();
        for offset in (0..=text.len() as u32 + 1).step_by(11) {
            document.hover(offset);
            document.completion(offset);
            document.signature(offset);
            document.references(offset, true);
            let _ = document.rename(offset, "another");
            document.text().offset(document.text().position(offset, Encoding::Utf16), Encoding::Utf16);
        }
    }
}

#[test]
fn models_with_parts_have_their_mistakes_and_names_at_their_places() {
    let text = "mechanism Chain;\n\npart Link(hinge: point, length: m = 0.5) {\n    parameters { shared m: kg }\n    coordinates { q: rad = 0.1 }\n    speeds { u: rad/s }\n    frames { B = N.rotate(z, q); }\n    points { tip = hinge - length*B.y; }\n    particles { Bob { point: tip, mass: m } }\n}\n\nparameters { m: kg = 1, g: m/s^2 = 9.81 }\nloads { gravity: -g*N.y; }\nuse Link as a(hinge: O);\nuse Link as b(hinge: a.tip);\n";
    let document = Document::new(text);
    assert_eq!(document.findings(), []);
    let declared = text.find("q: rad").unwrap();
    let found = document.definition(text.find("q); }").unwrap() as u32).unwrap();
    assert_eq!((found.file, found.span.start as usize), (0, declared));
    let part = document.definition(text.find("Link as b").unwrap() as u32).unwrap();
    assert_eq!(&text[part.span.start as usize - 5..][..9], "part Link");
    assert!(document.hover(text.find("tip, mass").unwrap() as u32).unwrap().text.contains("a point"));
    assert_eq!(document.rename(declared as u32, "angle").unwrap().len(), 3);
    let mistaken = text.replace("rotate(z, q)", "rotate(z, qq)");
    let found = Document::new(mistaken.as_str()).findings();
    assert_eq!(found[0].code, "E020");
    assert_eq!(&mistaken[found[0].span.range()], "qq");
    // a file of parts is right as it is
    let library = text.split("\n\n").nth(1).unwrap();
    assert_eq!(Document::new(library).findings(), []);
}
