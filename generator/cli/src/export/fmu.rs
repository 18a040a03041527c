//! Exports a generated module as a functional mock-up unit (FMI 3.0): a crate with the functions of the
//! standard, which cargo builds here, and the model description, packed in a zip file.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

use hodograph::Surface;
use hodograph_fmu::{Defaults, description, escaped};
use hodograph_interpreter::InterpretedMechanism;
use sha2::{Digest, Sha256};
use zip::write::SimpleFileOptions;

use super::names;
use crate::output;
use crate::stop::{Outcome, Stop};

/// The parts of a unit.
pub struct Unit<'a> {
    /// name of the module in Rust
    pub module: &'a str,
    /// name of the mechanism's type
    pub kind: &'a str,
    /// the text of the generated module
    pub expanded: &'a str,
    /// the model, with its parts written out
    pub model: &'a str,
    /// a sentence about it
    pub docs: &'a str,
    /// the mechanism with the parameters of the model
    pub mechanism: &'a InterpretedMechanism,
    /// greatest step of the integration, s
    pub max_step: f64,
    /// the surfaces of the contacts that can close
    pub surfaces: &'a [(usize, Surface<f64>)],
    /// the values of the dependencies `hodograph` and `hodograph-fmu` in the manifest
    pub dependencies: [String; 2],
    /// the lock file for the build, if there is one
    pub lock: Option<PathBuf>,
}

/// The zip file of a unit.
///
/// # Errors
///
/// The motion cannot start in the state of the model; cargo is missing, or cannot build the crate.
pub fn file(unit: &Unit<'_>) -> Outcome<Vec<u8>> {
    let name = names::of_library(unit.module);
    let surfaces: Vec<(usize, f64, f64, &'static str)> =
        unit.surfaces.iter().map(|(contact, own)| (*contact, own.mu, own.e, own.law.name())).collect();
    let step =
        if unit.max_step.is_finite() { format!("{:?}", unit.max_step) } else { "f64::INFINITY".to_owned() };
    let stated = format!("hodograph_fmu::Defaults {{ max_step: {step}, surfaces: &{surfaces:?} }}");
    let token = token(&[unit.expanded, &stated]);
    // Leaked: the process writes a single unit.
    let defaults = Defaults { max_step: unit.max_step, surfaces: Vec::leak(surfaces) };
    let described = description(unit.mechanism, &defaults, &name, &token, unit.docs).map_err(Stop::Fault)?;
    let library = format!(
        "//! The mechanism as a functional mock-up unit (FMI 3.0).\n\nmod mechanism;\n\nhodograph_fmu::export!(\n    {} in crate::mechanism::{},\n    \
         token = \"{token}\",\n    defaults = {stated}\n);\n",
        unit.kind, unit.module
    );
    let manifest = manifest(&name, &unit.dependencies);
    let mut files: Vec<(String, Vec<u8>)> = vec![
        ("modelDescription.xml".to_owned(), described.into_bytes()),
        ("documentation/index.html".to_owned(), documentation(unit).into_bytes()),
        ("sources/Cargo.toml".to_owned(), manifest.into_bytes()),
        ("sources/src/lib.rs".to_owned(), library.into_bytes()),
        ("sources/src/mechanism.rs".to_owned(), unit.expanded.as_bytes().to_vec()),
        (format!("sources/{name}.mech"), unit.model.as_bytes().to_vec()),
    ];
    let binary = build(&files, &name, unit.lock.as_deref())?;
    let (tuple, extension) = platform()?;
    files.push((format!("binaries/{tuple}/{name}.{extension}"), binary));
    zipped(&files).map_err(|error| Stop::Fault(format!("the unit cannot be packed: {error}")))
}

/// The instantiation token, by which an importer identifies the unit: it changes with everything on which the
/// variables and values of the unit depend.
fn token(texts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for text in texts {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text.as_bytes());
    }
    let digits = hash.finalize().iter().take(16).fold(String::new(), |mut digits, byte| {
        let _ = write!(digits, "{byte:02x}");
        digits
    });
    format!("{{{digits}}}")
}

fn manifest(name: &str, [hodograph, unit]: &[String; 2]) -> String {
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\npublish = false\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n\
         [dependencies]\nhodograph = {hodograph}\nhodograph-fmu = {unit}\n\n[profile.release]\nstrip = true\n\n[workspace]\n"
    )
}

fn documentation(unit: &Unit<'_>) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<h1>{0}</h1>\n<p>{1}</p>\n<p>Made by Hodograph {2}. \
         Model exchange and co-simulation. The binary is built from <code>sources</code> by <code>cargo build --release</code>.</p>\n<pre>{3}</pre>\n</html>\n",
        escaped(hodograph::Mechanism::name(unit.mechanism)),
        escaped(unit.docs),
        env!("CARGO_PKG_VERSION"),
        unit.model.replace('&', "&amp;").replace('<', "&lt;"),
    )
}

/// The platform name of the standard for this machine, and the extension of its shared libraries.
fn platform() -> Outcome<(String, &'static str)> {
    let (system, extension) = match std::env::consts::OS {
        "linux" => ("linux", "so"),
        "macos" => ("darwin", "dylib"),
        "windows" => ("windows", "dll"),
        other => return Err(Stop::Fault(format!("FMI has no name for the system {other}"))),
    };
    Ok((format!("{}-{system}", std::env::consts::ARCH), extension))
}

/// Builds the crate and reads the shared library. The folder is removed afterwards; that of
/// `CARGO_TARGET_DIR` stays.
fn build(files: &[(String, Vec<u8>)], name: &str, lock: Option<&Path>) -> Outcome<Vec<u8>> {
    let fault = |what: &str, error: &dyn std::fmt::Display| Stop::Fault(format!("{what}: {error}"));
    let folder = tempfile::Builder::new().prefix("hodograph-fmu").tempdir();
    let folder = folder.map_err(|error| fault("no folder to build in", &error))?;
    let _unfinished = crate::interrupt::Unfinished::file(folder.path());
    for (path, text) in files {
        let Some(path) = path.strip_prefix("sources/") else { continue };
        let place = folder.path().join(path);
        let parent = place.parent().unwrap_or(folder.path());
        std::fs::create_dir_all(parent)
            .and_then(|()| std::fs::write(&place, text))
            .map_err(|error| fault("the crate cannot be written", &error))?;
    }
    if let Some(lock) = lock {
        std::fs::copy(lock, folder.path().join("Cargo.lock"))
            .map_err(|error| Stop::unreadable(lock, &error))?;
    }
    let target = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(target) => std::path::absolute(target).map_err(|error| fault("CARGO_TARGET_DIR", &error))?,
        None => folder.path().join("target"),
    };
    output::say("note: cargo builds the unit, which takes a minute or two the first time");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(&cargo);
    command.args(["build", "--release", "--quiet", "--target-dir"]).arg(&target).current_dir(folder.path());
    let built = command.output().map_err(|error| {
        fault(
            "cargo cannot be run, which builds the unit's binary: install Rust from https://rustup.rs",
            &error,
        )
    })?;
    if !built.status.success() {
        let said = String::from_utf8_lossy(&built.stderr);
        return Err(Stop::Fault(format!("cargo cannot build the unit:\n{}", said.trim_end())));
    }
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = target.join("release").join(format!("{prefix}{name}{suffix}"));
    std::fs::read(&library).map_err(|error| Stop::unreadable(&library, &error))
}

fn zipped(files: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        // Without time stamps, so that the same model and compiler give the same bytes.
        archive.start_file(name, SimpleFileOptions::default().unix_permissions(0o644))?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
