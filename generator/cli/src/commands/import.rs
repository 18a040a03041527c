//! `hodograph import`: converts a URDF, MJCF or SDF file to a model.

use std::path::PathBuf;

use clap::ValueEnum;
use hodograph_generator::check::check;
use hodograph_generator::files;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::import::{Options, import};
use crate::output;
use crate::stop::{Outcome, Stop};

/// Largest size of a robot description, in bytes.
const MAX_BYTES: usize = 64 << 20;

/// Turn a description of a robot (URDF, MJCF or SDF) into a model file, written to standard output
///
///   hodograph import robot.urdf > robot.mech
///
/// Joint `hip` becomes coordinate `q_hip`, speed `u_hip` and input `tau_hip`; what no name can have
/// becomes `_`. Joints of MJCF have the inputs of their actuators, `ctrl_NAME`. In URDF a root link
/// that moves freely has the coordinates q_base_x .. z, the quaternion q_base_e0 .. e3 and the speeds
/// u_base_x .. z and u_base_rx .. rz along its own axes. What is ignored is said on standard error.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the URDF, MJCF or SDF file
    file: PathBuf,
    /// make a contact of the origin of this link with the plane through O across N.z (may be
    /// repeated)
    #[arg(long, value_name = "LINK")]
    contact: Vec<String>,
    /// URDF: whether the root link is fixed to the ground or free [default: free if it has an inertia]
    #[arg(long, value_enum)]
    base: Option<Base>,
    /// declare all parameters `fixed`: folded in at build time
    #[arg(long)]
    fixed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Base {
    Fixed,
    Floating,
}

/// Runs the command.
///
/// # Errors
///
/// The file cannot be read ([`Stop::Call`]) or imported ([`Stop::Reported`]).
pub fn run(arguments: &Arguments) -> Outcome {
    let file = arguments.file.display().to_string();
    let bytes = files::bytes(&arguments.file, MAX_BYTES)
        .map_err(|error| Stop::unreadable(&arguments.file, &error))?;
    let source = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Stop::Fault(format!("{file}: this is not UTF-8 at byte {at}: save it as UTF-8"))
    })?;
    let options = Options {
        contacts: arguments.contact.clone(),
        floating: arguments.base.map(|base| base == Base::Floating),
        fixed_parameters: arguments.fixed,
    };
    let name = arguments.file.file_name().map_or(file.clone(), |name| name.to_string_lossy().into_owned());
    match import(&source, &name, &options) {
        Ok(imported) => {
            for note in imported.notes {
                output::say(format_args!("note: {note}"));
            }
            output::text(&imported.model)?;
            // What the model language refuses (a body that turns without inertia, say) is better said now
            // than later.
            let source = Source::file("the imported model", imported.model);
            let found = check(&source);
            if !found.diagnostics.is_empty() {
                output::say(render(&found.diagnostics, &source).trim_end());
            }
            if found.has_errors() { Err(Stop::Reported) } else { Ok(()) }
        }
        Err(problems) => {
            for problem in problems {
                output::say(format_args!("error: {problem}"));
            }
            Err(Stop::Reported)
        }
    }
}
