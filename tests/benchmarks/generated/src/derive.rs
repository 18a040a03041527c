//! Imports, derives and expands a mechanism with the command line tool.

use std::path::{Path, PathBuf};
use std::process::Command;

use hodograph_generator::artifact;
use hodograph_generator::program::Program;

use crate::cases::{Case, Origin};
use crate::chain;
use crate::states::{self, State};
use crate::tools::{Effort, Failure, Folders, effort, output};

/// A derived mechanism.
pub struct Derivation<'a> {
    /// the mechanism
    pub case: &'a Case,
    /// whether all parameters are folded in.
    pub fixed: bool,
    /// its model file
    pub path: PathBuf,
    /// time of the derivation, process and all
    pub seconds: f64,
    /// its greatest resident memory in kB, where GNU time is installed
    pub kilobytes: Option<u64>,
    /// the program
    pub program: Program,
    /// the Rust module
    pub module: String,
    /// the independent speeds in their order
    pub speeds: Vec<String>,
    /// where the routines are evaluated
    pub states: Vec<State>,
}

impl Derivation<'_> {
    /// Name of its crate.
    pub fn package(&self) -> String {
        format!("{}_{}", self.case.name, if self.fixed { "fixed" } else { "run_time" })
    }
}

/// Derives a mechanism with parameters at run time or folded in.
pub fn derive<'a>(
    folders: &Folders,
    tool: &Path,
    case: &'a Case,
    fixed: bool,
) -> Result<Derivation<'a>, Failure> {
    let folder = folders.work.join(if fixed { "models/fixed" } else { "models/run_time" });
    std::fs::create_dir_all(&folder)?;
    let path = folder.join(format!("{}.mech", case.name));
    std::fs::write(&path, model(folders, tool, case, fixed)?)?;
    let kept = path.with_extension("derivation");
    let _ = std::fs::remove_file(&kept);
    let mut command = Command::new(tool);
    command.args(["derive", "--force"]).arg(&path);
    let Effort { seconds, kilobytes } = effort(&mut command, &path.with_extension("effort"))?;
    let text = std::fs::read_to_string(&kept)?;
    let artifact =
        artifact::decode(&text).map_err(|error| Failure::new(format!("{}: {error:?}", kept.display())))?;
    let module = output(Command::new(tool).arg("expand").arg(&path))?;
    let states = states::states(folders, tool, case, &path)?;
    let speeds = states::speeds(tool, &path)?;
    Ok(Derivation {
        case,
        fixed,
        path,
        seconds,
        kilobytes,
        program: artifact.program,
        module,
        speeds,
        states,
    })
}

/// The text of the model.
fn model(folders: &Folders, tool: &Path, case: &Case, fixed: bool) -> Result<String, Failure> {
    let urdf: PathBuf = match case.origin {
        Origin::Model => {
            let text = std::fs::read_to_string(folders.root.join(format!("models/{}.mech", case.name)))?;
            return Ok(if fixed { with_fixed_parameters(&text) } else { text });
        }
        Origin::Peer => folders.root.join(format!("tests/data/peers/{}.urdf", case.name)),
        Origin::Chain(links) => {
            let path = folders.work.join(format!("models/{}.urdf", case.name));
            std::fs::write(&path, chain::urdf(links))?;
            path
        }
    };
    let mut command = Command::new(tool);
    command.arg("import").arg(urdf).args(["--contact", "ee"]);
    if fixed {
        command.arg("--fixed");
    }
    output(&mut command)
}

/// The model with every parameter `fixed`. Declarations are recognised by `name: unit = value` inside
/// `parameters { }`.
fn with_fixed_parameters(model: &str) -> String {
    let mut inside = false;
    let lines = model.lines().map(|line| {
        if line.starts_with("parameters {") {
            inside = true;
        } else if line.starts_with('}') {
            inside = false;
        } else if inside && !line.trim_start().starts_with("//") {
            let declarations = line.split(',').map(|part| {
                let trimmed = part.trim_start();
                if trimmed.contains(':') { format!(" fixed {trimmed}") } else { part.to_owned() }
            });
            return declarations.collect::<Vec<_>>().join(",");
        }
        line.to_owned()
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}
