//! Runs a query: plans it, and writes its rows to a file or a summary, in parts if requested.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::util::pretty::pretty_format_batches;
use datafusion::datasource::listing::ListingTableUrl;
use datafusion::execution::context::SQLOptions;
use datafusion::logical_expr::LogicalPlan;
use datafusion::prelude::{ParquetReadOptions, SessionContext};
use datafusion::sql::parser::{DFParser, Statement};
use futures::StreamExt;

use crate::failure::Failure;
use crate::files;
use crate::functions::check_contacts;
use crate::output::{self, Digest, Sink};
use crate::parts::{Parts, row_by_row};
use crate::progress::{Progress, peak_memory};
use crate::rows::{COUNTED, RowsFunction};
use crate::session::{Engine, Setup};
use crate::stdout;

/// The largest number of rows that are shown.
const SHOWN: usize = 40;

/// A sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// the engine
    pub setup: Setup,
    /// statements that create tables, if any, then one query
    pub sql: String,
    /// number of parts
    pub parts: Option<i64>,
    /// the query that computes the answer from the table `parts`
    pub merge: Option<String>,
    /// the file of the answer; `None`: the answer is shown
    pub out: Option<PathBuf>,
    /// whether progress is not reported
    pub quiet: bool,
}

/// The first rows of an answer, and its number of rows.
#[derive(Default)]
struct Summary {
    batches: Vec<RecordBatch>,
    rows: usize,
}

impl Summary {
    fn see(&mut self, batch: &RecordBatch) {
        let room = SHOWN.saturating_sub(self.rows).min(batch.num_rows());
        if room > 0 {
            self.batches.push(batch.slice(0, room));
        }
        self.rows += batch.num_rows();
    }

    fn show(&self) -> Result<(), Failure> {
        let flat = self.batches.iter().map(output::flat).collect::<Result<Vec<_>, _>>()?;
        let table = pretty_format_batches(&flat).map_err(|error| Failure::Engine(error.to_string()))?;
        stdout::line(table)?;
        if self.rows > SHOWN {
            stdout::line(format_args!("and {} more rows", self.rows - SHOWN))?;
        }
        Ok(())
    }
}

/// A session with the tables of a sweep, and the text of its query.
struct Open {
    context: SessionContext,
    rows: Arc<RowsFunction>,
    query: Statement,
    /// the places of the files that the statements before the query read
    places: Vec<ListingTableUrl>,
}

impl Open {
    async fn new(setup: &Setup, sql: &str) -> Result<Self, Failure> {
        let (context, rows) = setup.open().await?;
        let mut statements = DFParser::parse_sql(sql)?;
        let Some(query) = statements.pop_back() else {
            return Err(Failure::Input("the query is empty".to_owned()));
        };
        let mut places = Vec::new();
        let tables = SQLOptions::new().with_allow_dml(false).with_allow_statements(false);
        for statement in statements {
            let plan = context.state().statement_to_plan(statement).await?;
            tables.verify_plan(&plan)?;
            check_contacts(&plan)?;
            places.extend(files::places(&plan)?);
            context.execute_logical_plan(plan).await?;
        }
        rows.calls.store(0, Ordering::Relaxed);
        Ok(Open { context, rows, query, places })
    }

    async fn plan(&self) -> Result<LogicalPlan, Failure> {
        let plan = self.context.state().statement_to_plan(self.query.clone()).await?;
        let queries =
            SQLOptions::new().with_allow_ddl(false).with_allow_dml(false).with_allow_statements(false);
        queries.verify_plan(&plan).map_err(|error| {
            Failure::Input(format!(
                "{}; the last statement must be a query, --out writes its answer",
                error.strip_backtrace()
            ))
        })?;
        check_contacts(&plan)?;
        Ok(plan)
    }

    /// Writes the answer of a plan to a file, if one is given, and returns its digest.
    async fn answer(
        &self,
        plan: LogicalPlan,
        out: Option<&Path>,
        summary: &mut Summary,
    ) -> Result<Digest, Failure> {
        let frame = self.context.execute_logical_plan(plan).await?;
        let mut batches = frame.execute_stream().await?;
        let schema = batches.schema();
        let mut sink =
            out.map(|out| Sink::create(out, &schema, output::origin(&self.query.to_string()))).transpose()?;
        let mut digest = Digest::default();
        while let Some(batch) = batches.next().await {
            let batch = batch?;
            match &mut sink {
                Some(sink) => sink.write(&batch)?,
                None => digest.add(&batch)?,
            }
            summary.see(&batch);
        }
        if summary.batches.is_empty() {
            summary.batches.push(RecordBatch::new_empty(schema));
        }
        sink.map_or(Ok(digest), Sink::finish)
    }
}

