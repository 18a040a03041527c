//! Public robots: fetched from a package index, imported, derived and held to another program.

use std::path::Path;
use std::process::Command;

use crate::python;
use crate::tools::{Failure, Folders, output};

/// The package with the robots.
const PACKAGE: &str = "example-robot-data==6.0.0";

/// Robot descriptions inside the first package, with the link whose contact is compared.
const ROBOTS: [&str; 4] = [
    "ur_description/urdf/ur5_robot.urdf:tool0",
    "kinova_description/robots/kinova.urdf:j2s6s200_link_finger_tip_1",
    "solo_description/robots/solo12.urdf:HR_FOOT",
    "simple_humanoid_description/urdf/simple_humanoid.urdf:r_ankle",
];

/// Fetches the robots (some 230 MB, kept in the benchmark's own folder) and compares; prints a table.
pub fn compare(folders: &Folders, tool: &Path) -> Result<(), Failure> {
    let folder = folders.work.join("robots");
    std::fs::create_dir_all(&folder)?;
    let python = python::with_pinocchio(folders)?;
    let robots = folder.join("cmeel.prefix/share/example-robot-data/robots");
    if !robots.exists() {
        eprintln!("fetching robots");
        output(
            Command::new(&python)
                .args(["-m", "pip", "--quiet", "download", "--no-deps", "--dest", "wheel", PACKAGE])
                .current_dir(&folder),
        )?;
        let wheels = std::fs::read_dir(folder.join("wheel"))?;
        for wheel in wheels {
            output(
                Command::new(&python)
                    .args(["-m", "zipfile", "-e"])
                    .arg(wheel?.path())
                    .arg(".")
                    .current_dir(&folder),
            )?;
        }
    }
    let mut command = Command::new(&python);
    command.args(["-c", include_str!("robots.py")]).arg(tool).arg(folder.join("models"));
    command.args(ROBOTS.iter().map(|robot| robots.join(robot)));
    println!("\n{}", output(&mut command)?);
    Ok(())
}
