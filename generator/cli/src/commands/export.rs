//! `hodograph export`: writes a mechanism as a library for another language.

use std::path::{Path, PathBuf};

use hodograph::{ComponentKind, Mechanism as _, State};
use hodograph_generator::emit::{self, Requests};
use hodograph_generator::format::plain;
use hodograph_generator::rust_names::snake_case;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::motion::{self, GivenSurface};

use crate::commands::expand;
use crate::derivation::{self, Limits};
use crate::evaluate::Machine;
use crate::export::motion::Motion;
use crate::export::{Scalar, files, fmu};
use crate::model;
use crate::output;
use crate::stop::{Outcome, Stop};
use crate::surface::{self, SurfaceArguments};

/// Write a mechanism as a library for C or as a functional mock-up unit (FMI 3.0)
#[derive(Clone, Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("form").required(true).args(["c", "fmu"]))]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// for C: a small crate that builds a static and a shared library, and its header
    #[arg(long)]
    c: bool,
    /// as a functional mock-up unit (FMI 3.0) for model exchange and co-simulation, built here by cargo
    #[arg(long)]
    fmu: bool,
    /// the folder to write to, which must not exist; with --fmu the file
    #[arg(long, short, value_name = "PATH")]
    output: PathBuf,
    /// use `float` instead of `double`, for processors with single precision only
    #[arg(long, conflicts_with = "fmu")]
    single: bool,
    /// the folder of the package `hodograph`, which the crate depends on [default: the published package of
    /// this tool's version]
    #[arg(long, value_name = "FOLDER")]
    hodograph: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArguments,
    #[command(flatten)]
    limits: Limits,
}

/// Runs the command.
///
/// # Errors
///
/// The model has errors or cannot be derived; the folder exists or cannot be written.
pub fn run(arguments: &Arguments) -> Outcome {
    let written = if arguments.fmu { unit(arguments) } else { library(arguments) };
    written.map_err(Stop::on_standard_error)
}

/// The value of a dependency in a manifest: a folder, or the published version.
fn dependency(folder: Option<&Path>, features: &str) -> Outcome<String> {
    let Some(folder) = folder else {
        return Ok(format!("{{ version = \"{}\"{features} }}", env!("CARGO_PKG_VERSION")));
    };
    if !folder.join("Cargo.toml").is_file() {
        return Err(Stop::Call(format!(
            "{} has no Cargo.toml: name the folder of the package `hodograph`",
            folder.display()
        )));
    }
    let folder = std::fs::canonicalize(folder).map_err(|error| Stop::unreadable(folder, &error))?;
    match folder.to_str().filter(|path| !path.contains(['\'', '\n'])) {
        Some(path) => Ok(format!("{{ path = '{path}'{features} }}")),
        None => Err(Stop::Call(format!("{} has characters that a manifest cannot hold", folder.display()))),
    }
}

fn library(arguments: &Arguments) -> Outcome {
    let folder = &arguments.output;
    if folder.symlink_metadata().is_ok() {
        return Err(Stop::Call(format!(
            "{} exists: name a folder that does not, or remove it first",
            folder.display()
        )));
    }
    let SurfaceArguments { mu, e, law } = &arguments.surface;
    if mu.is_some() || e.is_some() || law.is_some() {
        return Err(Stop::Call(
            "--mu, --e and --law are of --fmu: functions of C take a surface with each call".to_owned(),
        ));
    }
    let dependency = dependency(arguments.hodograph.as_deref(), ", default-features = false")?;
    let scalar = if arguments.single { Scalar::Single } else { Scalar::Double };
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let expanded = expand::module(&machine, Requests::default())?;
    let name = snake_case(&machine.mechanism.name);
    let offered = emit::interface(&machine.mechanism, &machine.program, &name).map_err(Stop::Fault)?;
    // Beside the package `hodograph` stands that which follows motion, where the sources are whole.
    let own = arguments.hodograph.as_ref().map(|runtime| runtime.join("../bindings/fmu"));
    let own = own.filter(|own| own.join("Cargo.toml").is_file());
    // A model that leaves a parameter open is a library nevertheless; it may depend on time.
    let interpreted = InterpretedMechanism::new(machine.mechanism.clone(), machine.program.clone());
    let greatest_step = interpreted.map_or(motion::STEP_OF_TIME, |found| found.greatest_step(false));
    let motion = match (&arguments.hodograph, &own) {
        (Some(_), None) => None,
        _ => Some(Motion {
            contacts: machine.mechanism.contacts.iter().map(|contact| contact.name.clone()).collect(),
            inputs: machine.mechanism.inputs.len(),
            max_step: greatest_step,
            dependency: self::dependency(own.as_deref(), "")?,
        }),
    };
    let files = files(&expanded, &offered, scalar, &dependency, motion.as_ref());
    output::files(folder, &files)?;
    output::say(format_args!(
        "{} written: README.md there says how to build it",
        Path::new(folder).display()
    ));
    Ok(())
}

