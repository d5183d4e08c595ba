//! `fathom rm`: deletes jobs, datasets, scenes and collections of a service.

use std::io::{BufRead, IsTerminal, Write};

use anyhow::Context;
use cli::exit::Failure;
use cli::known::{self, Version};
use cli::plural::{count, describe_bytes};
use cli::remote::ServerArguments;
use client::{Client, DatasetRow, Deleted, JobRow, SceneView, encode};

/// Options of `fathom rm`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Jobs and datasets to delete with all their images, scenes that no job uses, and versions such as tour@1, whose images
    /// stay
    #[arg(required_unless_present = "collection", value_name = "JOB|DATASET|SCENE")]
    names: Vec<String>,
    /// A collection to delete; its scenes stay
    #[arg(long, value_name = "NAME")]
    collection: Option<String>,
    /// Delete without confirmation
    #[arg(long, short)]
    yes: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Something to delete.
struct Target {
    path: String,
    /// The text of the question to the user.
    described: String,
}

/// Runs the command. All names are looked up before the first is deleted.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let targets = arguments.names.iter().map(|name| target(&client, name));
    let mut targets = targets.collect::<Result<Vec<_>, Failure>>()?;
    if let Some(name) = &arguments.collection {
        let scenes = known::collection(&client, name)?.len();
        targets.push(Target {
            path: format!("/v1/collections/{}", encode(name)),
            described: format!("collection {name} (its {} stay)", count(scenes, "scene")),
        });
    }
    for Target { path, described } in &targets {
        if !arguments.yes && !confirmed(described)? {
            println!("kept {described}");
            continue;
        }
        let deleted: Option<Deleted> = client.delete(path)?;
        println!("deleted {described}");
        if let Some(Deleted { images, bytes, .. }) = deleted {
            println!("{}, {}", count(images, "image"), describe_bytes(bytes as f64));
        }
    }
    Ok(())
}

fn target(client: &Client, name: &str) -> Result<Target, Failure> {
    // A dataset may have a name that begins like an id.
    if known::is_job_id(name) || (name.starts_with("job_") && client.dataset(name)?.is_none()) {
        let JobRow {
            id,
            dataset,
            state,
            done,
            frames,
            ..
        } = known::job(client, name)?;
        return Ok(Target {
            path: format!("/v1/jobs/{}", encode(&id)),
            described: format!("job {id} of dataset {dataset} ({state}, {done} of {frames} frames)"),
        });
    }
    if known::is_scene_id(name) {
        let SceneView {
            width,
            height,
            created_at,
            ..
        } = known::scene(client, name)?;
        return Ok(Target {
            path: format!("/v1/scenes/{}", encode(name)),
            described: format!("scene {name} ({width}×{height}, uploaded {created_at})"),
        });
    }
    let DatasetRow {
        jobs, images, bytes, ..
    } = known::dataset(client, name)?.dataset;
    if let Some(Version { dataset, number }) = known::version(name) {
        return Ok(Target {
            path: format!("/v1/datasets/{}/versions/{number}", encode(dataset)),
            described: format!("the seal of {name} (its {} stay)", count(images, "image")),
        });
    }
    Ok(Target {
        path: format!("/v1/datasets/{}", encode(name)),
        described: format!(
            "dataset {name} ({}, {}, {})",
            count(jobs, "job"),
            count(images, "image"),
            describe_bytes(bytes as f64)
        ),
    })
}

fn confirmed(described: &str) -> Result<bool, Failure> {
    if !std::io::stdin().is_terminal() {
        let message =
            "cannot confirm, since standard input is not a terminal; --yes deletes without confirmation";
        return Err(Failure::input(message));
    }
    let mut out = std::io::stderr();
    write!(out, "delete {described} for good? [y/N] ")
        .and_then(|()| out.flush())
        .context("cannot write to the terminal")?;
    let mut reply = String::new();
    std::io::stdin()
        .lock()
        .read_line(&mut reply)
        .context("cannot read from the terminal")?;
    Ok(matches!(reply.trim(), "y" | "Y" | "yes"))
}
