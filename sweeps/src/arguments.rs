//! The arguments of the tool.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::failure::Failure;
use crate::keys::Keys;
use crate::models::{Model, shipped};
use crate::run::Sweep;
use crate::session::{Engine, Setup};
use crate::short::{self, Draw, Set, Short, Vary};

/// Sweeps of collisions as SQL, on one machine or many.
#[derive(Debug, Parser)]
#[command(name = "hodograph-sweep", version)]
pub struct Arguments {
    /// the command
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a query, or a sweep in short form
    Run(Box<Run>),
    /// List the SQL functions, with the fields of their arguments and results
    Functions {
        /// models of your own, with derivations beside them
        #[arg(long, value_name = "FILE.mech")]
        model: Vec<PathBuf>,
        /// the function to describe
        name: Option<String>,
    },
    /// Compare the rows of Parquet files with the digests that are stored in the files
    Verify {
        /// the files
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Distribute queries to executors
    Scheduler {
        /// the address to listen on
        #[arg(long, default_value = "127.0.0.1:50050")]
        listen: SocketAddr,
        /// the host name under which executors reach it; default: the address of --listen
        #[arg(long)]
        host: Option<String>,
        /// seconds without a heartbeat after which the work of an executor is given to others
        #[arg(long, default_value_t = 20)]
        patience: u64,
        /// a directory whose files clients may read, here and on executors; may be given several times
        /// [default: none]
        #[arg(long, value_name = "DIRECTORY")]
        files: Vec<PathBuf>,
        /// a directory with the keys of the cluster: TLS on every connection, with certificates on both sides
        #[arg(long, value_name = "DIRECTORY")]
        tls: Option<PathBuf>,
    },
    /// Compute for a scheduler
    Executor {
        /// HOST:PORT of the scheduler
        #[arg(long, default_value = "127.0.0.1:50050")]
        scheduler: String,
        /// the address on which it offers results; the next port is used, too
        #[arg(long, default_value = "127.0.0.1:50060")]
        listen: SocketAddr,
        /// the host name under which others reach it; default: the address of --listen
        #[arg(long)]
        host: Option<String>,
        /// number of threads; default: all cores
        #[arg(long)]
        cores: Option<usize>,
        /// memory for sorts, groups and joins before they spill to disk, such as 2G
        #[arg(long, default_value = "2G", value_parser = bytes)]
        memory: usize,
        /// the directory for results until they are fetched
        #[arg(long, value_name = "DIRECTORY")]
        work: Option<PathBuf>,
        /// a directory with the keys of the cluster: TLS on every connection, with certificates on both sides
        #[arg(long, value_name = "DIRECTORY")]
        tls: Option<PathBuf>,
    },
    /// Make the keys of a cluster, for --tls: every process of the cluster needs a copy
    Keys {
        /// the new directory
        directory: PathBuf,
    },
}

/// The arguments of `run`.
#[derive(Debug, Args)]
pub struct Run {
    /// file with the query, which may follow statements that create tables
    query: Option<PathBuf>,
    /// the query itself
    #[arg(long, conflicts_with = "query", allow_hyphen_values = true)]
    sql: Option<String>,
    /// short form: the model, by its name in models/ or as a file; with a query: a file whose functions the
    /// query calls
    #[arg(long, value_name = "NAME or FILE.mech")]
    model: Vec<String>,
    /// short form: a grid of values of a field, including both ends
    #[arg(long, value_name = "NAME=LOW:HIGH:COUNT")]
    vary: Vec<Vary>,
    /// short form: a field that is random for each collision; default: the independent speeds, from -1 to 1
    #[arg(long, value_name = "NAME=LOW:HIGH", allow_hyphen_values = true)]
    draw: Vec<Draw>,
    /// short form: a field that is the same for all collisions; default: mu=0.5, e=0.5, law=stronge and the
    /// model's initial state
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Set>,
    /// short form: the number of collisions, such as 1e9
    #[arg(long, value_parser = short::count, value_name = "COUNT")]
    sample: Option<i64>,
    /// short form: the seed of random fields
    #[arg(long, default_value_t = 0)]
    seed: i64,
    /// short form: the random sequence
    #[arg(long, default_value = "uniform", value_parser = ["uniform", "sobol"])]
    sampler: String,
    /// short form: show the query and stop
    #[arg(long)]
    show_sql: bool,
    /// run on the cluster of this scheduler
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "in_process")]
    cluster: Option<String>,
    /// a directory with the keys of the cluster
    #[arg(long, value_name = "DIRECTORY", requires = "cluster")]
    tls: Option<PathBuf>,
    /// run on a Ballista cluster inside this process
    #[arg(long)]
    in_process: bool,
    /// number of threads; default: all cores
    #[arg(long)]
    cores: Option<usize>,
    /// memory for sorts, groups and joins before they spill to disk, such as 2G
    #[arg(long, default_value = "2G", value_parser = bytes)]
    memory: usize,
    /// compute the rows of rows(n) in this number of parts, each stored in a file; the same command continues
    /// after an interruption
    #[arg(long, value_name = "COUNT")]
    parts: Option<i64>,
    /// file with the query that computes the answer from the table `parts`; default: the parts are written
    /// one after the other to the directory --out
    #[arg(long, value_name = "FILE.sql")]
    merge: Option<PathBuf>,
    /// write the answer to this file, .parquet or .csv
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// do not report progress
    #[arg(long)]
    quiet: bool,
}

