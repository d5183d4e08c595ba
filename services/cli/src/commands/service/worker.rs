//! `fathom worker`: renders frames for a service until it is stopped.

use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use cli::exit::Failure;
use cli::signals::stop_at_signal;
use cli::worker::Arguments;
use renderer::worker::{self, WorkerOptions};

use crate::commands::sharded;

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    if arguments.engine.engine.is_some() {
        return sharded::worker::run(&arguments);
    }
    crate::commands::service::serve::start_log("info");
    let stop = stop_at_signal()?;
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
        name: arguments.name(),
        server: arguments.server.server,
        token: arguments.server.token,
        slots: usize::from(arguments.slots),
        library,
        onnxruntime: arguments.style.onnxruntime,
        limits: arguments.limits.limits(),
    };
    worker::run(options, stop)?;
    Ok(())
}
