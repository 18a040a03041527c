//! Compiles the parser that tree-sitter has generated.

fn main() {
    let folder = std::path::Path::new("../tree-sitter-hodograph/src");
    let files = ["parser.c", "scanner.c"].map(|file| folder.join(file));
    for file in &files {
        println!("cargo:rerun-if-changed={}", file.display());
    }
    if files.iter().all(|file| file.exists()) {
        cc::Build::new()
            .include(folder)
            .std("c11")
            .warnings(false)
            .files(&files)
            .compile("tree-sitter-hodograph");
    }
}
