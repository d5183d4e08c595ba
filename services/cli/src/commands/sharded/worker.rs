//! `fathom worker --engine`: renders shards from a broker until it is stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use cli::exit::Failure;
use cli::signals::stop_at_signal;
use cli::worker::Arguments;
use sets::{Crew, Location, Outcome, Recipe, Set, SetError, Watch, allow_work, run_shard};
use spec::SetState;

use super::dispatch::Patience;
use super::engine::{Broker, Delivery, Fleet, Member, Task, Verdict};
use super::failure::failure;
use super::render;

/// Maximum duration of a poll for work; signals are checked between polls.
const QUESTION: Duration = Duration::from_secs(5);
/// Pause after a failure of the broker.
const PAUSE: Duration = Duration::from_secs(1);
/// Delay before retrying a shard whose set is paused or whose store does not respond.
const AGAIN_SOON: Duration = Duration::from_secs(15);
/// Delay before retrying a shard that this worker cannot render; another worker may.
const AGAIN_LATER: Duration = Duration::from_secs(60);
/// How often the state of a set is checked.
const STATE_INTERVAL: Duration = Duration::from_secs(15);
/// Shortest time between two renewals of a worker's entry.
const LEAST_RENEWAL: Duration = Duration::from_secs(1);
/// Renewals of an entry in the fleet before it would expire.
const RENEWALS: u32 = 4;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let engine = arguments.engine.engine.as_deref();
    let engine = engine.ok_or_else(|| Failure::input("`--engine` is missing: the broker of the shards"))?;
    let store = arguments.store.as_deref();
    let store = store.ok_or_else(|| Failure::input("`--store` is missing: the store of the sets"))?;
    let store = Location::parse(store)
        .and_then(Location::absolute)
        .map_err(failure)?;
    let slots = usize::from(arguments.slots);
    let broker = Broker::connect(&arguments.engine, engine)?;
    let stop = stop_at_signal()?;
    let library = arguments.style.library()?;
    let renderer = renderer::Engine::new(library, arguments.style.onnxruntime.as_deref());
    let member = Member {
        name: arguments.name(),
        slots: slots as u64,
        frames: 0,
        code_version: renderer::CODE_VERSION.to_owned(),
        onnx_runtime: renderer
            .runtime()
            .ok()
            .map(|runtime| runtime.version().to_string()),
        cpu_features: renderer::cpu_features(),
    };
    drop(renderer);
    let ended = Arc::new(AtomicBool::new(false));
    let frames = Arc::new(AtomicU64::new(0));
    let entry = Entry {
        member,
        frames: Arc::clone(&frames),
        every: broker.lease() / RENEWALS,
    };
    let renewal = keep_listed(broker.fleet(), entry, &ended);
    let mut worker = Worker {
        store,
        recipe: render::recipe(&arguments.style, slots, &arguments.limits)?,
        current: None,
        frames,
        patience: Patience::default(),
        stop,
    };
    let result = worker.work(&broker);
    ended.store(true, Ordering::SeqCst);
    let _ = renewal.join();
    result
}

/// A worker's entry in the fleet and its renewal interval.
struct Entry {
    member: Member,
    /// Frames of the current shard.
    frames: Arc<AtomicU64>,
    every: Duration,
}

/// Keeps a worker listed while it lives.
fn keep_listed(fleet: Fleet, entry: Entry, ended: &Arc<AtomicBool>) -> thread::JoinHandle<()> {
    /// Poll interval, which bounds the delay of the end of the worker.
    const STEP: Duration = Duration::from_millis(100);
    let ended = Arc::clone(ended);
    let Entry {
        mut member,
        frames,
        every,
    } = entry;
    thread::spawn(move || {
        let mut since = every;
        while !ended.load(Ordering::SeqCst) {
            let now = frames.load(Ordering::Relaxed);
            if since >= every || (now != member.frames && since >= LEAST_RENEWAL) {
                member.frames = now;
                // The broker may be unavailable.
                let _ = fleet.enter(&member);
                since = Duration::ZERO;
            }
            thread::sleep(STEP);
            since += STEP;
        }
        // The entry expires if the broker is unavailable.
        let _ = fleet.leave(&member.name);
    })
}

