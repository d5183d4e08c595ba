//! `fathom child jobs watch`: reports the progress of the sets of a store to a service, and sends missing shards to a broker. Any
//! number of processes may watch the same store: the broker drops duplicates.

use std::collections::BTreeMap;
use std::io::{Read, stdin};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use api::{Event, SeenSet};
use cli::engine::EngineArguments;
use cli::exit::Failure;
use sets::{DoneShard, JobStore, Set, SetError};
use spec::SetState;

use super::request::{send, shared};
use crate::commands::sharded::dispatch::{Patience, Window};
use crate::commands::sharded::engine::Broker;

/// Interval between two rounds.
const ROUND: Duration = Duration::from_millis(500);
/// Shortest interval between two listings of a set.
const LOOK: Duration = Duration::from_secs(1);
/// Inverse of the largest share of time spent on listing a set.
const LOOK_SHARE: u32 = 20;
/// The interval for a set that is complete, paused or cancelled; another service may change that.
const LOOK_DONE: Duration = Duration::from_secs(3);
/// Pause before an unreadable set is tried again.
const LOOK_FAILED: Duration = Duration::from_secs(15);
/// Interval for repeating unchanged progress, in case the service missed it.
const REPORT_INTERVAL: Duration = Duration::from_secs(60);
/// Interval between two lists of workers, and between two attempts to reach the broker.
const WORKERS: Duration = Duration::from_secs(2);

/// Options of `fathom child jobs watch`.
#[derive(clap::Args)]
pub(super) struct Arguments {
    store: String,
    #[command(flatten)]
    engine: EngineArguments,
}

/// Watches until standard input closes, which happens whenever the service ends.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let url = arguments.engine.engine.as_deref();
    let url = url.ok_or_else(|| Failure::input("`--engine` is missing: the broker to fill"))?;
    let store = shared(&arguments.store)?;
    let ended = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&ended);
    thread::spawn(move || {
        let _ = stdin().read_to_end(&mut Vec::new());
        end.store(true, Ordering::SeqCst);
    });
    let mut watch = Watch {
        store,
        sets: BTreeMap::new(),
        broker: None,
        patience: Patience::default(),
        workers_due: Instant::now(),
    };
    while !ended.load(Ordering::SeqCst) {
        watch.reach_broker(&arguments.engine, url)?;
        watch.round()?;
        thread::sleep(ROUND);
    }
    Ok(())
}

struct Watch {
    store: JobStore,
    sets: BTreeMap<String, Watched>,
    /// `None` while it cannot be reached; progress is reported even then.
    broker: Option<Broker>,
    patience: Patience,
    workers_due: Instant,
}

/// A set of the store.
struct Watched {
    set: Option<Set>,
    window: Option<Window>,
    due: Instant,
    reported: Option<(SeenSet, Instant)>,
    /// The last failure, so that it is printed once.
    failure: Option<String>,
}

impl Watch {
    fn reach_broker(&mut self, arguments: &EngineArguments, url: &str) -> Result<(), Failure> {
        if self.workers_due > Instant::now() {
            return Ok(());
        }
        self.workers_due = Instant::now() + WORKERS;
        match &self.broker {
            Some(broker) => {
                if let Some(workers) = self.patience.judge(broker.fleet().workers()) {
                    send(&Event::Workers(workers))?;
                }
            }
            None => match Broker::connect(arguments, url) {
                Ok(broker) => self.broker = Some(broker),
                Err(Failure::Later(reason)) => self.patience.wait(&reason),
                Err(error) => return Err(error),
            },
        }
        Ok(())
    }

