//! Files that a model imports: what belongs to its hash, how they are read, and where messages about them stand.

use std::path::{Path, PathBuf};

use hodograph_generator::artifact::model_hash;
use hodograph_generator::check::check;
use hodograph_generator::diagnostics::codes;
use hodograph_generator::files;
use hodograph_generator::format::format;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::parts::{LINK, source};

/// A folder with files, which is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Folder {
        let path = std::env::temp_dir().join(format!("hodograph-parts-{}-{name}", std::process::id()));
        let folder = Folder(path);
        files.iter().for_each(|(name, text)| folder.write(name, text));
        folder
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// A model of the folder, called by its name in it.
    fn model(&self, name: &str) -> Source {
        files::model_as(name, &self.0.join(name))
    }

    /// What is said of a model.
    fn said(&self, name: &str) -> String {
        let source = self.model(name);
        render(&check(&source).diagnostics, &source)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const IMPORTING: &str = "mechanism Chain;
import \"parts/link.mech\";
parameters { rho: kg/m = 2 }
use Link as link[1](hinge: O, base: N);
use Link as link[2](hinge: link[1].tip, base: link[1].B);
";

#[test]
fn the_hash_covers_what_is_imported_and_no_comments() {
    let folder = Folder::new("hash", &[("chain.mech", IMPORTING), ("parts/link.mech", LINK)]);
    let hash = || {
        let source = folder.model("chain.mech");
        assert!(check(&source).mechanism.is_some(), "{}", folder.said("chain.mech"));
        model_hash(&source)
    };
    let fresh = hash();
    // the same text in one file
    let one = IMPORTING.replace("import \"parts/link.mech\";", LINK);
    assert_eq!(fresh, model_hash(&source(&one)));
    folder.write(
        "parts/link.mech",
        &format!("// a rod\n{}", LINK.replace("    points {", "  points\n{ // two\n")),
    );
    assert_eq!(hash(), fresh, "comments and layout");
    folder.write("parts/link.mech", &LINK.replace("q: rad = 0.1", "q: rad = 0.2"));
    assert_eq!(hash(), fresh, "initial values");
    folder.write("parts/link.mech", &LINK.replace("G = hinge - length/2", "G = hinge - length/3"));
    assert_ne!(hash(), fresh, "equations");
    folder.write("parts/link.mech", &LINK.replace("length: m = 0.5", "length: m = 0.6"));
    assert_ne!(hash(), fresh, "a fixed length");
}

#[test]
fn imports_import_and_are_read_once() {
    let leg = "import \"link.mech\";\nimport \"../deeper/other.mech\";\n\
               part Leg(hip: point) { use Link as link(hinge: hip, base: N); use Other as other(from: link.tip); }";
    let other =
        "import \"../parts/link.mech\";\npart Other(from: point) { use Link as link(hinge: from, base: N); }";
    let model = "mechanism M;\nimport \"parts/leg.mech\";\nimport \"./parts/../parts/link.mech\";\n\
                 parameters { rho: kg/m = 2 }\nuse Leg as leg(hip: O);\nuse Link as l(hinge: leg.other.link.tip, base: N);";
    let folder = Folder::new(
        "nested",
        &[
            ("m.mech", model),
            ("parts/leg.mech", leg),
            ("parts/link.mech", LINK),
            ("deeper/other.mech", other),
        ],
    );
    let source = folder.model("m.mech");
    let mechanism = check(&source).mechanism.unwrap_or_else(|| panic!("{}", folder.said("m.mech")));
    assert_eq!(
        mechanism.coordinates.iter().map(|q| q.name.as_str()).collect::<Vec<_>>(),
        ["leg_link_q", "leg_other_link_q", "l_q"]
    );
    let names: Vec<&str> = source.imported().map(Source::name).collect();
    assert_eq!(names, ["parts/leg.mech", "parts/link.mech", "deeper/other.mech"]);
    // what an import imports is not seen
    folder.write("m.mech", &model.replace("import \"./parts/../parts/link.mech\";\n", ""));
    assert!(folder.said("m.mech").contains("there is no part `Link`"), "{}", folder.said("m.mech"));
}

#[test]
fn messages_across_files_are_as_expected() {
    let broken = LINK.replace("length*B.y;\n    }", "length^2*B.y;\n    }");
    let syntax = LINK.replace("N*m*s = 0.1 }", "N*m*s 0.1 }");
    let pair = "import \"link.mech\";\n\npart Pair(top: point) {\n    use Link as one(hinge: top, base: N);\n    \
                use Link as two(hinge: one.tip, base: one.C);\n}\n";
    let of_pair = "mechanism Chain;\nimport \"parts/pair.mech\";\nparameters { rho: kg/m = 2 }\nuse Pair as pair(top: O);\n";
    let files: &[(&str, &[(&str, &str)])] = &[
        ("a file that is not there", &[("chain.mech", IMPORTING)]),
        ("dimensions inside", &[("chain.mech", IMPORTING), ("parts/link.mech", &broken)]),
        ("syntax inside", &[("chain.mech", IMPORTING), ("parts/link.mech", &syntax)]),
        (
            "a part in a part",
            &[("chain.mech", of_pair), ("parts/pair.mech", pair), ("parts/link.mech", LINK)],
        ),
        (
            "a cycle of imports",
            &[
                ("chain.mech", IMPORTING),
                ("parts/link.mech", &format!("import \"more/other.mech\";\n{LINK}")),
                ("parts/more/other.mech", "import \"../link.mech\";\n"),
            ],
        ),
        ("a mechanism", &[("chain.mech", IMPORTING), ("parts/link.mech", "mechanism Link;\n")]),
        ("a section", &[("chain.mech", IMPORTING), ("parts/link.mech", "parameters { m: kg }\n")]),
        (
            "a use",
            &[("chain.mech", IMPORTING), ("parts/link.mech", &format!("{LINK}use Link as l(hinge: O);\n"))],
        ),
        ("a bracket", &[("chain.mech", IMPORTING), ("parts/link.mech", &LINK.replace("q);", "q;"))]),
        (
            "two parts",
            &[
                ("chain.mech", &IMPORTING.replace("parameters", "part Link() { }\nparameters")),
                ("parts/link.mech", LINK),
            ],
        ),
        (
            "a clash of names",
            &[
                ("chain.mech", &format!("{IMPORTING}points {{ link_1_tip = O + 0.5*rho/rho*N.x; }}\n")),
                ("parts/link.mech", LINK),
            ],
        ),
        ("a path", &[("chain.mech", &IMPORTING.replace("parts/", "/parts/"))]),
    ];
    let mut said = String::new();
    for (i, (what, files)) in files.iter().enumerate() {
        let folder = Folder::new(&format!("messages-{i}"), files);
        said.push_str(&format!("==== {what}\n\n{}\n", folder.said("chain.mech")));
    }
    let expected = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics/parts_across_files.txt");
    if std::env::var_os("HODOGRAPH_UPDATE").is_some() {
        std::fs::write(&expected, &said).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&expected).unwrap_or_default(), said, "HODOGRAPH_UPDATE=1 accepts it");
}

