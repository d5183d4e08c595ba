//! `fathom scenes`: lists the scenes that were uploaded to a service.

use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, ServerArguments};
use cli::table::{cell, table};
use serde_json::Value;

/// Options of `fathom scenes`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Most scenes to print, newest first; of a collection in its order
    #[arg(long, default_value_t = 50)]
    limit: usize,
    /// Only the scenes of this collection, with their names in it
    #[arg(long, value_name = "NAME")]
    collection: Option<String>,
    /// Print one JSON object per scene
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let scenes = match &arguments.collection {
        Some(name) => {
            let mut scenes = known::collection(&remote, name)?;
            scenes.truncate(arguments.limit);
            scenes
        }
        None => remote.rows("/v1/scenes", &[], arguments.limit)?,
    };
    if arguments.json {
        scenes.iter().for_each(|scene| println!("{scene}"));
        return Ok(());
    }
    let (last, member) = match arguments.collection {
        Some(_) => ("name", "name"),
        None => ("uploaded", "created_at"),
    };
    let row = |scene: &Value| {
        let has_mask = scene["instances"] == true || scene["instances_digest"].is_string();
        vec![
            cell(&scene["id"]),
            format!("{}×{}", cell(&scene["width"]), cell(&scene["height"])),
            cell(&scene["range_kind"]),
            if has_mask { "yes" } else { "–" }.to_owned(),
            cell(&scene[member]),
        ]
    };
    let rows: Vec<Vec<String>> = scenes.iter().map(row).collect();
    println!("{}", table(&["scene", "size", "range", "instances", last], &rows));
    println!("{} scenes", scenes.len());
    Ok(())
}
