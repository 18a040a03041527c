//! The SQL functions, and their registration with engines.

mod answers;
mod batch;
mod checksum;
mod energy;
mod hash;
mod histogram;
mod model;
mod places;
mod samplers;
mod simulate;
mod solve;

use std::collections::HashMap;
use std::sync::Arc;

use datafusion::arrow::array::{Array, ArrayRef};
use datafusion::arrow::compute::take;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::{Result, internal_err};
use datafusion::execution::{FunctionRegistry, SessionState};
use datafusion::logical_expr::{AggregateUDF, ScalarUDF};
use hodograph::Cause;

pub use answers::{OK, path_name};
pub use hash::hash_rows;
pub use model::{ModelFunction, Routine, check_contacts, of_model};

use crate::models::Model;

/// The kind of a row whose law does not exist.
pub const UNKNOWN_LAW: &str = Cause::UnknownLaw.name();
/// The kind of a row whose contact, which is a value of the row, does not exist.
pub const UNKNOWN_CONTACT: &str = Cause::UnknownName.name();

fn is_number(given: &DataType) -> bool {
    given.is_numeric() || given.is_null()
}

fn is_text(given: &DataType) -> bool {
    matches!(given, DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View | DataType::Null)
}

/// An array with this number of rows; an array of a single row is repeated.
fn of_length(array: &ArrayRef, rows: usize) -> Result<ArrayRef> {
    if array.len() == rows {
        return Ok(Arc::clone(array));
    }
    if array.len() != 1 {
        return internal_err!("an argument has {} rows, the batch has {rows}", array.len());
    }
    let all_first = datafusion::arrow::array::UInt32Array::from(vec![0; rows]);
    Ok(take(array, &all_first, None)?)
}

/// The scalar functions: `solve`, `energy_gained`, samplers, hashes, and four for each model.
pub fn scalar_functions(models: &[Arc<Model>]) -> Vec<Arc<ScalarUDF>> {
    let mut all = vec![
        ScalarUDF::from(solve::Solve::default()),
        ScalarUDF::from(energy::EnergyGained::default()),
        ScalarUDF::from(hash::OutcomeHash::default()),
        ScalarUDF::from(samplers::Linspace::default()),
    ];
    all.extend(samplers::Sampler::all().map(ScalarUDF::from));
    for model in models {
        all.extend(
            Routine::ALL.map(|routine| ScalarUDF::from(ModelFunction::new(Arc::clone(model), routine))),
        );
    }
    all.into_iter().map(Arc::new).collect()
}

/// The aggregates.
pub fn aggregate_functions() -> Vec<Arc<AggregateUDF>> {
    vec![
        Arc::new(AggregateUDF::from(checksum::Checksum::default())),
        Arc::new(AggregateUDF::from(histogram::Histogram::default())),
    ]
}

/// Registers all functions with a session, in addition to those that it has.
///
/// # Errors
///
/// The engine's.
pub fn register(state: &mut SessionState, models: &[Arc<Model>]) -> Result<()> {
    for function in scalar_functions(models) {
        state.register_udf(function)?;
    }
    for function in aggregate_functions() {
        state.register_udaf(function)?;
    }
    Ok(())
}

/// Registers all functions by name, in addition to the existing ones.
pub fn insert(
    scalar: &mut HashMap<String, Arc<ScalarUDF>>,
    aggregate: &mut HashMap<String, Arc<AggregateUDF>>,
    models: &[Arc<Model>],
) {
    scalar
        .extend(scalar_functions(models).into_iter().map(|function| (function.name().to_owned(), function)));
    aggregate
        .extend(aggregate_functions().into_iter().map(|function| (function.name().to_owned(), function)));
}
