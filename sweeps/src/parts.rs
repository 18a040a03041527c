//! A sweep in parts: each part of the rows is a separate file, so that an interrupted sweep can be continued.

use std::path::{Path, PathBuf};

use datafusion::common::tree_node::{TreeNode, TreeNodeRecursion};
use datafusion::logical_expr::LogicalPlan;
use sha2::{Digest, Sha256};

use crate::failure::Failure;
use crate::models::Model;
use crate::output;

/// The directory of the parts.
#[derive(Clone, Debug)]
pub struct Parts {
    /// the directory
    pub directory: PathBuf,
}

impl Parts {
    /// Opens the parts of a sweep: creates the directory, or uses that of an earlier run of the same sweep.
    /// `inputs` describes the contents of the files that the sweep reads.
    ///
    /// # Errors
    ///
    /// The directory belongs to another sweep.
    pub fn open(
        directory: &Path,
        count: i64,
        sql: &str,
        models: &[PathBuf],
        inputs: &str,
    ) -> Result<Self, Failure> {
        std::fs::create_dir_all(directory)
            .map_err(|error| Failure::file(directory, "make the directory", error))?;
        let mut hash = Sha256::new().chain_update((sql.len() as u64).to_le_bytes()).chain_update(sql);
        for model in models {
            // With what it imports written out, and its derivation.
            let model = Model::read(model).map_err(Failure::Input)?;
            hash.update((model.name.len() as u64).to_le_bytes());
            hash.update(&model.name);
            hash.update(model.digest());
        }
        let hash: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        let text = format!(
            "hodograph-sweep {}\nsha256 of the query and the models: {hash}\nparts: {count}\n{inputs}",
            env!("CARGO_PKG_VERSION")
        );
        let note = directory.join("sweep.txt");
        match std::fs::read_to_string(&note) {
            Ok(found) if found == text => {}
            Ok(_) => {
                return Err(Failure::Input(format!(
                    "{} holds parts of another sweep (another query, model, content of a file that it reads, number of parts or version); give another --out, or remove it",
                    directory.display()
                )));
            }
            Err(_) => {
                let empty = std::fs::read_dir(directory).is_ok_and(|mut files| files.next().is_none());
                if !empty {
                    return Err(Failure::Input(format!(
                        "{} is not empty and holds no sweep; give another --out",
                        directory.display()
                    )));
                }
                output::text(&note, &text)?;
            }
        }
        Ok(Parts { directory: directory.to_owned() })
    }

    /// The file of a part.
    pub fn file(&self, index: i64) -> PathBuf {
        self.directory.join(format!("part-{index:06}.parquet"))
    }

    /// Whether a part is complete.
    ///
    /// # Errors
    ///
    /// A file is damaged.
    pub fn is_done(&self, index: i64) -> Result<bool, Failure> {
        let file = self.file(index);
        match file.exists() {
            false => Ok(false),
            true => match output::stated(&file)? {
                Some(_) => Ok(true),
                None => Err(Failure::Engine(format!(
                    "{} was not written by this tool; remove it",
                    file.display()
                ))),
            },
        }
    }
}

/// Checks that the answer for all rows is the concatenation of the answers for the parts.
///
/// # Errors
///
/// The operation of the plan that depends on several rows.
pub fn row_by_row(plan: &LogicalPlan) -> Result<(), Failure> {
    let mut culprit = None;
    plan.apply(|node| {
        match node {
            LogicalPlan::Projection(_)
            | LogicalPlan::Filter(_)
            | LogicalPlan::TableScan(_)
            | LogicalPlan::SubqueryAlias(_) => {}
            other => culprit = Some(other.display().to_string()),
        }
        Ok(if culprit.is_some() { TreeNodeRecursion::Stop } else { TreeNodeRecursion::Continue })
    })?;
    match culprit {
        None => Ok(()),
        Some(node) => Err(Failure::Input(format!(
            "the query looks at several rows at once ({node}), so its parts cannot simply follow each other: give --merge a query that \
             makes the answer of the table `parts`, for instance one that sums counts"
        ))),
    }
}