struct Worker {
    store: Location,
    recipe: Recipe,
    /// The set of the last shard; the next shard is usually from the same set.
    current: Option<Current>,
    patience: Patience,
    /// Frames of the current shard.
    frames: Arc<AtomicU64>,
    stop: Arc<AtomicBool>,
}

/// The set in work.
struct Current {
    name: String,
    set: Set,
    crew: Crew,
    watch: Watch,
}

impl Worker {
    fn work(&mut self, broker: &Broker) -> Result<(), Failure> {
        while !self.stop.load(Ordering::SeqCst) {
            match self.patience.judge(broker.next(QUESTION)) {
                Some(Some(delivery)) => self.take(delivery)?,
                Some(None) => {}
                None => thread::sleep(PAUSE),
            }
        }
        Ok(())
    }

    /// Renders the shard of a message and reports the verdict to the broker.
    fn take(&mut self, delivery: Delivery) -> Result<(), Failure> {
        let Some(task) = delivery.task() else {
            eprintln!("a message without a shard is dropped");
            self.patience.judge(delivery.settle(Verdict::Hopeless));
            return Ok(());
        };
        let result = self.render(&task);
        let settled = delivery.settle(self.verdict(&result));
        self.patience.judge(settled);
        match result {
            Ok(Outcome::Committed(marker)) => {
                let failed = marker.failed.len();
                println!(
                    "shard {} of {}: {} frames, {failed} failed",
                    task.shard, task.set, marker.images
                );
            }
            Ok(Outcome::Done | Outcome::Beaten) => {}
            Err(SetError::Machine(reason)) => return Err(Failure::Other(anyhow::Error::msg(reason))),
            Err(error) => eprintln!("shard {} of {}: {error}", task.shard, task.set),
        }
        Ok(())
    }

    fn render(&mut self, task: &Task) -> Result<Outcome, SetError> {
        let mut current = match self.current.take().filter(|current| current.name == task.set) {
            Some(current) => current,
            None => self.open(task)?,
        };
        if task.shard >= current.set.card().shards() {
            return Err(SetError::Refused(format!(
                "the set has {} shards",
                current.set.card().shards()
            )));
        }
        allow_work(current.set.state()?)?;
        let watch = &current.watch;
        let frames = current.set.card().frames_of(task.shard);
        self.frames.store(frames.end - frames.start, Ordering::Relaxed);
        let outcome = run_shard(&current.set, task.shard, &mut current.crew, &|| watch.check());
        self.frames.store(0, Ordering::Relaxed);
        self.current = Some(current);
        outcome
    }

    fn open(&self, task: &Task) -> Result<Current, SetError> {
        let location = Location::parse(&task.set)?;
        if !self.store.contains(&location) {
            return Err(SetError::Refused(format!("it does not lie in {}", self.store)));
        }
        let set = Set::open(&location)?;
        let version = &set.card().code_version;
        if version != renderer::CODE_VERSION {
            return Err(SetError::Refused(format!(
                "it was begun by version {version}, this is {}: frames could differ",
                renderer::CODE_VERSION
            )));
        }
        Ok(Current {
            name: task.set.clone(),
            crew: Crew::new(self.recipe.clone(), set.job()?),
            watch: Watch::start(&set, STATE_INTERVAL, Arc::clone(&self.stop)),
            set,
        })
    }

    fn verdict(&self, result: &Result<Outcome, SetError>) -> Verdict {
        let is_cancelled = || {
            let state = self.current.as_ref().map(|current| current.set.state());
            matches!(state, Some(Ok(SetState::Cancelled)))
        };
        match result {
            Ok(_) => Verdict::Done,
            Err(SetError::Later(_)) if self.stop.load(Ordering::SeqCst) => Verdict::Again(Duration::ZERO),
            Err(SetError::Later(_)) => Verdict::Again(AGAIN_SOON),
            Err(SetError::Refused(_)) if is_cancelled() => Verdict::Done,
            Err(SetError::Refused(_) | SetError::Machine(_)) => Verdict::Again(AGAIN_LATER),
            Err(SetError::Damaged(_)) => Verdict::Hopeless,
        }
    }
}
