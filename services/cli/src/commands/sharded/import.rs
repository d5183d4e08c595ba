//! `fathom import`: the images of a set in the data folder of a service, without their bytes.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use anyhow::Context;
use api::{Data, Intake, SetHead};
use catalogue::{CatalogueError, JobRow, UnixMs};
use cli::exit::Failure;
use cli::import::Arguments;
use cli::plural::count;
use cli::progress::Progress;
use serde_json::json;
use sets::{Location, Set};
use tokio::runtime::Runtime;

use super::failure::failure;
use super::open::resolved;
use super::reading::{missing, read_all};

/// The counts of an import.
#[derive(Debug, Default)]
struct Tally {
    shards: u64,
    /// Images that were not there before.
    images: u64,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let location = resolved(&Location::parse(&arguments.set).map_err(failure)?)?;
    let set = Set::open(&location).map_err(failure)?;
    let library = arguments.style.library_of_service(&arguments.data)?;
    let vocabulary = renderer::vocabulary(&library, true);
    let runtime = Runtime::new().context("cannot start the asynchronous runtime")?;
    let data = runtime.block_on(Data::open(&arguments.data, &vocabulary.metrics));
    let data = data.map_err(Failure::input)?;
    let head = SetHead {
        location: location.to_string(),
        job: set.card().job.clone(),
        dataset: set.card().dataset(),
        frames: set.card().frames,
    };
    let begun = Instant::now();
    let imported = runtime
        .block_on(Intake::open(&data.catalogue, head, &vocabulary))
        .map_err(Failure::input)
        .and_then(|intake| import(&set, &data, intake, &runtime));
    runtime.block_on(data.close());
    let (job, tally) = imported?;
    print(arguments.json, &job, &tally, begun.elapsed().as_secs_f64());
    Ok(())
}

fn import(
    set: &Set,
    data: &Data,
    mut intake: Intake<'_>,
    runtime: &Runtime,
) -> Result<(JobRow, Tally), Failure> {
    let known = runtime.block_on(intake.known()).map_err(stored)?;
    let missing = missing(set, &known)?;
    let (mut tally, mut bar, mut storing) = (Tally::default(), None, None);
    let (id, job) = (intake.id().to_owned(), intake.job());
    read_all(
        set,
        &missing,
        |part| {
            let images = api::prepare(&data.catalogue, &id, &job, part.images).map_err(Failure::input)?;
            Ok((images, part.shard))
        },
        |(images, shard)| {
            // Stored with the first valid shard, so that a set without one leaves no job.
            if !intake.is_there() {
                runtime.block_on(intake.begin(now())).map_err(stored)?;
            }
            tally.shards += u64::from(shard.end.is_some());
            let storing = storing.get_or_insert_with(|| intake.storing());
            runtime.block_on(storing.store(images, shard)).map_err(stored)?;
            bar.get_or_insert_with(|| Progress::new("import", "shards", missing.len() as u64))
                .set(tally.shards);
            Ok(())
        },
    )?;
    if let Some(storing) = storing {
        tally.images = runtime.block_on(storing.finish()).map_err(stored)?;
    }
    if let Some(bar) = bar {
        bar.finish();
    }
    let row = runtime.block_on(intake.begin(now())).map_err(stored)?;
    Ok((row, tally))
}

fn print(as_json: bool, job: &JobRow, tally: &Tally, seconds: f64) {
    let Tally { shards, images } = tally;
    if as_json {
        println!(
            "{}",
            json!({"job": job, "shards": shards, "images": images, "seconds": seconds})
        );
        return;
    }
    let rate = *images as f64 / seconds.max(1e-9);
    println!(
        "{} with {} in {seconds:.1} s ({rate:.0} images/s)",
        count(*shards, "shard"),
        count(*images, "image")
    );
    println!(
        "{} · dataset {} · {} · {} of {} frames, {} failed",
        job.id, job.dataset, job.state, job.done, job.frames, job.failed
    );
    if let Some(digest) = &job.digest {
        println!("digest {digest}");
    }
}

fn stored(error: CatalogueError) -> Failure {
    Failure::Other(error.into())
}

fn now() -> UnixMs {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    UnixMs(since.map_or(0, |since| since.as_millis() as u64))
}
