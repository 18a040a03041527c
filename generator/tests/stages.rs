//! Imports go one way: a module imports what stands before it in the lists of ARCHITECTURE.md, and no files
//! import each other in a circle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The path of a module in its crate; of the crate itself it is empty.
type Module = Vec<String>;

/// The files of a crate and what they name of each other.
struct Imports {
    /// whom a module names, and by which names
    edges: BTreeMap<Module, BTreeSet<Module>>,
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The modules of a list in ARCHITECTURE.md, which begins with a line of this head.
fn listed(head: &str) -> Vec<String> {
    let text = fs::read_to_string(repository().join("ARCHITECTURE.md")).unwrap();
    let lines = text.lines().skip_while(|line| !line.starts_with(head));
    let block: Vec<&str> = lines.take_while(|line| !line.starts_with("```") && !line.is_empty()).collect();
    assert!(!block.is_empty(), "ARCHITECTURE.md has no list `{head}`");
    let words = block.iter().flat_map(|line| line.strip_prefix(head).unwrap_or(line).split_whitespace());
    words.map(str::to_owned).collect()
}

fn rust_files(folder: &Path, module: &[String], out: &mut BTreeMap<Module, PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let within = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            rust_files(&path, &within, out);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let is_head = name == "mod" || (name == "lib" && module.is_empty());
            out.insert(if is_head { module.to_vec() } else { within }, path);
        }
    }
}

/// The tokens of a file without the items that only tests have.
fn without_tests(tokens: TokenStream) -> Vec<TokenTree> {
    let mut kept = Vec::new();
    let mut left = tokens.into_iter().peekable();
    while let Some(token) = left.next() {
        let is_test = |attribute: &TokenTree| {
            let text = attribute.to_string().replace(' ', "");
            text == "[cfg(test)]" || text == "[cfg(all(test,feature=\"std\"))]"
        };
        if token.to_string() == "#" && left.peek().is_some_and(is_test) {
            // up to the end of the item: its braces, or a semicolon
            for token in left.by_ref() {
                let is_body = matches!(&token, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace);
                if is_body || token.to_string() == ";" {
                    break;
                }
            }
            continue;
        }
        kept.push(token);
    }
    kept
}

/// A path as it is written, and whether `pub use` says it.
struct Named {
    path: Vec<String>,
    reexport: bool,
}

/// The paths of a `use`, whose tokens these are.
fn use_paths(tokens: &[TokenTree], before: &[String], out: &mut Vec<Vec<String>>) {
    let mut path = before.to_vec();
    for token in tokens {
        match token {
            TokenTree::Ident(name) if name == "as" => break,
            TokenTree::Ident(name) => path.push(name.to_string()),
            TokenTree::Group(group) => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                for part in inner.split(|token| token.to_string() == ",").filter(|part| !part.is_empty()) {
                    use_paths(part, &path, out);
                }
                return;
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
    out.push(path);
}

/// Every path in these tokens that may lead to another module.
fn named(tokens: &[TokenTree], out: &mut Vec<Named>) {
    let mut at = 0;
    while at < tokens.len() {
        let word = tokens[at].to_string();
        if word == "use" {
            let end = (at..tokens.len()).find(|&i| tokens[i].to_string() == ";").unwrap_or(tokens.len());
            let mut paths = Vec::new();
            use_paths(&tokens[at + 1..end], &[], &mut paths);
            let before = at.checked_sub(1).map(|i| tokens[i].to_string()).unwrap_or_default();
            let reexport = before == "pub" || before.starts_with('(');
            out.extend(paths.into_iter().map(|path| Named { path, reexport }));
            at = end;
        } else if word == "crate" || word == "super" {
            let mut path = vec![word];
            while let [TokenTree::Punct(a), TokenTree::Punct(b), TokenTree::Ident(name)] =
                &tokens[(at + 1).min(tokens.len())..(at + 4).min(tokens.len())]
                && (a.as_char(), b.as_char()) == (':', ':')
            {
                path.push(name.to_string());
                at += 3;
            }
            // `pub(crate)` and `extern crate` lead nowhere
            if path.len() > 1 {
                out.push(Named { path, reexport: false });
            }
        } else if let TokenTree::Group(group) = &tokens[at] {
            let inner: Vec<TokenTree> = without_tests(group.stream());
            named(&inner, out);
        }
        at += 1;
    }
}

/// The full path in the crate; `None` of what other crates or the file itself have.
fn absolute(from: &[String], path: &[String], files: &BTreeMap<Module, PathBuf>) -> Option<Vec<String>> {
    let mut base = match path[0].as_str() {
        "crate" => Vec::new(),
        "super" | "self" => from.to_vec(),
        child if files.contains_key(&[from, &[child.to_owned()]].concat()) => from.to_vec(),
        _ => return None,
    };
    for word in path {
        match word.as_str() {
            "crate" | "self" => {}
            "super" => drop(base.pop()),
            _ => base.push(word.clone()),
        }
    }
    Some(base)
}

impl Imports {
    fn read(source: &Path) -> Self {
        let mut files = BTreeMap::new();
        rust_files(source, &[], &mut files);
        files.retain(|module, _| !module.last().is_some_and(|name| name == "tests" || name == "testing"));
        let mut all: BTreeMap<Module, Vec<Named>> = BTreeMap::new();
        for (module, path) in &files {
            let tokens: TokenStream = fs::read_to_string(path).unwrap().parse().unwrap();
            let mut names = Vec::new();
            named(&without_tests(tokens), &mut names);
            all.insert(module.clone(), names);
        }
        // what a module re-exports is that of the module that has it
        let mut elsewhere: BTreeMap<Vec<String>, Vec<String>> = BTreeMap::new();
        for (module, names) in &all {
            for name in names.iter().filter(|name| name.reexport) {
                if let (Some(full), Some(last)) = (absolute(module, &name.path, &files), name.path.last()) {
                    elsewhere.insert([module.as_slice(), std::slice::from_ref(last)].concat(), full);
                }
            }
        }
        let mut edges: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
        for (module, names) in &all {
            // macros stand at the root of the crate, wherever they are written
            let is_macro = |name: &Named| name.path.last().is_some_and(|last| last.starts_with("__"));
            for name in names.iter().filter(|name| !is_macro(name)) {
                let Some(mut full) = absolute(module, &name.path, &files) else { continue };
                for _ in 0..4 {
                    // a function may be called like the module that has it
                    let is_module = |n: usize| n < full.len() && files.contains_key(&full[..n]);
                    let mut lengths = (0..=full.len()).rev().filter(|n| !is_module(*n));
                    let found = lengths.find_map(|n| Some((elsewhere.get(&full[..n])?, n)));
                    let Some((there, n)) = found else { break };
                    full = [there.as_slice(), &full[n..]].concat();
                }
                let length = (0..=full.len()).rev().find(|&n| files.contains_key(&full[..n])).unwrap_or(0);
                let target = full[..length].to_vec();
                // the head of a folder may offer what the files in it have
                let offers = name.reexport && target.starts_with(module);
                if &target != module && !offers {
                    edges.entry(module.clone()).or_default().insert(target);
                }
            }
        }
        Imports { edges }
    }

    /// The modules that can be reached from one.
    fn reach(&self, from: &Module) -> BTreeSet<&Module> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            for next in self.edges.get(module).into_iter().flatten() {
                if seen.insert(next) {
                    open.push(next);
                }
            }
        }
        seen
    }

    /// Imports of what does not stand before the importing module.
    fn upwards(&self, order: &[String]) -> Vec<String> {
        let place = |module: &Module| order.iter().position(|stage| Some(stage) == module.first());
        let mut wrong = Vec::new();
        for (from, targets) in self.edges.iter().filter(|(from, _)| !from.is_empty()) {
            for to in targets.iter().filter(|to| to.first() != from.first()) {
                match (place(from), place(to)) {
                    (Some(here), Some(there)) if there <= here => {}
                    _ => wrong.push(format!("{} imports {}", from.join("/"), to.join("/"))),
                }
            }
        }
        wrong
    }

    /// Files that import each other.
    fn circles(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        for (from, targets) in self.edges.iter().filter(|(from, _)| !from.is_empty()) {
            for to in targets.iter().filter(|to| self.reach(to).contains(from)) {
                wrong.push(format!("{} -> {}", from.join("/"), to.join("/")));
            }
        }
        wrong
    }
}

