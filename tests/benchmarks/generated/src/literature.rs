//! Inverse dynamics of two arms beside what the literature counts.

use std::path::Path;

use hodograph_generator::artifact;
use hodograph_generator::program::Quantity;

use crate::tools::{Failure, Folders, output};

/// Models with the counts of others.
const ARMS: [(&str, &str); 2] = [
    ("stanford_arm", "Kane and Levinson (1983), by hand: 646 mul, 394 add"),
    ("puma_560", "Armstrong, Khatib and Burdick (1986), abbreviated (small terms dropped): 305 operations"),
];

/// Prints operations per evaluation with all parameters at run time; what depends on parameters alone is
/// computed once.
pub fn print(folders: &Folders, tool: &Path) -> Result<(), Failure> {
    println!("\n| inverse dynamics | ours | in the literature |\n| --- | --- | --- |");
    for (name, theirs) in ARMS {
        let model = folders.work.join(format!("models/{name}.mech"));
        std::fs::copy(folders.root.join(format!("models/{name}.mech")), &model)?;
        output(std::process::Command::new(tool).args(["derive", "--force"]).arg(&model))?;
        let text = std::fs::read_to_string(model.with_extension("derivation"))?;
        let derived = artifact::decode(&text).map_err(|error| Failure::new(format!("{name}: {error:?}")))?;
        let count = derived.program.cost(&[Quantity::InverseDynamics]).evaluation();
        println!("| {name} | {count} | {theirs} |");
    }
    Ok(())
}
