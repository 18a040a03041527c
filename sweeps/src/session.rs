//! Sessions of the three engines: embedded, Ballista in this process, Ballista across machines.

use std::path::PathBuf;
use std::sync::Arc;

use ballista::prelude::SessionContextExt;
use ballista_core::extension::SessionConfigExt;
use ballista_core::optimizer::ballista_default_optimizer_rules;
use datafusion::execution::memory_pool::FairSpillPool;
use datafusion::execution::runtime_env::RuntimeEnvBuilder;
use datafusion::execution::{SessionState, SessionStateBuilder};
use datafusion::prelude::{SessionConfig, SessionContext};

use crate::codec::{Logical, Physical};
use crate::failure::Failure;
use crate::files::NamedFiles;
use crate::functions;
use crate::keys::{self, Keys};
use crate::models::{Model, shipped};
use crate::rows::RowsFunction;

/// The engine of a query.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Engine {
    /// DataFusion in this process
    Embedded,
    /// Ballista's scheduler and executor in this process
    InProcess,
    /// the scheduler at this address, reached with these keys
    Cluster(String, Option<Keys>),
}

/// The configuration of a session.
#[derive(Clone, Debug)]
pub struct Setup {
    /// the engine
    pub engine: Engine,
    /// number of threads
    pub cores: usize,
    /// bytes that sorts, groups and joins may hold before they spill to disk
    pub memory: usize,
    /// models of the user
    pub models: Vec<PathBuf>,
}

/// The shipped models and the user's.
///
/// # Errors
///
/// A file is not a model, or a name is already used.
pub fn models(own: &[PathBuf]) -> Result<Vec<Arc<Model>>, Failure> {
    let mut all = shipped().to_vec();
    for path in own {
        let model = Model::read(path).map_err(Failure::Input)?;
        if all.iter().any(|known| known.name == model.name) {
            return Err(Failure::Input(format!(
                "{}: there is a model `{}` already; rename the file",
                path.display(),
                model.name
            )));
        }
        all.push(Arc::new(model));
    }
    Ok(all)
}

/// A configuration with the codecs for the tables and models of this package, for connections with these keys.
pub fn configuration(keys: Option<&Keys>) -> SessionConfig {
    let config = SessionConfig::new_with_ballista()
        .with_ballista_logical_extension_codec(Arc::new(Logical::default()))
        .with_ballista_physical_extension_codec(Arc::new(Physical::default()));
    match keys {
        None => config,
        Some(keys) => config
            .with_ballista_use_tls(true)
            .with_ballista_override_create_grpc_client_endpoint(keys.endpoints()),
    }
}

/// A state with all functions, for this configuration.
///
/// # Errors
///
/// The engine's.
pub fn state(
    config: SessionConfig,
    memory: usize,
    models: &[Arc<Model>],
) -> datafusion::common::Result<SessionState> {
    let pool = Arc::new(FairSpillPool::new(memory));
    let runtime = RuntimeEnvBuilder::new().with_memory_pool(pool).build_arc()?;
    let mut state = SessionStateBuilder::new()
        .with_config(config)
        .with_runtime_env(runtime)
        .with_default_features()
        .build();
    functions::register(&mut state, models)?;
    Ok(state)
}

/// A state of the scheduler, which plans the queries of all clients; they may read these files.
///
/// # Errors
///
/// The engine's.
pub fn planner(config: SessionConfig, files: Arc<NamedFiles>) -> datafusion::common::Result<SessionState> {
    let mut state = state(config, 1 << 30, shipped())?;
    // Statements of clients must not create tables of files on this machine.
    state.table_factories_mut().clear();
    let rules = ballista_default_optimizer_rules();
    Ok(SessionStateBuilder::new_from_existing(state)
        .with_optimizer_rules(rules)
        .with_analyzer_rule(files)
        .build())
}

impl Setup {
    /// Opens a session; the table function is the session's `rows`.
    ///
    /// # Errors
    ///
    /// A file is not a model, or the scheduler does not answer.
    pub async fn open(&self) -> Result<(SessionContext, Arc<RowsFunction>), Failure> {
        let models = models(&self.models)?;
        let config = match &self.engine {
            Engine::Embedded => SessionConfig::new(),
            Engine::InProcess => configuration(None).with_ballista_standalone_parallelism(self.cores),
            Engine::Cluster(_, keys) => configuration(keys.as_ref()),
        };
        let state = state(config.with_target_partitions(self.cores), self.memory, &models)?;
        let context = match &self.engine {
            Engine::Embedded => SessionContext::new_with_state(state),
            Engine::InProcess => SessionContext::standalone_with_state(state).await?,
            Engine::Cluster(address, keys) => {
                keys::answers(address, keys.as_ref()).await?;
                SessionContext::remote_with_state(&format!("df://{address}"), state).await?
            }
        };
        // 'file.parquet' in FROM is a table
        let context = context.enable_url_table();
        // Ballista's client starts with its own functions only
        for function in functions::scalar_functions(&models) {
            context.register_udf((*function).clone());
        }
        for function in functions::aggregate_functions() {
            context.register_udaf((*function).clone());
        }
        let rows = Arc::new(RowsFunction::default());
        context.register_udtf("rows", Arc::clone(&rows) as _);
        Ok((context, rows))
    }
}