fn holds(source: &str, head: &str) {
    let imports = Imports::read(&repository().join(source));
    assert!(imports.edges.len() > 10, "{source}: the imports are not read");
    let order = listed(head);
    let missing: Vec<&Module> =
        imports.edges.keys().filter(|m| m.first().is_some_and(|name| !order.contains(name))).collect();
    assert!(missing.is_empty(), "not in the list of ARCHITECTURE.md: {missing:?}");
    let wrong = [imports.upwards(&order), imports.circles()].concat();
    assert!(wrong.is_empty(), "{source}:\n{}", wrong.join("\n"));
}

#[test]
fn the_generator_imports_downwards_only() {
    for stage in ["model", "program", "derive"] {
        holds(&format!("generator/{stage}/src"), &format!("{stage}:"));
    }
}

#[test]
fn the_runtime_imports_downwards_only() {
    holds("runtime/src", "runtime:");
}

#[test]
fn the_simulation_imports_downwards_only() {
    holds("simulation/src", "simulation:");
}

#[test]
fn no_files_import_each_other() {
    let sources = ["generator/src", "generator/emit/src", "generator/cli/src", "generator/interpreter/src"];
    for source in sources {
        let wrong = Imports::read(&repository().join(source)).circles();
        assert!(wrong.is_empty(), "{source}:\n{}", wrong.join("\n"));
    }
}

#[test]
fn imports_upwards_and_circles_are_found() {
    let module = |name: &str| vec![name.to_owned()];
    let edges = [("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")];
    let mut imports = Imports { edges: BTreeMap::new() };
    for (from, to) in edges {
        imports.edges.entry(module(from)).or_default().insert(module(to));
    }
    let order = ["c", "b", "a", "d"].map(str::to_owned);
    assert_eq!(imports.upwards(&order), ["c imports a"]);
    assert_eq!(imports.circles(), ["a -> b", "b -> c", "c -> a"]);
}

#[test]
fn every_way_to_name_a_module_is_read() {
    let text = "use crate::a::{B, c::D as E}; pub use super::f; #[cfg(test)] mod tests { use crate::no; } fn g() { crate::h::i(super::j::k) }";
    let mut names = Vec::new();
    named(&without_tests(text.parse().unwrap()), &mut names);
    let paths: Vec<String> = names.iter().map(|name| name.path.join("::")).collect();
    assert_eq!(paths, ["crate::a::B", "crate::a::c::D", "super::f", "crate::h::i", "super::j::k"]);
    assert_eq!(names.iter().filter(|name| name.reexport).count(), 1);
}