/// A size of memory: 500M, 2G.
fn bytes(text: &str) -> Result<usize, String> {
    let (digits, unit) = match text.char_indices().last() {
        Some((at, 'K' | 'k')) => (&text[..at], 1_usize << 10),
        Some((at, 'M' | 'm')) => (&text[..at], 1 << 20),
        Some((at, 'G' | 'g')) => (&text[..at], 1 << 30),
        _ => (text, 1),
    };
    let size =
        digits.parse::<usize>().ok().and_then(|number| number.checked_mul(unit)).filter(|&size| size > 0);
    size.ok_or_else(|| format!("`{text}` is no size; expected a whole number with K, M or G, as 2G"))
}

/// The given number of threads, or all cores.
///
/// # Errors
///
/// The number is zero.
pub fn cores(given: Option<usize>) -> Result<usize, Failure> {
    match given {
        Some(0) => Err(Failure::Input("--cores must be at least 1".to_owned())),
        Some(cores) => Ok(cores),
        None => Ok(std::thread::available_parallelism().map_or(1, usize::from)),
    }
}

fn read(path: &PathBuf) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("cannot read {}: {error}", path.display())))
}

impl Run {
    /// The sweep, or in short form with `--show-sql` the text of its query.
    ///
    /// # Errors
    ///
    /// Arguments that do not fit together, files that cannot be read.
    pub fn sweep(self) -> Result<Result<Sweep, String>, Failure> {
        let engine = match (&self.cluster, self.in_process) {
            (Some(address), _) => {
                Engine::Cluster(address.clone(), self.tls.as_deref().map(Keys::read).transpose()?)
            }
            (None, true) => Engine::InProcess,
            (None, false) => Engine::Embedded,
        };
        let is_file = |model: &&String| model.ends_with(".mech");
        let models = self.model.iter().filter(is_file).map(PathBuf::from).collect();
        let setup = Setup { engine, cores: cores(self.cores)?, memory: self.memory, models };
        let (sql, merge, parts) = match (&self.query, &self.sql, self.sample) {
            (None, None, Some(sample)) => {
                let (query, merge) = self.short(sample)?;
                if self.show_sql {
                    return Ok(Err(query));
                }
                (query, self.parts.map(|_| merge), self.parts)
            }
            (_, _, Some(_)) => {
                return Err(Failure::Input(
                    "--sample belongs to the short form, which takes no query".to_owned(),
                ));
            }
            (Some(path), ..) => (read(path)?, self.merge.as_ref().map(read).transpose()?, self.parts),
            (None, Some(sql), _) => (sql.clone(), self.merge.as_ref().map(read).transpose()?, self.parts),
            (None, None, None) => {
                return Err(Failure::Input(
                    "give a query: `run query.sql`, `run --sql TEXT`, or the short form `run --model NAME --vary mu=0:2:100 --sample 1e6`".to_owned(),
                ));
            }
        };
        Ok(Ok(Sweep { setup, sql, parts, merge, out: self.out, quiet: self.quiet }))
    }

    fn short(&self, sample: i64) -> Result<(String, String), Failure> {
        let [name] = self.model.as_slice() else {
            return Err(Failure::Input("the short form takes exactly one --model".to_owned()));
        };
        let own;
        let model: &Model = if name.ends_with(".mech") {
            own = Model::read(name.as_ref()).map_err(Failure::Input)?;
            &own
        } else {
            shipped().iter().find(|model| model.name == *name).ok_or_else(|| {
                let names: Vec<&str> = shipped().iter().map(|model| model.name.as_str()).collect();
                Failure::Input(format!(
                    "there is no model `{name}`; a file of yours ends with .mech, and shipped are {}",
                    names.join(", ")
                ))
            })?
        };
        let (vary, draw, set) = (&self.vary, &self.draw, &self.set);
        Short { model, vary, draw, set, sample, seed: self.seed, sampler: &self.sampler }.sql()
    }
}