#[test]
fn a_file_of_parts_is_laid_out_and_is_no_mechanism() {
    let source = Source::file("link.mech", format!("import \"nowhere.mech\";\n{LINK}"));
    assert!(source.is_library());
    assert_eq!(check(&source).diagnostics.len(), 1);
    let text = format(&source).unwrap();
    assert_eq!(format(&Source::file("link.mech", text.as_str())).unwrap(), text);
    let alone = Source::file("link.mech", LINK);
    let found = check(&alone);
    assert_eq!(found.diagnostics.iter().map(|found| found.code).collect::<Vec<_>>(), [codes::EMPTY]);
}

/// `mechanism!` names the imported files in its module, so that the compiler builds it anew when they change.
#[test]
fn the_macro_follows_imports() {
    let folder = Folder::new("macro", &[("models/chain.mech", IMPORTING), ("models/parts/link.mech", LINK)]);
    let expanded = |input: &str| {
        hodograph_generator::expand::expand(input.parse().unwrap(), &folder.0).to_string().replace(' ', "")
    };
    // there is no derivation yet: what stands in for the module follows its files too
    let module = expanded("\"models/chain.mech\"");
    assert!(
        module.contains("\"/models/chain.mech\"") && module.contains("\"/models/parts/link.mech\""),
        "{module}"
    );
    let inline = IMPORTING.replace("parts/link.mech", "models/parts/link.mech");
    let module = expanded(&inline);
    assert!(module.contains("\"/models/parts/link.mech\""), "{module}");
    assert!(module.contains("hasnoderivation") || module.contains("modchain"), "{module}");
    // also where a mistake in them is the reason that there is none
    folder.write("models/parts/link.mech", &LINK.replace("length/2*B.y", "length*length*B.y"));
    for module in [expanded("\"models/chain.mech\""), expanded(&inline)] {
        assert!(module.contains("\"/models/parts/link.mech\""), "{module}");
        assert!(module.contains("[E031]"), "{module}");
    }
}

