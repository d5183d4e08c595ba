//! `fathom worker`: renders frames for a service until it is told to stop.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use cli::exit::Failure;
use cli::remote::ServerArguments;
use cli::styles::StyleArguments;
use renderer::worker::{self, Limits, WorkerOptions, available_bytes};

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
    /// Longest time for one frame in seconds; a worker that takes longer aborts and its frames are leased again
    #[arg(long, env = "FATHOM_FRAME_LIMIT_S", default_value_t = 600.0, value_parser = positive)]
    frame_limit_s: f64,
    /// Most memory of this worker, beyond which it aborts [default: three quarters of the machine's, or of its container's limit]
    #[arg(long, env = "FATHOM_MEMORY_LIMIT_MIB", value_parser = clap::value_parser!(u64).range(64..))]
    memory_limit_mib: Option<u64>,
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
        limits: Limits {
            frame: Duration::from_secs_f64(arguments.frame_limit_s),
            memory_bytes: arguments
                .memory_limit_mib
                .map_or_else(usual_memory, |mib| mib << 20),
        },
    };
    worker::run(options, stop)?;
    Ok(())
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    // At most a year, well within the range of a duration.
    if value > 0.0 && value <= 31_536_000.0 {
        Ok(value)
    } else {
        Err(format!("{value} s is not within 0 < s <= 31536000"))
    }
}

fn usual_memory() -> u64 {
    available_bytes().map_or(u64::MAX, |bytes| bytes / 4 * 3)
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
