//! Queries inside the test's own process.

use datafusion::arrow::array::{AsArray, RecordBatch};
use datafusion::arrow::datatypes::Float64Type;
use hodograph_sweeps::session::{Engine, Setup};

/// The answer of a query, as one batch.
pub async fn query(sql: &str) -> RecordBatch {
    let setup = Setup { engine: Engine::Embedded, cores: 2, memory: 1 << 30, models: Vec::new() };
    let (context, _) = setup.open().await.unwrap();
    let batches = context.sql(sql).await.unwrap().collect().await.unwrap();
    let schema = batches.first().expect("no rows").schema();
    datafusion::arrow::compute::concat_batches(&schema, &batches).unwrap()
}

/// A column of numbers.
pub fn numbers(batch: &RecordBatch, column: usize) -> Vec<Option<f64>> {
    batch.column(column).as_primitive::<Float64Type>().iter().collect()
}

/// A column of texts.
pub fn texts(batch: &RecordBatch, column: usize) -> Vec<Option<String>> {
    batch.column(column).as_string::<i32>().iter().map(|text| text.map(str::to_owned)).collect()
}
