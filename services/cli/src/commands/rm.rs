//! `fathom rm`: deletes jobs, datasets, scenes and collections of a service.

use std::io::{BufRead, IsTerminal, Write};

use anyhow::Context;
use cli::exit::Failure;
use cli::known::{self, Version};
use cli::remote::{Remote, ServerArguments, encode};
use cli::table::cell;
use serde_json::Value;

/// Options of `fathom rm`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Jobs and datasets to delete with all their images, and scenes that no job uses; of a version such as tour@1 the seal goes,
    /// and its images stay
    #[arg(required_unless_present = "collection", value_name = "JOB|DATASET|SCENE")]
    names: Vec<String>,
    /// A collection to delete; its scenes stay
    #[arg(long, value_name = "NAME")]
    collection: Option<String>,
    /// Delete without asking
    #[arg(long, short)]
    yes: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// What a name stands for.
struct Target {
    path: String,
    /// As the question names it.
    described: String,
}

/// Runs the command. All names are looked up before the first is deleted.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let targets = arguments.names.iter().map(|name| target(&remote, name));
    let mut targets = targets.collect::<Result<Vec<_>, Failure>>()?;
    if let Some(name) = &arguments.collection {
        let scenes = known::collection(&remote, name)?.len();
        targets.push(Target {
            path: format!("/v1/collections/{}", encode(name)),
            described: format!("collection {name} (its {scenes} scenes stay)"),
        });
    }
    for Target { path, described } in &targets {
        if !arguments.yes && !confirmed(described)? {
            println!("kept {described}");
            continue;
        }
        let deleted = remote.delete(path)?;
        println!("deleted {described}");
        if let Some(bytes) = deleted["bytes"].as_u64() {
            println!("{} images, {} MB", cell(&deleted["images"]), bytes / 1_000_000);
        }
    }
    Ok(())
}

fn target(remote: &Remote, name: &str) -> Result<Target, Failure> {
    if known::is_job_id(name) {
        let job = known::job(remote, name)?;
        let progress = format!("{} of {} frames", cell(&job["done"]), cell(&job["frames"]));
        let described = format!(
            "job {name} of dataset {} ({}, {progress})",
            cell(&job["dataset"]),
            cell(&job["state"])
        );
        let path = format!("/v1/jobs/{}", encode(name));
        return Ok(Target { path, described });
    }
    if known::is_scene_id(name) {
        let scene = known::scene(remote, name)?;
        let size = format!("{}×{}", cell(&scene["width"]), cell(&scene["height"]));
        let uploaded = cell(&scene["created_at"]);
        return Ok(Target {
            path: format!("/v1/scenes/{}", encode(name)),
            described: format!("scene {name} ({size}, uploaded {uploaded})"),
        });
    }
    let dataset = known::dataset(remote, name)?;
    if let Some(Version { dataset: of, number }) = known::version(name) {
        let images = cell(&dataset["images"]);
        return Ok(Target {
            path: format!("/v1/datasets/{}/versions/{number}", encode(of)),
            described: format!("the seal of {name} (its {images} images stay)"),
        });
    }
    let count = |name: &str| dataset.get(name).and_then(Value::as_u64).unwrap_or_default();
    Ok(Target {
        path: format!("/v1/datasets/{}", encode(name)),
        described: format!(
            "dataset {name} ({} jobs, {} images, {} MB)",
            count("jobs"),
            count("images"),
            count("bytes") / 1_000_000
        ),
    })
}

fn confirmed(described: &str) -> Result<bool, Failure> {
    if !std::io::stdin().is_terminal() {
        let message =
            "nobody can be asked, since standard input is not a terminal; --yes deletes without asking";
        return Err(Failure::input(message));
    }
    let mut out = std::io::stderr();
    let asked = write!(out, "delete {described} for good? [y/N] ").and_then(|()| out.flush());
    asked.context("cannot ask")?;
    let mut answer = String::new();
    let read = std::io::stdin().lock().read_line(&mut answer);
    read.context("cannot read the answer")?;
    Ok(matches!(answer.trim(), "y" | "Y" | "yes"))
}
