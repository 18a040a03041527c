//! The processes of a cluster: Ballista's scheduler and executor with the functions of this package.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;

use arrow_flight::flight_service_server::FlightServiceServer;
use ballista_core::config::TaskSchedulingPolicy;
use ballista_core::registry::BallistaFunctionRegistry;
use ballista_core::serde::protobuf::scheduler_grpc_server::SchedulerGrpcServer;
use ballista_core::utils::{GrpcServerConfig, create_grpc_server};
use ballista_executor::ArrowFlightServerProvider;
use ballista_executor::executor_process::{ExecutorProcessConfig, start_executor_process};
use ballista_executor::flight_service::BallistaFlightService;
use ballista_scheduler::cluster::BallistaCluster;
use ballista_scheduler::config::SchedulerConfig;
use ballista_scheduler::scheduler_process::{create_scheduler, start_server};
use datafusion_proto::protobuf::{LogicalPlanNode, PhysicalPlanNode};

use crate::codec::{Logical, Physical};
use crate::failure::Failure;
use crate::files::NamedFiles;
use crate::functions;
use crate::keys::{self, Keys};
use crate::models::shipped;
use crate::session;
use crate::stdout;

/// Seconds between the heartbeats of an executor.
pub const HEARTBEAT: u64 = 2;

/// The longest message between executors, in bytes: that of the engine's own service.
const MESSAGE: usize = 16 << 20;

/// The scheduler's arguments.
#[derive(Clone, Debug)]
pub struct Scheduler {
    /// the address to listen on
    pub listen: SocketAddr,
    /// the host name under which executors reach it
    pub host: String,
    /// seconds without a heartbeat after which the work of an executor is given to others
    pub patience: u64,
    /// the directories whose files clients may read
    pub files: Vec<PathBuf>,
    /// the keys of the cluster; without, nothing is encrypted
    pub keys: Option<Keys>,
}

/// Runs a scheduler until the process ends.
///
/// # Errors
///
/// An address in use; the engine's.
pub async fn scheduler(given: &Scheduler) -> Result<(), Failure> {
    let files = Arc::new(NamedFiles::new(&given.files)?);
    let keys = given.keys.clone();
    let mut config = SchedulerConfig::default()
        .with_hostname(given.host.clone())
        .with_port(given.listen.port())
        .with_scheduler_policy(TaskSchedulingPolicy::PullStaged)
        .with_no_executors_grace_period_seconds(given.patience.max(30))
        .with_override_config_producer(Arc::new(move || session::configuration(keys.as_ref())))
        .with_override_session_builder(Arc::new(move |config| session::planner(config, Arc::clone(&files))));
    config.bind_host = given.listen.ip().to_string();
    config.executor_timeout_seconds = given.patience;
    config.expire_dead_executor_interval_seconds = (given.patience / 3).max(1);
    config.override_logical_codec = Some(Arc::new(Logical::default()));
    config.override_physical_codec = Some(Arc::new(Physical::default()));
    if let Some(keys) = &given.keys {
        config = config.with_use_tls(true).with_override_create_grpc_client_endpoint(keys.endpoints());
    }
    let failed =
        |error: String| Failure::Engine(format!("the scheduler at {} stopped: {error}", given.listen));
    // a clear message before that of the engine
    drop(tokio::net::TcpListener::bind(given.listen).await.map_err(|error| failed(error.to_string()))?);
    let cluster =
        BallistaCluster::new_from_config(&config).await.map_err(|error| failed(error.to_string()))?;
    // nobody need read it
    let _ = stdout::line(format_args!("scheduler listens at {}", given.listen));
    let config = Arc::new(config);
    match &given.keys {
        None => start_server(cluster, given.listen, config).await.map_err(|error| failed(error.to_string())),
        Some(keys) => {
            let size = |bytes: u32| usize::try_from(bytes).unwrap_or(usize::MAX);
            let (decoded, encoded) = (
                size(config.grpc_server_max_decoding_message_size),
                size(config.grpc_server_max_encoding_message_size),
            );
            let service = create_scheduler::<LogicalPlanNode, PhysicalPlanNode>(cluster, config)
                .await
                .map_err(|error| failed(error.to_string()))?;
            let service = SchedulerGrpcServer::new(service)
                .max_decoding_message_size(decoded)
                .max_encoding_message_size(encoded);
            create_grpc_server(&GrpcServerConfig::default())
                .tls_config(keys.server())
                .map_err(|error| failed(error.to_string()))?
                .add_service(service)
                .serve(given.listen)
                .await
                .map_err(|error| failed(format!("{error:?}")))
        }
    }
}