/// Runs a sweep and shows its result.
///
/// # Errors
///
/// A mistake in the query, or an error of the engine or a file.
pub async fn run(sweep: &Sweep) -> Result<(), Failure> {
    check(sweep)?;
    let open = Open::new(&sweep.setup, &sweep.sql).await?;
    let mut summary = Summary::default();
    let started = std::time::Instant::now();
    let (digest, rows) = match sweep.parts {
        Some(count) => in_parts(sweep, &open, count, &mut summary).await?,
        None => {
            let plan = open.plan().await?;
            let total = if open.rows.calls.load(Ordering::Relaxed) == 1 {
                open.rows.total.load(Ordering::Relaxed)
            } else {
                0
            };
            let before = COUNTED.load(Ordering::Relaxed);
            let progress = Progress::new(total as u64, sweep.quiet);
            let elsewhere = matches!(sweep.setup.engine, Engine::Cluster(..));
            let digest = tokio::select! {
                digest = open.answer(plan, sweep.out.as_deref(), &mut summary) => digest?,
                () = progress.clone().wait(), if elsewhere => Digest::default(),
                () = progress.watch(before), if !elsewhere => Digest::default(),
            };
            (digest, total as u64)
        }
    };
    summary.show()?;
    report(sweep, digest, rows, started.elapsed().as_secs_f64())
}

fn check(sweep: &Sweep) -> Result<(), Failure> {
    match (&sweep.parts, &sweep.merge, &sweep.out) {
        (None, Some(_), _) => {
            Err(Failure::Input("--merge needs --parts: it makes the answer of the parts".to_owned()))
        }
        (Some(_), _, None) => {
            Err(Failure::Input("--parts needs --out: the parts are files beside it".to_owned()))
        }
        (Some(count), ..) if *count < 1 => Err(Failure::Input("--parts must be at least 1".to_owned())),
        (None, _, Some(out)) | (Some(_), Some(_), Some(out)) => output::check(out),
        _ => Ok(()),
    }
}

fn report(sweep: &Sweep, digest: Digest, rows: u64, seconds: f64) -> Result<(), Failure> {
    if rows > 0 {
        let rate = rows as f64 / seconds;
        let cores = match sweep.setup.engine {
            Engine::Cluster(..) => String::new(),
            _ => format!(", {:.3e} rows/s and core", rate / sweep.setup.cores as f64),
        };
        stdout::line(format_args!("{:.3e} rows in {seconds:.1} s: {rate:.3e} rows/s{cores}", rows as f64))?;
    }
    if let Some(megabytes) = peak_memory() {
        stdout::line(format_args!("at most {megabytes:.0} MB of memory"))?;
    }
    stdout::line(format_args!("digest of the answer: {digest}"))?;
    if let Some(out) = &sweep.out {
        stdout::line(format_args!("written to {}", out.display()))?;
    }
    Ok(())
}

/// Runs the parts that are not complete yet, then computes the answer from all of them.
async fn in_parts(
    sweep: &Sweep,
    open: &Open,
    count: i64,
    summary: &mut Summary,
) -> Result<(Digest, u64), Failure> {
    let Some(out) = &sweep.out else { return Err(Failure::Input("--parts needs --out".to_owned())) };
    let directory = match sweep.merge {
        Some(_) => PathBuf::from(format!("{}.parts", out.display())),
        None => out.clone(),
    };
    // mistakes in queries are reported before anything is written
    let plan = open.plan().await?;
    if open.rows.calls.load(Ordering::Relaxed) != 1 {
        return Err(Failure::Input(
            "a sweep in parts names rows(n) exactly once: the parts are parts of it".to_owned(),
        ));
    }
    if sweep.merge.is_none() {
        row_by_row(&plan)?;
    }
    let total = open.rows.total.load(Ordering::Relaxed) as u64;
    let mut places = files::places(&plan)?;
    places.extend_from_slice(&open.places);
    let inputs = files::contents(&places)?;
    let parts = Parts::open(&directory, count, &sweep.sql, &sweep.setup.models, &inputs)?;
    let progress = Progress::new(total, sweep.quiet);
    let rows_before = |index: i64| (u128::from(total) * index as u128 / count as u128) as u64;
    let (mut skipped, mut told) = (0, 0);
    let mut digest = Digest::default();
    for index in 0..count {
        let rows = rows_before(index + 1) - rows_before(index);
        if parts.is_done(index)? {
            skipped += rows;
            continue;
        }
        if skipped > told && !sweep.quiet {
            // errors of writing a report are ignored
            let _ = writeln!(std::io::stderr(), "{skipped} rows were done before");
            told = skipped;
        }
        open.rows.see(Some((index, count)));
        let plan = open.plan().await?;
        open.answer(plan, Some(&parts.file(index)), &mut Summary::default()).await?;
        progress.say(rows_before(index + 1), skipped);
    }
    for index in 0..count {
        if let Some(part) = output::stated(&parts.file(index))? {
            digest.rows += part.rows;
            digest.sum = digest.sum.wrapping_add(part.sum);
        }
    }
    let (query, out) = match &sweep.merge {
        Some(merge) => (merge.clone(), Some(out.as_path())),
        None => (format!("SELECT * FROM parts LIMIT {}", SHOWN + 1), None),
    };
    let setup = Setup { engine: Engine::Embedded, ..sweep.setup.clone() };
    let (context, rows) = setup.open().await?;
    context.register_parquet("parts", directory.display().to_string(), ParquetReadOptions::default()).await?;
    let Some(query) = DFParser::parse_sql(&query)?.pop_back() else {
        return Err(Failure::Input("the query of --merge is empty".to_owned()));
    };
    let merge = Open { context, rows, query, places: Vec::new() };
    let merged = merge.answer(merge.plan().await?, out, summary).await?;
    Ok((if out.is_some() { merged } else { digest }, total - skipped))
}
