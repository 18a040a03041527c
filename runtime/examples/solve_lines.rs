//! Reads collisions as JSON lines and writes their outcomes, as `hodograph solve` does, so that the solver
//! can be measured without the command line tool.

use std::io::{BufRead, Write};

use hodograph::{Law, ReducedMatrix, Surface, solve};
use nalgebra::Vector3;
use serde_json::{Value, json};

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap_or(f64::NAN))
}

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        if line.trim().is_empty() {
            continue;
        }
        let case: Value = serde_json::from_str(&line)?;
        let law = match case["law"].as_str() {
            Some("newton") => Law::Newton,
            Some("poisson") => Law::Poisson,
            _ => Law::Stronge,
        };
        let number = |key: &str| case[key].as_f64().unwrap_or(f64::NAN);
        let surface = Surface { mu: number("mu"), e: number("e"), law };
        let matrix = ReducedMatrix::from(numbers::<6>(&case["m"]));
        let approach = Vector3::from(numbers::<3>(&case["v"]));
        let answer = match solve(&matrix, &approach, &surface) {
            Ok(hit) => json!({
                "impulse": [hit.impulse.x, hit.impulse.y, hit.impulse.z],
                "v": [hit.velocity.x, hit.velocity.y, hit.velocity.z],
                "dE": hit.contact_work, "dEn": hit.normal_work,
                "path": hit.path.phases(), "compressions": hit.compressions,
            }),
            Err(error) => json!({"error": {"kind": error.kind(), "message": error.to_string()}}),
        };
        writeln!(out, "{answer}")?;
    }
    Ok(())
}
