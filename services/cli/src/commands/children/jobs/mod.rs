//! `fathom child jobs`: requests of a service to its shared store and to the broker.

mod request;
mod watch;

use std::io::{Read, stdin};

use anyhow::Context;
use api::{Accepted, Order};
use cli::exit::Failure;
use sets::{Location, NewSet, Set, SetError, Submission};
use spec::{Job, SetState};

use crate::commands::sharded::failure::failure;
use crate::commands::sharded::open::open;
use request::{send, shared};

/// Preferred number of shards of a job, within the limits on their size.
const SHARDS: u64 = 100;
const LEAST_FRAMES: u64 = 10;
const MOST_FRAMES: u64 = 500;

/// Options of `fathom child jobs`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Begin the set of the job that standard input describes
    Submit { store: String },
    /// Change the state of a set to the one in standard input
    State { set: String },
    /// Have the shards with failed frames rendered again
    Retry { set: String },
    /// Cancel a set and hide it from services
    Retire { set: String },
    /// Print the progress of the sets of a store, and send their missing shards to a broker
    Watch(watch::Arguments),
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.action {
        Action::Submit { store } => submit(store),
        Action::State { set } => {
            let state: SetState = serde_json::from_reader(stdin().lock()).map_err(Failure::input)?;
            open(set)?.set_state(state).map_err(failure)
        }
        Action::Retry { set } => open(set)?.retry_failed().map(drop).map_err(failure),
        Action::Retire { set } => retire(set),
        Action::Watch(arguments) => watch::run(arguments),
    }
}

fn submit(store: &str) -> Result<(), Failure> {
    let mut text = String::new();
    stdin()
        .read_to_string(&mut text)
        .context("cannot read the order")?;
    let order: Order = serde_json::from_str(&text).map_err(Failure::input)?;
    let job = Job::from_canonical(&order.job).map_err(Failure::input)?;
    let new = NewSet {
        job: &job,
        frames_per_shard: Some((job.frames() / SHARDS).clamp(LEAST_FRAMES, MOST_FRAMES)),
        parts: 1,
        code_version: renderer::CODE_VERSION,
        metrics: cli::job::metrics(&job),
    };
    let submitted = shared(store)?.submit(&order.id, order.key.as_deref(), &new);
    let accepted = match submitted.map_err(failure)? {
        Submission::KeyConflict => Accepted::KeyConflict,
        Submission::Set { id, set } => Accepted::Job {
            id,
            location: set.location().to_string(),
        },
    };
    send(&accepted)
}

/// Hides a set. An already hidden set is not an error: the service may have been killed before it recorded the change.
fn retire(set: &str) -> Result<(), Failure> {
    match Set::open(&Location::parse(set).map_err(failure)?) {
        Ok(set) => set.retire().map_err(failure),
        Err(SetError::Refused(_)) => Ok(()),
        Err(error) => Err(failure(error)),
    }
}