/// The service from which others fetch an executor's results, by TLS with these keys.
fn results(keys: Keys, message: usize) -> Arc<ArrowFlightServerProvider> {
    Arc::new(move |work, listen, mut shutdown, config| {
        let keys = keys.server();
        tokio::spawn(async move {
            let service = FlightServiceServer::new(BallistaFlightService::new(work))
                .max_decoding_message_size(message)
                .max_encoding_message_size(message);
            create_grpc_server(&config)
                .tls_config(keys)?
                .add_service(service)
                .serve_with_shutdown(listen, shutdown.recv())
                .await
                .map_err(Into::into)
        })
    })
}

/// An executor's arguments.
#[derive(Clone, Debug)]
pub struct Executor {
    /// host and port of the scheduler
    pub scheduler: String,
    /// the address on which it offers results
    pub listen: SocketAddr,
    /// the host name under which others reach it
    pub host: String,
    /// number of threads
    pub cores: usize,
    /// bytes that its tasks may hold before they spill to disk
    pub memory: u64,
    /// the directory for results until they are fetched
    pub work: PathBuf,
    /// the keys of the cluster; without, nothing is encrypted
    pub keys: Option<Keys>,
}

/// Runs an executor until it is stopped.
///
/// # Errors
///
/// The scheduler does not answer; errors of the engine.
pub async fn executor(given: &Executor) -> Result<(), Failure> {
    let Some((host, port)) =
        given.scheduler.rsplit_once(':').and_then(|(host, port)| Some((host, port.parse().ok()?)))
    else {
        return Err(Failure::Input(format!("--scheduler {}: expected HOST:PORT", given.scheduler)));
    };
    keys::answers(&given.scheduler, given.keys.as_ref()).await?;
    std::fs::create_dir_all(&given.work)
        .map_err(|error| Failure::file(&given.work, "make the directory", error))?;
    let mut registry = BallistaFunctionRegistry::default();
    functions::insert(&mut registry.scalar_functions, &mut registry.aggregate_functions, shipped());
    let own = given.keys.clone();
    let config = ExecutorProcessConfig {
        bind_host: given.listen.ip().to_string(),
        external_host: Some(given.host.clone()),
        port: given.listen.port(),
        grpc_port: given.listen.port() + 1,
        scheduler_host: host.to_owned(),
        scheduler_port: port,
        vcores: given.cores,
        task_scheduling_policy: TaskSchedulingPolicy::PullStaged,
        work_dir: Some(given.work.display().to_string()),
        executor_heartbeat_interval_seconds: HEARTBEAT,
        memory_pool_size: Some(given.memory),
        job_data_ttl_seconds: 3600,
        job_data_clean_up_interval_seconds: 600,
        override_function_registry: Some(Arc::new(registry)),
        override_config_producer: Some(Arc::new(move || session::configuration(own.as_ref()))),
        override_create_grpc_client_endpoint: given.keys.as_ref().map(Keys::endpoints),
        override_arrow_flight_service: given.keys.clone().map(|keys| results(keys, MESSAGE)),
        override_logical_codec: Some(Arc::new(Logical::default())),
        override_physical_codec: Some(Arc::new(Physical::default())),
        ..Default::default()
    };
    // nobody need read it
    let _ = stdout::line(format_args!(
        "executor at {} works for the scheduler at {}",
        given.listen, given.scheduler
    ));
    start_executor_process(Arc::new(config)).await.map_err(|error| {
        Failure::Engine(format!("the executor of the scheduler at {} stopped: {error}", given.scheduler))
    })
}
