//! The options of `fathom worker`, for a service and for a broker.

use crate::engine::EngineArguments;
use crate::remote::ServerArguments;
use crate::render::LimitArguments;
use crate::styles::StyleArguments;

/// Options of `fathom worker`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    pub server: ServerArguments,
    #[command(flatten)]
    pub engine: EngineArguments,
    /// With a broker: the folder or s3://BUCKET/PREFIX below which this worker renders sharded datasets
    #[arg(long, env = "FATHOM_STORE", value_name = "DIR|URL", requires = "engine")]
    pub store: Option<String>,
    /// Frames rendered in parallel, one thread each
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub slots: u16,
    /// Name shown in the list of workers [default: host name and process id]
    #[arg(long, env = "FATHOM_WORKER_NAME")]
    pub name: Option<String>,
    #[command(flatten)]
    pub style: StyleArguments,
    #[command(flatten)]
    pub limits: LimitArguments,
    /// Stop when standard input closes, for a worker started by a service
    #[arg(long, hide = true)]
    pub stop_with_stdin: bool,
}

impl Arguments {
    /// The worker's name.
    pub fn name(&self) -> String {
        self.name.clone().unwrap_or_else(default_name)
    }
}

fn default_name() -> String {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host = host.trim();
    format!(
        "{}-{}",
        if host.is_empty() { "worker" } else { host },
        std::process::id()
    )
}