    fn round(&mut self) -> Result<(), Failure> {
        match self.store.ids() {
            Ok(ids) => {
                self.sets.retain(|id, _| ids.contains(id));
                for id in ids {
                    self.sets.entry(id).or_insert_with(Watched::new);
                }
            }
            Err(error) => {
                eprintln!("{error}");
                thread::sleep(LOOK);
            }
        }
        for (id, watched) in &mut self.sets {
            if watched.due > Instant::now() {
                continue;
            }
            let begun = Instant::now();
            match watched.look(id, &self.store) {
                Ok((seen, missing)) => {
                    watched.failure = None;
                    let is_running = seen.state == SetState::Running && !missing.is_empty();
                    let pause = if is_running { LOOK } else { LOOK_DONE };
                    if let Some(broker) = &self.broker {
                        self.patience.judge(watched.dispatch(broker, &seen, &missing));
                    }
                    watched.report(seen)?;
                    watched.due = Instant::now() + pause.max(begun.elapsed() * LOOK_SHARE);
                }
                Err(error) => watched.fail(id, &error),
            }
        }
        Ok(())
    }
}

impl Watched {
    fn new() -> Self {
        Self {
            set: None,
            window: None,
            due: Instant::now(),
            reported: None,
            failure: None,
        }
    }

    /// The progress of the set, and its missing shards.
    fn look(&mut self, id: &str, store: &JobStore) -> Result<(SeenSet, Vec<u64>), SetError> {
        let set = match self.set.take() {
            Some(set) => set,
            None => Set::open(&store.location_of(id))?,
        };
        let (state, done) = (set.state()?, set.done_shards()?);
        if state == SetState::Cancelled {
            // The set of a deleted job is cancelled before it is hidden. Opening it fails once it is hidden.
            Set::open(set.location())?;
        }
        let seen = SeenSet {
            id: id.to_owned(),
            location: set.location().to_string(),
            state,
            done: done.len() as u64,
            changed_ms: done.iter().map(|shard| shard.changed_ms).max().unwrap_or(0),
        };
        let missing = missing(set.card().shards(), &done);
        self.set = Some(set);
        Ok((seen, missing))
    }

    fn dispatch(
        &mut self,
        broker: &Broker,
        seen: &SeenSet,
        missing: &[u64],
    ) -> Result<(), crate::commands::sharded::engine::BrokerError> {
        if seen.state == SetState::Running {
            let window = self
                .window
                .get_or_insert_with(|| Window::new(&seen.location, None));
            return window.fill(broker, missing);
        }
        // Workers finish or drop their shards, depending on the state; waiting shards are withdrawn.
        match self.window.take() {
            Some(_) => broker.withdraw(&seen.location),
            None => Ok(()),
        }
    }

    fn report(&mut self, seen: SeenSet) -> Result<(), Failure> {
        let is_known =
            |(reported, at): &(SeenSet, Instant)| *reported == seen && at.elapsed() < REPORT_INTERVAL;
        if self.reported.as_ref().is_some_and(is_known) {
            return Ok(());
        }
        send(&Event::Set(seen.clone()))?;
        self.reported = Some((seen, Instant::now()));
        Ok(())
    }

    fn fail(&mut self, id: &str, error: &SetError) {
        let text = error.to_string();
        // A folder without a job belongs to a deleted one, or to one that is being created.
        let is_hidden = self.set.is_none() && matches!(error, SetError::Refused(_));
        if !is_hidden && self.failure.as_ref() != Some(&text) {
            eprintln!("{id}: {text}");
        }
        self.failure = Some(text);
        let pause = if self.reported.is_none() && is_hidden {
            LOOK_DONE
        } else {
            LOOK_FAILED
        };
        self.due = Instant::now() + pause;
    }
}

/// The shards that are not done.
fn missing(shards: u64, done: &[DoneShard]) -> Vec<u64> {
    let mut done = done.iter().map(|done| done.shard).peekable();
    (0..shards)
        .filter(|shard| done.next_if_eq(shard).is_none())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_what_has_no_marker() {
        let done = |shards: &[u64]| -> Vec<DoneShard> {
            shards
                .iter()
                .map(|&shard| DoneShard { shard, changed_ms: 1 })
                .collect()
        };
        assert_eq!(missing(4, &done(&[])), [0, 1, 2, 3]);
        assert_eq!(missing(4, &done(&[1, 2])), [0, 3]);
        assert!(missing(4, &done(&[0, 1, 2, 3])).is_empty());
    }
}
