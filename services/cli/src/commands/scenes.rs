//! `fathom scenes`: lists the scenes that were uploaded to a service.

use cli::exit::Failure;
use cli::remote::{Remote, ServerArguments};
use cli::table::{cell, table};
use serde_json::Value;

/// Options of `fathom scenes`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Most scenes to print, newest first
    #[arg(long, default_value_t = 50)]
    limit: usize,
    /// Print one JSON object per scene
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let scenes = remote.rows("/v1/scenes", &[], arguments.limit)?;
    if arguments.json {
        scenes.iter().for_each(|scene| println!("{scene}"));
        return Ok(());
    }
    let row = |scene: &Value| {
        let mask = if scene["instances_digest"].is_null() {
            "–"
        } else {
            "yes"
        };
        vec![
            cell(&scene["id"]),
            format!("{}×{}", cell(&scene["width"]), cell(&scene["height"])),
            cell(&scene["range_kind"]),
            mask.to_owned(),
            cell(&scene["created_at"]),
        ]
    };
    let rows: Vec<Vec<String>> = scenes.iter().map(row).collect();
    println!(
        "{}",
        table(&["scene", "size", "range", "instances", "uploaded"], &rows)
    );
    println!("{} scenes", scenes.len());
    Ok(())
}
