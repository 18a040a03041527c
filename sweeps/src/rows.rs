//! `rows(n)`: the table of the row numbers 0 to n - 1 in the column `i`. Nothing is stored: every partition
//! generates its rows batch by batch.

use std::fmt;
use std::sync::atomic::{AtomicI64, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use async_trait::async_trait;
use datafusion::arrow::array::{ArrayRef, AsArray, Int64Array, RecordBatch, RecordBatchOptions};
use datafusion::arrow::datatypes::{DataType, Field, Int64Type, Schema, SchemaRef};
use datafusion::catalog::{Session, TableFunctionArgs, TableFunctionImpl, TableProvider};
use datafusion::common::tree_node::TreeNodeRecursion;
use datafusion::common::{DataFusionError, Result, ScalarValue, internal_err, plan_err};
use datafusion::datasource::memory::MemorySourceConfig;
use datafusion::execution::{SendableRecordBatchStream, TaskContext};
use datafusion::logical_expr::{Expr, TableType};
use datafusion::physical_expr::{EquivalenceProperties, PhysicalExpr};
use datafusion::physical_plan::execution_plan::{Boundedness, EmissionType, ReplaceChildrenOptions};
use datafusion::physical_plan::stream::RecordBatchStreamAdapter;
use datafusion::physical_plan::{DisplayAs, DisplayFormatType, ExecutionPlan, Partitioning, PlanProperties};
use futures::{Stream, StreamExt, TryStreamExt, stream};

/// The smallest partition, unless it is the only one.
const LEAST: i64 = 1 << 16;
/// The largest number of partitions; more do not help on the machines of one scheduler.
const MOST: i64 = 64;

/// Number of rows that this process has generated, for the report of progress.
pub static COUNTED: AtomicU64 = AtomicU64::new(0);

/// The rows from `first` up to, not including, `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// the first row
    pub first: i64,
    /// the row after the last
    pub end: i64,
}

impl Range {
    fn partitions(self) -> i64 {
        ((self.end - self.first) / LEAST).clamp(1, MOST)
    }

    /// The `index`-th of `count` nearly equal parts.
    pub fn part(self, index: i64, count: i64) -> Self {
        let at = |index: i64| {
            self.first + (i128::from(self.end - self.first) * i128::from(index) / i128::from(count)) as i64
        };
        Range { first: at(index), end: at(index + 1) }
    }
}

fn schema() -> SchemaRef {
    Arc::new(Schema::new(vec![Field::new("i", DataType::Int64, false)]))
}

/// The table function. The tool sets the part of the rows that a query sees.
#[derive(Debug, Default)]
pub struct RowsFunction {
    part: Mutex<Option<(i64, i64)>>,
    /// number of calls by queries
    pub calls: AtomicUsize,
    /// `n` of the latest call
    pub total: AtomicI64,
}

impl RowsFunction {
    /// Sets the part of the rows that queries see, and the number of parts; `None`: all rows.
    pub fn see(&self, part: Option<(i64, i64)>) {
        *self.part.lock().unwrap_or_else(PoisonError::into_inner) = part;
    }
}

impl TableFunctionImpl for RowsFunction {
    fn call_with_args(&self, args: TableFunctionArgs) -> Result<Arc<dyn TableProvider>> {
        let count = match args.exprs() {
            [Expr::Literal(ScalarValue::Int64(Some(count)), _)] if *count >= 0 => *count,
            [Expr::Literal(ScalarValue::UInt64(Some(count)), _)] if i64::try_from(*count).is_ok() => {
                *count as i64
            }
            // 1e9
            [Expr::Literal(ScalarValue::Float64(Some(count)), _)]
                if *count >= 0.0 && *count <= 9e15 && count.fract() == 0.0 =>
            {
                *count as i64
            }
            _ => {
                return plan_err!(
                    "rows takes one whole number that is not negative, as rows(1000000) or rows(1e6)"
                );
            }
        };
        self.calls.fetch_add(1, Ordering::Relaxed);
        self.total.store(count, Ordering::Relaxed);
        let all = Range { first: 0, end: count };
        let part = *self.part.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::new(RowsTable(part.map_or(all, |(index, count)| all.part(index, count)))))
    }
}

/// The table.
#[derive(Debug)]
pub struct RowsTable(pub Range);

#[async_trait]
impl TableProvider for RowsTable {
    fn schema(&self) -> SchemaRef {
        schema()
    }

    fn table_type(&self) -> TableType {
        TableType::Base
    }

    async fn scan(
        &self,
        _: &dyn Session,
        projection: Option<&Vec<usize>>,
        _: &[Expr],
        _: Option<usize>,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        let column = projection.is_none_or(|columns| !columns.is_empty());
        Ok(Arc::new(RowsExec::new(ranges(self.0)?, column)))
    }
}

/// The ranges of the partitions, which depend only on the rows, as a plan with one row per partition. A
/// scheduler can assign the partitions of such a plan to tasks.
fn ranges(all: Range) -> Result<Arc<dyn ExecutionPlan>> {
    let field = |name| Field::new(name, DataType::Int64, false);
    let schema = Arc::new(Schema::new(vec![field("first"), field("end")]));
    let count = all.partitions();
    let partition = |index: i64| {
        let range = all.part(index, count);
        let columns = [range.first, range.end].map(|row| Arc::new(Int64Array::from(vec![row])) as ArrayRef);
        Ok(vec![RecordBatch::try_new(Arc::clone(&schema), columns.into())?])
    };
    let partitions = (0..count).map(partition).collect::<Result<Vec<_>>>()?;
    let plan: Arc<dyn ExecutionPlan> =
        MemorySourceConfig::try_new_exec(&partitions, Arc::clone(&schema), None)?;
    Ok(plan)
}

