//! The worker: leases frames from a service, renders them and submits the results.
//!
//! Each slot has two threads: one renders, the other submits finished frames, so that transfer and computation overlap. One more
//! thread sends heartbeats for all leases, and a watchdog ends the process when a frame exceeds its time or the worker its memory.
//! Failures stay local: the worker drops a lost lease, retries while the service is unavailable, reports a failed frame, and fails
//! only one frame on a panic.

mod beat;
pub mod client;
mod deliver;
mod downloads;
mod held;
mod membership;
mod memory;
mod patience;
mod running;
mod shared;
mod slot;
mod stop;
mod watchdog;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use client::Client;
use style::Library;
use wire::messages::RegisterRequest;

use crate::engine::Engine;
use crate::provenance::{CODE_VERSION, cpu_features};
use downloads::{fetch, styles};
use held::Held;
use membership::Membership;
pub use memory::available_bytes;
pub use running::Limits;
use running::Running;
use shared::{Jobs, Scenes, Shared};
use stop::Stop;

/// Time limit for a slot to finish and submit its frame when the worker stops; unfinished frames are released. The whole stop fits
/// in the 10 s that supervisors commonly wait.
const STOP_LIMIT: Duration = Duration::from_secs(8);
/// Finished frames of a slot that may wait for submission. Few, because each holds its pictures.
const WAITING_FRAMES: usize = 2;
/// How often the main thread checks whether to stop.
const LOOK: Duration = Duration::from_millis(50);

/// Options of a worker.
pub struct WorkerOptions {
    /// URL of the service.
    pub server: String,
    /// Bearer token, if the service requires one.
    pub token: Option<String>,
    /// Frames rendered concurrently.
    pub slots: usize,
    /// Shown in the list of workers.
    pub name: String,
    /// The style models.
    pub library: Library,
    /// Path of ONNX Runtime if it is not in a standard location.
    pub onnxruntime: Option<PathBuf>,
    /// Limits on time and memory.
    pub limits: Limits,
}

/// Works until `stop` is set, then releases its leases without counting an attempt. A worker that stops on an error also sets
/// `stop`.
///
/// # Errors
/// The service refuses the worker, or a thread ended by a defect.
pub fn run(options: WorkerOptions, stop: Arc<AtomicBool>) -> anyhow::Result<()> {
    let stop = Stop(stop);
    let engine = Arc::new(Engine::new(options.library, options.onnxruntime.as_deref()));
    let about = RegisterRequest {
        name: options.name,
        slots: u32::try_from(options.slots).context("too many slots")?,
        code_version: CODE_VERSION.to_owned(),
        onnx_runtime: engine.runtime().ok().map(|runtime| runtime.version().to_owned()),
        cpu_features: cpu_features(),
        protocol: wire::VERSION,
    };
    let client = Client::new(&options.server, options.token.as_deref());
    let joined = Membership::join(&client, about, &stop).context("the service refuses this worker")?;
    let Some(membership) = joined else { return Ok(()) };
    tracing::info!(
        server = options.server,
        slots = options.slots,
        worker = membership.worker_id(),
        "worker ready"
    );
    let shared = Arc::new(Shared {
        engine,
        client,
        membership,
        held: Held::default(),
        jobs: Jobs::default(),
        scenes: Scenes::default(),
        stop,
        running: Running::default(),
        limits: options.limits,
    });
    let threads = start(&shared, options.slots)?;
    let defect = watch(&threads, &shared.stop);
    shared.stop.set();
    finish(&shared, &threads.slots);
    if defect {
        bail!("a thread of the worker ended unexpectedly");
    }
    Ok(())
}

/// The threads of a worker.
struct Threads {
    /// Rendering and delivery threads, which end after their frames.
    slots: Vec<JoinHandle<()>>,
    /// The heartbeat thread, which may wait for the service when the worker stops, and the watchdog.
    others: Vec<JoinHandle<()>>,
}

fn start(shared: &Arc<Shared>, slots: usize) -> anyhow::Result<Threads> {
    let spawn = |name: String, body: Box<dyn FnOnce(&Shared) + Send>| {
        let shared = Arc::clone(shared);
        let thread = thread::Builder::new().name(name).spawn(move || body(&shared));
        thread.context("cannot start a thread")
    };
    let mut threads = Threads {
        slots: Vec::new(),
        others: vec![
            spawn("beat".to_owned(), Box::new(beat::run))?,
            spawn("watchdog".to_owned(), Box::new(watchdog::run))?,
        ],
    };
    for slot in 0..slots {
        let (send, finished) = mpsc::sync_channel(WAITING_FRAMES);
        threads.slots.push(spawn(
            format!("render-{slot}"),
            Box::new(move |shared| slot::run(shared, slot, &send)),
        )?);
        threads.slots.push(spawn(
            format!("deliver-{slot}"),
            Box::new(move |shared| deliver::run(shared, &finished)),
        )?);
    }
    Ok(threads)
}

/// Waits until the worker is stopped or a thread has ended; returns whether a thread ended early.
fn watch(threads: &Threads, stop: &Stop) -> bool {
    while !stop.is_set() {
        let mut all = threads.slots.iter().chain(&threads.others);
        if all.any(JoinHandle::is_finished) {
            // If the stop was set in between, the thread ended as requested.
            return !stop.is_set();
        }
        thread::sleep(LOOK);
    }
    false
}

/// Lets the slots finish their frames, then releases the remaining leases. Threads that are still running end with the process; the
/// service rejects their late results.
fn finish(shared: &Shared, threads: &[JoinHandle<()>]) {
    let deadline = Instant::now() + STOP_LIMIT;
    while Instant::now() < deadline && !threads.iter().all(JoinHandle::is_finished) {
        thread::sleep(LOOK);
    }
    for token in shared.held.tokens() {
        if let Err(error) = shared.client.release(token, "the worker is stopping") {
            tracing::warn!(token, %error, "cannot hand a lease back; it will run out");
        }
    }
}
