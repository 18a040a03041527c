//! Keeps of a derivation what a benchmark needs: `cargo run --example trim -- FULL.derivation > quadruped.derivation`,
//! and with `motion` after the name what a simulation needs.

use hodograph_generator::artifact;
use hodograph_generator::program::operation::Value;
use hodograph_generator::program::{Guard, Output, Program, Quantity};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("which derivation?")?;
    let full = artifact::decode(&std::fs::read_to_string(path)?)?;
    let kept = match std::env::args().nth(2).as_deref() {
        None => vec![Quantity::CoordinateRates, Quantity::Accelerations],
        Some("motion") => {
            let all = full.program.outputs.iter().map(|output| output.quantity);
            all.filter(|quantity| !is_derivative(*quantity)).collect()
        }
        Some(other) => return Err(format!("`{other}`: there is no argument but `motion`").into()),
    };
    let slice = full.program.slice(&kept);
    let mut order = slice.order.clone();
    order.sort_unstable();
    let place = |value: Value| Value(order.binary_search(&value).unwrap_or(0) as u32);
    let program = Program {
        operations: order.iter().map(|&value| full.program.operation(value).map(place)).collect(),
        outputs: slice
            .outputs
            .iter()
            .map(|&output| Output {
                values: output.values.iter().map(|&value| place(value)).collect(),
                ..output.clone()
            })
            .collect(),
        guards: slice
            .guards
            .iter()
            .map(|&guard| Guard { value: place(guard.value), scale: guard.scale.map(place), ..guard.clone() })
            .collect(),
        structures: full.program.structures.clone(),
    };
    print!("{}", artifact::encode(&program, &full.model));
    Ok(())
}

/// Whether only those need it who linearise.
fn is_derivative(quantity: Quantity) -> bool {
    let name = format!("{quantity:?}");
    ["Derivatives", "Tangent", "Linear"].iter().any(|part| name.contains(part))
}