/// The plan that generates the rows of the range in each partition of its input.
#[derive(Debug)]
pub struct RowsExec {
    ranges: Arc<dyn ExecutionPlan>,
    /// whether it generates the column, or only the number of rows
    pub column: bool,
    properties: Arc<PlanProperties>,
}

impl RowsExec {
    /// Generates the rows of these ranges.
    pub fn new(ranges: Arc<dyn ExecutionPlan>, column: bool) -> Self {
        let schema = if column { schema() } else { Arc::new(Schema::empty()) };
        let properties = PlanProperties::new(
            EquivalenceProperties::new(schema),
            Partitioning::UnknownPartitioning(ranges.properties().partitioning.partition_count()),
            EmissionType::Incremental,
            Boundedness::Bounded,
        );
        RowsExec { ranges, column, properties: Arc::new(properties) }
    }

    fn of(&self, children: Vec<Arc<dyn ExecutionPlan>>) -> Result<Arc<dyn ExecutionPlan>> {
        match <[_; 1]>::try_from(children) {
            Ok([ranges]) => Ok(Arc::new(RowsExec::new(ranges, self.column))),
            Err(children) => internal_err!("RowsExec has one child; {} are given", children.len()),
        }
    }
}

/// Generates the rows of a range, batch by batch.
fn count(
    range: Range,
    batch: i64,
    schema: SchemaRef,
    column: bool,
) -> impl Stream<Item = Result<RecordBatch>> {
    stream::unfold(range.first, move |first| {
        let end = first.saturating_add(batch).min(range.end);
        let next = (first < end).then(|| {
            let rows = (end - first) as usize;
            COUNTED.fetch_add(rows as u64, Ordering::Relaxed);
            let columns: Vec<ArrayRef> =
                if column { vec![Arc::new(Int64Array::from_iter_values(first..end))] } else { Vec::new() };
            let options = RecordBatchOptions::new().with_row_count(Some(rows));
            let batch = RecordBatch::try_new_with_options(Arc::clone(&schema), columns, &options);
            (batch.map_err(Into::into), end)
        });
        async move {
            // let other tasks run after every batch
            tokio::task::yield_now().await;
            next
        }
    })
}

/// The ranges that the rows of the input describe.
fn ranges_of(batch: &RecordBatch) -> Vec<Range> {
    let column = |index: usize| batch.column(index).as_primitive::<Int64Type>();
    (0..batch.num_rows())
        .map(|row| Range { first: column(0).value(row), end: column(1).value(row) })
        .collect()
}

impl DisplayAs for RowsExec {
    fn fmt_as(&self, _: DisplayFormatType, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "RowsExec: partitions={}", self.properties.partitioning.partition_count())
    }
}

impl ExecutionPlan for RowsExec {
    fn name(&self) -> &str {
        "RowsExec"
    }

    fn properties(&self) -> &Arc<PlanProperties> {
        &self.properties
    }

    fn children(&self) -> Vec<&Arc<dyn ExecutionPlan>> {
        vec![&self.ranges]
    }

    fn benefits_from_input_partitioning(&self) -> Vec<bool> {
        vec![false]
    }

    fn apply_expressions(
        &self,
        _: &mut dyn FnMut(&Arc<dyn PhysicalExpr>) -> Result<TreeNodeRecursion>,
    ) -> Result<TreeNodeRecursion> {
        Ok(TreeNodeRecursion::Continue)
    }

    fn replace_children(
        self: Arc<Self>,
        children: Vec<Arc<dyn ExecutionPlan>>,
        _: ReplaceChildrenOptions,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        self.of(children)
    }

    fn with_new_children(
        self: Arc<Self>,
        children: Vec<Arc<dyn ExecutionPlan>>,
    ) -> Result<Arc<dyn ExecutionPlan>> {
        self.of(children)
    }

    fn execute(&self, partition: usize, context: Arc<TaskContext>) -> Result<SendableRecordBatchStream> {
        let batch = context.session_config().batch_size().max(1) as i64;
        let (schema, column) = (self.schema(), self.column);
        let shape = Arc::clone(&schema);
        let ranges = self.ranges.execute(partition, context)?;
        let batches = ranges
            .map_ok(|batch| stream::iter(ranges_of(&batch)).map(Ok::<Range, DataFusionError>))
            .try_flatten()
            .map_ok(move |range| count(range, batch, Arc::clone(&shape), column))
            .try_flatten();
        Ok(Box::pin(RecordBatchStreamAdapter::new(schema, batches)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_all_rows_once() {
        for (first, end) in [(0, 0), (0, 1), (5, 1_000_003), (0, i64::MAX)] {
            let all = Range { first, end };
            for count in [1, 2, 7, 64] {
                let parts: Vec<Range> = (0..count).map(|index| all.part(index, count)).collect();
                assert_eq!(parts.first().map(|part| part.first), Some(first));
                assert_eq!(parts.last().map(|part| part.end), Some(end));
                assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].first));
            }
        }
    }
}
