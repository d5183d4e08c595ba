//! `fathom serve`: the service and its workers.

use std::io::IsTerminal;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context;
use api::{EngineOptions, PriceLimits};
use cli::engine::EngineArguments;
use cli::exit::Failure;
use cli::render::seconds;
use cli::styles::StyleArguments;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

use crate::commands::sharded::buckets;
use crate::program::own_program;

/// Options of `fathom serve`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder of the catalogue and the artifacts
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    pub(crate) data: PathBuf,
    /// Address to listen on; anything but loopback needs a token
    #[arg(
        long,
        env = "FATHOM_LISTEN",
        default_value = "127.0.0.1:7311",
        value_name = "ADDRESS"
    )]
    pub(crate) listen: SocketAddr,
    /// Worker processes to start; 0: only remote workers
    #[arg(long, env = "FATHOM_WORKERS", default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=256))]
    pub(crate) workers: u16,
    /// Slots of each worker process [default: the machine's cores shared among the workers]
    #[arg(long, env = "FATHOM_SLOTS", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) slots: Option<u16>,
    /// Token, or tokens as scope+scope:SECRET,… with the scopes read, submit, work, admin
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    pub(crate) token: Option<String>,
    /// More names of this service, comma-separated: without tokens it responds to localhost, 127.0.0.0/8 and [::1] alone
    #[arg(long, env = "FATHOM_HOSTS", value_name = "NAMES", value_delimiter = ',')]
    pub(crate) hosts: Vec<String>,
    #[command(flatten)]
    pub(crate) style: StyleArguments,
    /// Longest trial of an added style network
    #[arg(long, env = "FATHOM_STYLE_TRIAL_S", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub(crate) style_trial_s: u64,
    /// Longest time of one frame, after which its worker process is ended and its lease expires
    #[arg(long, env = "FATHOM_FRAME_LIMIT_S", default_value_t = 600.0, value_parser = seconds)]
    pub(crate) frame_limit_s: f64,
    /// Longest expected slot time of a frame; jobs with more expensive frames are refused
    #[arg(long, env = "FATHOM_MAX_FRAME_S", default_value_t = 3600.0, value_parser = seconds)]
    pub(crate) max_frame_s: f64,
    /// Expected slot time of all unfinished frames of a caller, hours; further jobs are refused
    #[arg(long, env = "FATHOM_MAX_CALLER_H", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub(crate) max_caller_h: u64,
    /// Expected size of all unfinished frames of a caller, GB; further jobs are refused
    #[arg(long, env = "FATHOM_MAX_CALLER_GB", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub(crate) max_caller_gb: u64,
    /// Let workers of different versions, CPU features or ONNX Runtimes share a job, whose frames may then differ in their last digits
    #[arg(long, env = "FATHOM_MIX_WORKERS")]
    pub(crate) mix_workers: bool,
    /// Render one in this number of frames a second time and compare; of workers outside of this service also their first eight frames and one
    /// after their last of each job. A worker that differs is dismissed. 0: none
    #[arg(long, env = "FATHOM_SPOT_CHECK", default_value_t = 200, value_name = "FRAMES")]
    pub(crate) spot_check: u64,
    /// Folder or s3://BUCKET/PREFIX below which clients may have sharded datasets imported; may be given several times. With --engine one:
    /// jobs become sharded datasets in it
    #[arg(
        long = "store",
        env = "FATHOM_STORE",
        value_name = "DIR|URL",
        value_delimiter = ','
    )]
    pub(crate) stores: Vec<String>,
    #[command(flatten)]
    pub(crate) engine: EngineArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    start_log("info");
    let config = config(arguments)?;
    // The clone outlives the runtime, since readers of buckets have threads that cannot be ended within it.
    let _buckets = config.buckets.clone();
    let runtime = tokio::runtime::Runtime::new().context("cannot start the asynchronous runtime")?;
    runtime.block_on(async {
        let service = api::start(config).await.map_err(Failure::input)?;
        eprintln!("fathom listens on http://{}", service.address());
        stop_signal().await?;
        service.stop().await.map_err(|error| Failure::Other(error.into()))
    })
}

/// The service's configuration from the command line.
pub(crate) fn config(arguments: Arguments) -> Result<api::Config, Failure> {
    let workers = usize::from(arguments.workers);
    let cores = cli::render::cores();
    let slots = arguments
        .slots
        .map_or_else(|| cores.div_ceil(workers.max(1)), usize::from);
    let EngineArguments {
        engine,
        engine_token,
        lease_s,
        replicas,
    } = arguments.engine;
    if engine.is_some() && arguments.stores.len() != 1 {
        let message = "`--engine` needs exactly one `--store` for the sets of the jobs";
        return Err(Failure::input(message));
    }
    let library = arguments.style.library()?;
    Ok(api::Config {
        data: arguments.data,
        listen: arguments.listen,
        workers,
        slots_per_worker: slots,
        program: own_program()?,
        stores: arguments.stores,
        engine: engine.map(|url| EngineOptions {
            url,
            token: engine_token,
            lease_s,
            replicas,
        }),
        token: arguments.token,
        hosts: arguments.hosts,
        styles: arguments.style.styles,
        onnxruntime: arguments.style.onnxruntime,
        library,
        buckets: buckets::reader(),
        style_trial: Duration::from_secs(arguments.style_trial_s),
        frame_limit: Duration::from_secs_f64(arguments.frame_limit_s),
        prices: PriceLimits {
            frame: Duration::from_secs_f64(arguments.max_frame_s),
            caller: Duration::from_secs(arguments.max_caller_h * 3600),
            caller_bytes: arguments.max_caller_gb * 1_000_000_000,
        },
        mix_workers: arguments.mix_workers,
        spot_check: arguments.spot_check,
    })
}

/// Log lines to standard error; `FATHOM_LOG` chooses the level instead of the usual one, `FATHOM_LOG_FORMAT=json` the form.
pub(crate) fn start_log(usual: &str) {
    let wanted = std::env::var("FATHOM_LOG")
        .ok()
        .and_then(|text| text.parse().ok());
    let filter: Targets = wanted.unwrap_or_else(|| usual.parse().expect("the usual levels are well formed"));
    let builder = tracing_subscriber::fmt()
        .with_max_level(LevelFilter::TRACE)
        .with_ansi(std::io::stderr().is_terminal())
        .with_writer(std::io::stderr);
    if std::env::var("FATHOM_LOG_FORMAT").is_ok_and(|format| format == "json") {
        builder.json().finish().with(filter).init();
    } else {
        builder.finish().with(filter).init();
    }
}

/// Waits for Ctrl-C or SIGTERM.
pub(crate) async fn stop_signal() -> anyhow::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate()).context("cannot listen for SIGTERM")?;
    tokio::select! {
        result = tokio::signal::ctrl_c() => result.context("cannot listen for SIGINT"),
        _ = terminate.recv() => Ok(()),
    }
}