#[test]
fn derivations_go_stale_with_what_is_imported() {
    use hodograph_generator::artifact::{Loaded, encode, load_text};
    use hodograph_generator::program::Program;
    let folder = Folder::new("stale", &[("chain.mech", IMPORTING), ("parts/link.mech", LINK)]);
    let derivation = encode(&Program::default(), &model_hash(&folder.model("chain.mech")));
    let is_fresh = || matches!(load_text(&derivation, &folder.model("chain.mech")), Loaded::Fresh(_));
    assert!(is_fresh());
    folder.write("parts/link.mech", &format!("/* a comment */ {LINK} // another"));
    assert!(is_fresh());
    folder.write("parts/link.mech", &LINK.replace("/12, 0,", "/3, 0,"));
    assert!(!is_fresh());
    folder.write("parts/link.mech", LINK);
    assert!(is_fresh());
}

/// An editor shows one text: what is said of a part stands at its use there.
#[test]
fn an_analysis_has_the_places_of_the_text_itself() {
    let folder = Folder::new("editor", &[("chain.mech", IMPORTING), ("parts/link.mech", LINK)]);
    folder.write("parts/link.mech", &LINK.replace("length/2*B.y", "length*length*B.y"));
    let source = folder.model("chain.mech");
    let analysis = hodograph_generator::check::analyse(&source);
    let [found] = &analysis.diagnostics[..] else { panic!("{:?}", analysis.diagnostics) };
    let use_of_it = source.in_itself(found.primary.span);
    assert_eq!(&IMPORTING[use_of_it.range()], "use Link as link[1](hinge: O, base: N)");
    let (file, place) = source.place(found.primary.span);
    let text = source.imported().nth(file - 1).unwrap().text().unwrap();
    assert!(text[place.range()].contains("length*length"), "{}", &text[place.range()]);
    let near = IMPORTING.replace("use Link as link[2]", "use Lnk as link[2]");
    let text = near.replace("import \"parts/link.mech\";", LINK);
    let source = Source::file("", text.as_str());
    let analysis = hodograph_generator::check::analyse(&source);
    let [found] = &analysis.diagnostics[..] else { panic!("{:?}", analysis.diagnostics) };
    let place = source.in_itself(found.primary.span);
    assert_eq!((&text[place.range()], found.code), ("Lnk", codes::PART_UNKNOWN));
    assert_eq!(analysis.tokens.len(), hodograph_generator::syntax::lexer::tokens(&text, 10_000).len());
}
