//! The list of functions.

use std::path::PathBuf;
use std::sync::Arc;

use crate::failure::Failure;
use crate::functions::{ModelFunction, Routine};
use crate::session;

const OTHERS: &str = "\
rows(n)                                table of the row numbers 0 to n - 1, column i
solve(nn, nt, ns, tt, ts, ss, vn, vt, vs, mu, e, law)
                                       a collision by itself: reduced matrix (1/kg), velocity of approach (m/s), surface
energy_gained(answer)                  the energy gained by the collision of a model, J; 0 where none is, beyond rounding
energy_gained(answer, vn, vt, vs)      the same for the answer of solve
uniform(row, dimension, seed)          uniform in [0, 1), by Philox 4x32-10
normal(row, dimension, seed)           of the standard normal distribution
sobol(row, dimension, seed)            scrambled Sobol points, dimensions 0 to 255; a new sequence every 65536 rows
linspace(index, low, high, count)      number `index` of `count` numbers from low to high
outcome_hash(x, ..)                    64 bits of the values
checksum(hash)                         aggregate: sum of hashes modulo 2^64
histogram(x, low, high, bins)          aggregate: counts below, in the bins, and above
";

/// Lists all functions, or the fields of one.
///
/// # Errors
///
/// A file is not a model; a function does not exist.
pub fn functions(own: &[PathBuf], name: Option<&str>) -> Result<String, Failure> {
    let models = session::models(own)?;
    let all = || models.iter().flat_map(|model| Routine::ALL.map(|routine| (model, routine)));
    let Some(name) = name else {
        let names: String =
            all().map(|(model, routine)| format!("{}_{}(struct)\n", model.name, routine.name())).collect();
        return Ok(format!("{OTHERS}{names}`hodograph-sweep functions NAME` lists the fields of a struct"));
    };
    let Some((model, routine)) =
        all().find(|(model, routine)| format!("{}_{}", model.name, routine.name()) == name)
    else {
        return Err(Failure::Input(format!(
            "there is no model function `{name}`; `hodograph-sweep functions` lists all"
        )));
    };
    let function = ModelFunction::new(Arc::clone(model), routine);
    let takes: Vec<String> = function.known()?.into_iter().map(|(name, _)| name).collect();
    let gives: Vec<String> =
        function.answer()?.iter().map(|field| format!("{} {}", field.name(), field.data_type())).collect();
    Ok(format!(
        "{name}(named_struct('{}', .., ..))\ntakes {}; what is not given is as in the model\ngives {}",
        takes.first().map_or("time", String::as_str),
        takes.join(", "),
        gives.join(", ")
    ))
}
