//! `fathom worker`: renders frames for a service until it is told to stop.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use cli::exit::Failure;
use cli::remote::ServerArguments;
use cli::render::LimitArguments;
use cli::styles::StyleArguments;
use renderer::worker::{self, WorkerOptions};

/// Options of `fathom worker`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Frames rendered in parallel, one thread each
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    slots: u16,
    /// Name shown in the list of workers [default: host name and process id]
    #[arg(long, env = "FATHOM_WORKER_NAME")]
    name: Option<String>,
    #[command(flatten)]
    style: StyleArguments,
    #[command(flatten)]
    limits: LimitArguments,
    /// Stop when standard input closes, for a worker started by a service
    #[arg(long, hide = true)]
    stop_with_stdin: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    super::serve::start_log("info");
    let stop = super::stop_at_signal()?;
    if arguments.stop_with_stdin {
        let stop = Arc::clone(&stop);
        std::thread::spawn(move || {
            // Ends when the parent closes its end, including when it dies.
            let _ = std::io::stdin().read_to_end(&mut Vec::new());
            stop.store(true, Ordering::SeqCst);
        });
    }
    let library = arguments.style.library()?;
    let options = WorkerOptions {
        server: arguments.server.server,
        token: arguments.server.token,
        slots: usize::from(arguments.slots),
        name: arguments.name.unwrap_or_else(default_name),
        library,
        onnxruntime: arguments.style.onnxruntime,
        limits: arguments.limits.limits(),
    };
    worker::run(options, stop)?;
    Ok(())
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
