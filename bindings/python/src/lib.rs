//! The native part of the Python package `hodograph`; `python/hodograph` makes classes of it that Python
//! users see.

#![forbid(unsafe_code)]

mod arguments;
mod closed;
mod collisions;
mod ends;
mod errors;
mod gradients;
mod impacts;
mod laws;
mod machine;
mod machines;
mod many;
mod mechanism;
mod model;
mod motion;
mod numeric;
mod quantities;
mod record;
mod routine;
mod states;
mod validation;

use hodograph::Path;
use pyo3::prelude::*;

/// Module of the package that is compiled from Rust.
#[pymodule]
fn hodograph_native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<mechanism::Mechanism>()?;
    module.add_class::<record::Record>()?;
    module.add_function(wrap_pyfunction!(model::check_model, module)?)?;
    module.add_function(wrap_pyfunction!(validation::signed_ranks, module)?)?;
    module.add_function(wrap_pyfunction!(validation::wilson_interval, module)?)?;
    module.add_function(wrap_pyfunction!(impacts::solve_rows, module)?)?;
    module.add_function(wrap_pyfunction!(impacts::derivative_rows, module)?)?;
    module.add_function(wrap_pyfunction!(impacts::characteristics_rows, module)?)?;
    module.add_function(wrap_pyfunction!(impacts::course, module)?)?;
    module.add("KINDS", collisions::kinds())?;
    module.add("COLLISION", collisions::FIELDS.to_vec())?;
    module.add("IMPACT", impacts::FIELDS.to_vec())?;
    module.add("DERIVATIVE", impacts::DERIVATIVES.to_vec())?;
    module.add("CHARACTERISTICS", impacts::CHARACTERISTICS.map(|name| (name, 1_usize)).to_vec())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("PATHS", Path::ALL.iter().map(Path::to_string).collect::<Vec<_>>())?;
    Ok(())
}
