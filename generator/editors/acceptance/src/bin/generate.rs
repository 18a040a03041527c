//! Writes the parser of the grammar anew: `cargo run --features generate --bin generate`. It needs Node.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The version of the tables that editors of these years know.
const ABI: usize = 14;

fn main() -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tree-sitter-hodograph");
    let written = tree_sitter_generate::generate_parser_in_directory(
        &folder,
        None::<PathBuf>,
        None::<PathBuf>,
        ABI,
        None,
        Some("node"),
        true,
        tree_sitter_generate::OptLevel::default(),
    );
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
