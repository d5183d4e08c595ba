//! `fathom render` into a set: renders the selected shards that are not done, one after the other.

use std::ffi::OsString;
use std::hash::{BuildHasher, RandomState};
use std::time::{Duration, Instant};

use cli::exit::Failure;
use cli::plural::count;
use cli::progress::Progress;
use cli::render::{Arguments, LimitArguments, SetArguments};
use cli::signals::stop_at_signal;
use cli::styles::StyleArguments;
use sets::{Crew, Location, NewSet, Outcome, Recipe, Selection, Set, Watch, allow_work, run_shard};

use super::dispatch;
use super::failure::failure;
use super::tally::Tally;
use crate::program::own_program;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (job, _engine) = arguments.prepare()?;
    if let Some(id) = job.uploaded_scene_ids().first() {
        return Err(Failure::BadInput(format!(
            "scene `{id}` was uploaded to a service; a set needs procedural scenes or files that every machine has"
        )));
    }
    let out = arguments
        .out
        .to_str()
        .ok_or_else(|| Failure::input("--out is not UTF-8"))?;
    let location = Location::parse(out).map_err(failure)?;
    let SetArguments { shard, frames, .. } = &arguments.set;
    let selection = Selection::parse(shard.as_deref(), frames.as_deref()).map_err(failure)?;
    let new = NewSet {
        job: &job,
        frames_per_shard: arguments.set.frames_per_shard,
        parts: selection.part.map_or(1, |part| part.parts),
        code_version: renderer::CODE_VERSION,
        metrics: cli::job::metrics(&job),
    };
    let set = Set::begin(&location, &new).map_err(failure)?;
    let tally = match &arguments.set.engine.engine {
        Some(engine) => dispatch::run(&arguments.set, engine, &set, &selection)?,
        None => render(arguments, &set, &selection)?,
    };
    report(&set, &selection, &tally)
}

fn render(arguments: &Arguments, set: &Set, selection: &Selection) -> Result<Tally, Failure> {
    let mut tally = Tally {
        begun: Instant::now(),
        frames: 0,
        shards: 0,
    };
    let mut missing = selection.missing(set).map_err(failure)?;
    // Each process uses another order. Otherwise processes that share a set without --shard would keep rendering the same shards.
    let order = RandomState::new();
    missing.sort_by_cached_key(|shard| order.hash_one(shard));
    let frames_of = |shard: u64| set.card().frames_of(shard).count() as u64;
    let mut progress = Progress::new(
        "render",
        "frames",
        missing.iter().map(|&shard| frames_of(shard)).sum(),
    );
    let every = Duration::from_secs_f64(arguments.set.state_interval_s);
    let watch = Watch::start(set, every, stop_at_signal()?);
    let mut crew = Crew::new(
        recipe(&arguments.style, arguments.slots(), &arguments.set.limits)?,
        set.job().map_err(failure)?,
    );
    let mut passed = 0;
    for shard in missing {
        set.state().and_then(allow_work).map_err(failure)?;
        let outcome = run_shard(set, shard, &mut crew, &|| watch.check()).map_err(failure)?;
        if let Outcome::Committed(marker) = outcome {
            tally.shards += 1;
            tally.frames += marker.images;
        }
        passed += frames_of(shard);
        progress.set(passed);
    }
    progress.finish();
    Ok(tally)
}

/// The recipe for rendering frames in a child process of this program.
pub(crate) fn recipe(
    style: &StyleArguments,
    slots: usize,
    limits: &LimitArguments,
) -> Result<Recipe, Failure> {
    let program = own_program()?;
    let mut arguments: Vec<OsString> = vec!["child".into(), "frames".into()];
    for (option, value) in [("--styles", &style.styles), ("--onnxruntime", &style.onnxruntime)] {
        if let Some(value) = value {
            arguments.extend([option.into(), value.into()]);
        }
    }
    let limits = limits.limits();
    Ok(Recipe {
        program,
        arguments,
        slots,
        frame_limit: limits.frame,
        memory_limit_bytes: limits.memory_bytes,
    })
}

/// Prints the state of the selected shards, and of the whole set if it is complete.
fn report(set: &Set, selection: &Selection, tally: &Tally) -> Result<(), Failure> {
    let seconds = tally.begun.elapsed().as_secs_f64();
    println!(
        "{} with {} in {seconds:.1} s ({:.2} frames/s) in {}",
        count(tally.shards, "shard"),
        count(tally.frames, "frame"),
        tally.frames as f64 / seconds.max(1e-9),
        set.location()
    );
    let all = set.card().shards();
    let done = set.done().map_err(failure)?.len() as u64;
    if done == all {
        println!("digest {}", set.digest().map_err(failure)?);
    } else {
        println!("{done} of {all} shards are done");
    }
    let failed = set.failed_frames(selection).map_err(failure)?;
    if failed.is_empty() {
        return Ok(());
    }
    for frame in &failed {
        eprintln!("frame {}: {}", frame.frame, frame.error);
    }
    Err(Failure::SomeFrames {
        failed: failed.len() as u64,
        frames: set.card().frames,
        hint: format!("; the markers in {} list them", set.location()),
    })
}
