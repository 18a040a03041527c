//! The course of a collision: its hodograph.

use hodograph::nalgebra::Vector3;
use hodograph::{Hodograph, Law, ReducedMatrix, Surface};
use serde_json::{Value, json};

use crate::answer::object;

/// Points of the curve.
const POINTS: usize = 160;

/// The law of this name.
///
/// # Errors
///
/// A sentence.
pub fn law(name: &str) -> Result<Law, String> {
    Law::ALL
        .iter()
        .copied()
        .find(|law| law.name() == name)
        .ok_or_else(|| format!("there is no law `{name}`: give one of {}", Law::NAMES.join(", ")))
}

/// Velocity along t and s, velocity along n and normal impulse, along the course of a collision with a reduced
/// `matrix` (nn, nt, ns, tt, ts, ss), a velocity of `approach` and a surface.
///
/// # Errors
///
/// What is missing, or the error of the solver.
pub fn course(question: &Value) -> Result<Value, String> {
    let numbers = |name: &str| -> Result<Vec<f64>, String> {
        let list = question[name].as_array().map(|list| list.iter().filter_map(Value::as_f64).collect());
        list.ok_or_else(|| format!("the question has no `{name}`"))
    };
    let number = |name: &str| question[name].as_f64().ok_or_else(|| format!("the question has no `{name}`"));
    let matrix: [f64; 6] =
        numbers("matrix")?.try_into().map_err(|_| "`matrix` has six numbers".to_owned())?;
    let approach: [f64; 3] =
        numbers("approach")?.try_into().map_err(|_| "`approach` has three numbers".to_owned())?;
    let law = law(question["law"].as_str().unwrap_or(""))?;
    let surface = Surface { mu: number("mu")?, e: number("e")?, law };
    let hodograph = Hodograph::new(&ReducedMatrix::from(matrix), &Vector3::from(approach), &surface)
        .map_err(|error| error.to_string())?;
    let points: Value = hodograph
        .points(POINTS)
        .map(|at| json!([at.velocity.y, at.velocity.z, at.velocity.x, at.impulse.x]))
        .collect();
    let impact = hodograph.impact();
    let end = impact.phases.slip_end.map(|at| at.impulse.x);
    let compressed = impact.phases.compression_end.map(|at| at.impulse.x);
    Ok(object!({ "points": points, "slip_end": end, "compression_end": compressed }))
}
