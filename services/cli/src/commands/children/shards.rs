//! `fathom child shards`: reads a set for a service that imports it, in the format of `api`'s feed.

use std::io::{BufRead, stdin};

use anyhow::Context;
use api::{Known, Line, SetHead};
use cli::exit::Failure;
use sets::{Location, Set};

use crate::commands::children::lines::{line, write};
use crate::commands::sharded::failure::failure;
use crate::commands::sharded::open::resolved;
use crate::commands::sharded::reading::{missing, read_all};

/// Options of `fathom child shards`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The set, named by a client of the service and not trusted
    set: String,
    /// Stores that may contain the set
    #[arg(long, value_name = "DIR|URL", required = true)]
    below: Vec<String>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let location = permitted(&arguments.set, &arguments.below)?;
    let set = Set::open(&location).map_err(failure)?;
    let head = SetHead {
        location: location.to_string(),
        job: set.card().job.clone(),
        dataset: set.card().dataset(),
        frames: set.card().frames,
    };
    write(&line(&Line::Set(head))?)?;
    let mut known = String::new();
    stdin()
        .lock()
        .read_line(&mut known)
        .context("cannot read the known shards")?;
    if known.is_empty() {
        // The reader only needs the head.
        return Ok(());
    }
    let known: Known = serde_json::from_str(&known).context("the known shards are malformed")?;
    let missing = missing(&set, &known)?;
    read_all(
        &set,
        &missing,
        |part| line(&Line::Part(part)),
        |line| write(&line),
    )
}

/// The canonical location of the set if it is inside one of the stores. Others are refused without checking whether they exist.
fn permitted(set: &str, stores: &[String]) -> Result<Location, Failure> {
    let refused = || Failure::input(format!("{set} does not lie in a store of this service"));
    let named = Location::parse(set)
        .and_then(Location::absolute)
        .map_err(failure)?;
    let mut found = None;
    for store in stores {
        let store = Location::parse(store)
            .and_then(Location::absolute)
            .map_err(failure)?;
        // The written form is checked first, so that no path outside the stores is accessed; then links are resolved.
        if store.contains(&named) {
            found = Some((resolved(&store)?, resolved(&named)?));
            break;
        }
    }
    match found {
        Some((store, set)) if store.contains(&set) => Ok(set),
        _ => Err(refused()),
    }
}
