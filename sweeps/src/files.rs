//! The files that plans read: their places, their contents, and which of them a scheduler lets its clients
//! read.

use std::any::Any;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

use datafusion::common::config::ConfigOptions;
use datafusion::common::tree_node::TreeNodeRecursion;
use datafusion::common::{DataFusionError, Result, plan_err};
use datafusion::datasource::listing::{ListingTable, ListingTableUrl};
use datafusion::datasource::source_as_provider;
use datafusion::logical_expr::LogicalPlan;
use datafusion::optimizer::AnalyzerRule;
use sha2::{Digest, Sha256};

use crate::failure::Failure;

/// The places from which a plan, including its subqueries, reads files.
///
/// # Errors
///
/// The engine's.
pub fn places(plan: &LogicalPlan) -> Result<Vec<ListingTableUrl>> {
    let mut found = Vec::new();
    plan.apply_with_subqueries(|node| {
        if let LogicalPlan::TableScan(scan) = node
            && let Ok(provider) = source_as_provider(&scan.source)
        {
            let provider: &dyn Any = &*provider;
            if let Some(listing) = provider.downcast_ref::<ListingTable>() {
                found.extend(listing.table_paths().iter().cloned());
            }
        }
        Ok(TreeNodeRecursion::Continue)
    })?;
    Ok(found)
}

/// The contents of the files at these places: a line for each with its size and a hash.
///
/// # Errors
///
/// A file that cannot be read.
pub fn contents(places: &[ListingTableUrl]) -> std::result::Result<String, Failure> {
    let mut files = Vec::new();
    for place in places {
        match place.get_url().to_file_path() {
            Ok(path) => walk(&path, &mut files).map_err(|error| Failure::file(&path, "read", error))?,
            Err(()) => files.push(PathBuf::from(place.as_str())),
        }
    }
    files.sort();
    files.dedup();
    let mut out = String::new();
    for file in files {
        let (size, hash) = content(&file).map_err(|error| Failure::file(&file, "read", error))?;
        let _ = writeln!(out, "input: {hash} of {size} bytes, {}", file.display());
    }
    Ok(out)
}

/// The files at a path: the file itself, or all files in the directory.
fn walk(path: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    if !path.metadata()?.is_dir() {
        files.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path)? {
        walk(&entry?.path(), files)?;
    }
    Ok(())
}

/// Size and hash of a file.
fn content(file: &Path) -> std::io::Result<(u64, String)> {
    let (mut hash, mut size) = (Sha256::new(), 0);
    let mut file = std::fs::File::open(file)?;
    let mut buffer = vec![0; 1 << 20];
    loop {
        let count = file.read(&mut buffer)?;
        if count == 0 {
            break;
        }
        hash.update(&buffer[..count]);
        size += count as u64;
    }
    Ok((size, hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()))
}

/// Refuses on the scheduler what a client must not do: reading files outside of the given directories, and
/// statements that change or write anything. The client of this package refuses such statements itself, but
/// other clients may not.
#[derive(Debug)]
pub struct NamedFiles {
    roots: Vec<PathBuf>,
}

impl NamedFiles {
    /// With these directories.
    ///
    /// # Errors
    ///
    /// One that is none.
    pub fn new(roots: &[PathBuf]) -> std::result::Result<Self, Failure> {
        let roots = roots.iter().map(|root| {
            let found =
                root.canonicalize().map_err(|error| Failure::file(root, "use the directory", error))?;
            match found.is_dir() {
                true => Ok(found),
                false => Err(Failure::Input(format!("--files {}: this is no directory", root.display()))),
            }
        });
        Ok(Self { roots: roots.collect::<std::result::Result<_, _>>()? })
    }

    fn allows(&self, place: &ListingTableUrl) -> bool {
        let Ok(path) = place.get_url().to_file_path() else { return false };
        // The targets of links count. Files that are not on this machine are identified by their paths, which
        // must not contain `..`.
        let upwards = path.components().any(|part| part == std::path::Component::ParentDir);
        let path = path.canonicalize().unwrap_or(path);
        !upwards && self.roots.iter().any(|root| path.starts_with(root))
    }
}

impl AnalyzerRule for NamedFiles {
    fn analyze(&self, plan: LogicalPlan, _: &ConfigOptions) -> Result<LogicalPlan> {
        plan.apply_with_subqueries(|node| match node {
            LogicalPlan::Ddl(_) | LogicalPlan::Dml(_) | LogicalPlan::Copy(_) | LogicalPlan::Statement(_) => {
                plan_err!("the scheduler takes queries only: {}", node.display())
            }
            _ => Ok(TreeNodeRecursion::Continue),
        })?;
        match places(&plan)?.iter().find(|place| !self.allows(place)) {
            Some(place) => Err(DataFusionError::Plan(format!(
                "the scheduler does not let clients read {place}: start it with --files and a directory that holds it"
            ))),
            None => Ok(plan),
        }
    }

    fn name(&self) -> &str {
        "named_files"
    }
}
