//! The structure of contacts that the symbols show, and the closed form that it selects.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// A chain of three sliders whose last one strikes a floor; the second slides along `second`.
fn sliders(name: &str, masses: [&str; 3], second: &str, third: &str) -> String {
    let [a, b, c] = masses;
    format!(
        "mechanism {name};
        parameters {{ a: kg = 1, b: kg = 2, c: kg = 3, k: 1 = 0.6 }}
        coordinates {{ x: m, y: m, z: m = 0.1 }}
        speeds {{ u: m/s = 1, v: m/s = 0.5, w: m/s = -1 }}
        points {{ A = O + x*N.x; B = A + y*({second}); C = B + z*({third}); }}
        particles {{ {a} {b} {c} }}
        kinematics {{ d(x)/dt = u; d(y)/dt = v; d(z)/dt = w; }}
        contacts {{ floor {{ point: C, normal: N.z, gap: z }} }}
        "
    )
}

const CARRIAGE: &str = "First { point: A, mass: a },";
const CROSSBAR: &str = "Second { point: B, mass: b },";
const TOOL: &str = "Third { point: C, mass: c },";

#[test]
fn symbols_select_closed_forms() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("structure");
    fs::create_dir_all(&folder).expect("a folder for the test");
    let all = [CARRIAGE, CROSSBAR, TOOL];
    let cases = [
        // A point mass resists alike in all directions.
        ("point", sliders("Point", ["", "", TOOL], "N.y", "N.z"), Some("Isotropic")),
        // A gantry moves other masses along each axis.
        ("gantry", sliders("Gantry", all, "N.y", "N.z"), Some("Diagonal")),
        // Its crossbar askew: the axes in the plane are coupled, the normal is not.
        ("askew", sliders("Askew", all, "k*N.x + sqrt(1 - k^2)*N.y", "N.z"), Some("Balanced")),
        // Its tool askew: everything is coupled.
        ("tilted", sliders("Tilted", all, "k*N.x + sqrt(1 - k^2)*N.y", "k*N.y + sqrt(1 - k^2)*N.z"), None),
    ];
    for (name, text, marker) in cases {
        let file = folder.join(format!("{name}.mech"));
        fs::write(&file, text).expect("a model");
        let tool = |command: &str| {
            let output = Command::new(crate::common::tool())
                .arg(command)
                .arg(&file)
                .stdin(Stdio::null())
                .output()
                .expect("the tool runs");
            assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<String>()
        };
        tool("derive");
        let code = tool("expand");
        let structures = ["Isotropic", "Diagonal", "Balanced", "Planar"];
        let used: Vec<_> = structures.iter().filter(|s| code.contains(&format!("structure::{s}"))).collect();
        assert_eq!(used, marker.iter().collect::<Vec<_>>(), "{name}");
        assert!(code.contains("fnsaltation_floor"), "{name}");
    }
}