fn unit(arguments: &Arguments) -> Outcome {
    output::check(&arguments.output)?;
    output::check_distinct(&[&arguments.output], &model::files_of(&arguments.model))?;
    let runtime = arguments.hodograph.as_deref();
    let root = runtime.map(|runtime| runtime.join(".."));
    let own = root.as_ref().map(|root| root.join("bindings/fmu"));
    let dependencies = [
        dependency(runtime, ", default-features = false, features = [\"std\"]")?,
        dependency(own.as_deref(), "")?,
    ];
    let model = plain(&model::load(&arguments.model)?.source);
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let expanded = expand::module(&machine, Requests::default())?;
    let mechanism = InterpretedMechanism::new(machine.mechanism.clone(), machine.program.clone())
        .map_err(|error| Stop::Fault(error.to_string()))?;
    let surfaces = surfaces(&mechanism, &arguments.surface)?;
    let name = snake_case(&machine.mechanism.name);
    let offered = emit::interface(&machine.mechanism, &machine.program, &name).map_err(Stop::Fault)?;
    let bytes = fmu::file(&fmu::Unit {
        module: &offered.module,
        kind: &offered.mechanism,
        expanded: &expanded,
        model: &model,
        docs: &sentence(&machine),
        mechanism: &mechanism,
        max_step: mechanism.greatest_step(false),
        surfaces: &surfaces,
        dependencies,
        lock: root.map(|root| root.join("Cargo.lock")).filter(|lock| lock.is_file()),
    })?;
    output::file(&arguments.output, &bytes)?;
    output::say(format_args!("{} written", arguments.output.display()));
    Ok(())
}

/// The surfaces at the start of the unit: those of the options, else those of the model.
fn surfaces(
    mechanism: &InterpretedMechanism,
    arguments: &SurfaceArguments,
) -> Outcome<Vec<(usize, hodograph::Surface<f64>)>> {
    let zeros = |kind| vec![0.0; mechanism.count(kind)];
    let (mut q, mut u) = (zeros(ComponentKind::Coordinate), zeros(ComponentKind::Speed));
    let mut inputs = zeros(ComponentKind::Input);
    mechanism.initial_state(&mut q, &mut u, &mut inputs).map_err(|error| Stop::Fault(error.to_string()))?;
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &inputs };
    let law = arguments.law.as_deref().map(surface::law).transpose()?;
    let all = surface::checked(GivenSurface { mu: arguments.mu, e: arguments.e, law }, ["--mu", "--e"])?;
    let found = motion::surfaces(mechanism, &state, all, &[]).map_err(|error| {
        Stop::Call(format!("{error}: give --mu, --e and --law, or state its `surface` in the model"))
    })?;
    Ok(found.of_contacts)
}

/// The first sentence of the model's documentation.
fn sentence(machine: &Machine) -> String {
    let docs = machine.mechanism.docs.trim();
    docs.lines().take_while(|line| !line.trim().is_empty()).map(str::trim).collect::<Vec<_>>().join(" ")
}
