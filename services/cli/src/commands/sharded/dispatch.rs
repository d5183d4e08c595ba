//! `fathom render --engine`: distributes the shards of a set to the workers of a broker.
//!
//! The broker holds a few shards for each slot of the fleet and never the whole set, so that a pause or a cancellation takes effect
//! immediately. Its content is computed from the store in every round.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use cli::exit::Failure;
use cli::progress::Progress;
use cli::render::SetArguments;
use cli::signals::stop_at_signal;
use sets::{Selection, Set, allow_work};
use spec::SetState;

use super::engine::{Broker, BrokerError, Task};
use super::failure::failure;
use super::tally::Tally;

/// Shortest interval between two listings of the store.
const LOOK: Duration = Duration::from_secs(1);
/// Inverse of the largest share of time spent on listing the store.
const LOOK_SHARE: u32 = 20;
/// A shard without a marker after this time is published again, in case the broker has lost it.
const PUBLISH_AGAIN: Duration = Duration::from_secs(60);
const SHARDS_PER_SLOT: u64 = 4;
/// Minimum number of waiting shards, even without workers.
const LEAST_WINDOW: u64 = 8;

/// Publishes missing shards until all are done.
pub(crate) fn run(
    arguments: &SetArguments,
    engine: &str,
    set: &Set,
    selection: &Selection,
) -> Result<Tally, Failure> {
    let broker = Broker::connect(&arguments.engine, engine)?;
    let place = set.location().clone().absolute().map_err(failure)?.to_string();
    let mut window = Window::new(&place, arguments.window);
    let mut patience = Patience::default();
    let stop = stop_at_signal()?;
    let frames_of = |shards: &[u64]| -> u64 {
        shards
            .iter()
            .map(|&shard: &u64| set.card().frames_of(shard).count() as u64)
            .sum()
    };
    let begun = Instant::now();
    let first = selection.missing(set).map_err(failure)?;
    let mut missing = first.clone();
    let mut progress = Progress::new("render", "frames", frames_of(&first));
    while !missing.is_empty() {
        let state = set.state().map_err(failure)?;
        if state == SetState::Cancelled || stop.load(Ordering::SeqCst) {
            // Remaining messages are harmless: workers check the state themselves.
            let _ = broker.withdraw(&place);
            allow_work(state).map_err(failure)?;
            return Err(Failure::Later(
                "stopped; run the command again to continue".to_owned(),
            ));
        }
        if state == SetState::Running {
            patience.judge(window.fill(&broker, &missing));
        }
        let looked = Instant::now();
        missing = selection.missing(set).map_err(failure)?;
        progress.set(frames_of(&first) - frames_of(&missing));
        if !missing.is_empty() {
            thread::sleep(LOOK.max(looked.elapsed() * LOOK_SHARE));
        }
    }
    progress.finish();
    Ok(Tally {
        begun,
        frames: frames_of(&first),
        shards: first.len(),
    })
}

/// The shards that the broker should hold.
pub(crate) struct Window {
    /// The user's limit of waiting shards.
    size: Option<u64>,
    set: String,
    published: BTreeMap<u64, Instant>,
}

impl Window {
    pub(crate) fn new(set: &str, size: Option<u64>) -> Self {
        Self {
            size,
            set: set.to_owned(),
            published: BTreeMap::new(),
        }
    }

    /// Publishes missing shards up to the limit.
    pub(crate) fn fill(&mut self, broker: &Broker, missing: &[u64]) -> Result<(), BrokerError> {
        let waiting = broker.waiting()?;
        if waiting == 0 {
            // All published shards were rendered, or the broker lost its messages.
            self.published.clear();
        }
        let size = match self.size {
            Some(size) => size,
            None => fitting(broker)?,
        };
        let mut room = size.saturating_sub(waiting);
        for &shard in missing {
            if room == 0 {
                break;
            }
            let age = self.published.get(&shard).map(Instant::elapsed);
            if age.is_some_and(|age| age < PUBLISH_AGAIN) {
                continue;
            }
            let task = Task {
                set: self.set.clone(),
                shard,
            };
            if broker.publish(&task)? {
                room -= 1;
            }
            self.published.insert(shard, Instant::now());
        }
        Ok(())
    }
}

/// A window that fits the fleet.
fn fitting(broker: &Broker) -> Result<u64, BrokerError> {
    let members = broker.fleet().members()?;
    let slots: u64 = members.iter().map(|member| member.slots).sum();
    Ok(LEAST_WINDOW.max(SHARDS_PER_SLOT.saturating_mul(slots)))
}

/// Reports once that the broker is unavailable, and once that it is back.
#[derive(Default)]
pub(crate) struct Patience {
    is_away: bool,
}

impl Patience {
    pub(crate) fn judge<T>(&mut self, result: Result<T, BrokerError>) -> Option<T> {
        match result {
            Ok(value) => {
                if std::mem::take(&mut self.is_away) {
                    eprintln!("the broker is back");
                }
                Some(value)
            }
            Err(error) => {
                self.wait(&error.to_string());
                None
            }
        }
    }

    /// Prints why the work cannot continue, unless it is the last printed reason.
    pub(crate) fn wait(&mut self, reason: &str) {
        if !std::mem::replace(&mut self.is_away, true) {
            eprintln!("{reason}; going on when it is back");
        }
    }
}
