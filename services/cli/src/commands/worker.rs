//! `fathom worker`: pulls frames from a service until it is told to stop.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use renderer::worker::{self, WorkerOptions};
use signal_hook::consts::{SIGINT, SIGTERM};

use super::StyleArguments;
use crate::exit::Failure;
use crate::remote::ServerArguments;

/// Options of `fathom worker`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Frames rendered side by side, one thread each
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    slots: u16,
    /// Name shown in the list of workers [default: host name and process id]
    #[arg(long, env = "FATHOM_WORKER_NAME")]
    name: Option<String>,
    #[command(flatten)]
    style: StyleArguments,
    /// Stop when standard input closes, as a child of a service does
    #[arg(long, hide = true)]
    stop_with_stdin: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    super::serve::start_log("info");
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("cannot install a signal handler")?;
    }
    if arguments.stop_with_stdin {
        let stop = Arc::clone(&stop);
        std::thread::spawn(move || {
            // Ends when the parent closes its end, also by dying.
            let _ = std::io::stdin().read_to_end(&mut Vec::new());
            stop.store(true, Ordering::SeqCst);
        });
    }
    let library = super::styles::library(&arguments.style)?;
    let options = WorkerOptions {
        server: arguments.server.server,
        token: arguments.server.token,
        slots: usize::from(arguments.slots),
        name: arguments.name.unwrap_or_else(default_name),
        library,
        onnxruntime: arguments.style.onnxruntime,
    };
    worker::run(options, &stop)?;
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
