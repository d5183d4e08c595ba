//! `fathom scenes`: lists the uploaded scenes of a service.

use cli::exit::Failure;
use cli::known;
use cli::plural::count;
use cli::remote::ServerArguments;
use cli::table::{DASH, table};
use client::{CollectionScene, SceneView};
use serde_json::json;

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
    let client = arguments.server.client();
    let (rows, last) = match &arguments.collection {
        Some(name) => {
            let mut scenes = known::collection(&client, name)?;
            scenes.truncate(arguments.limit);
            if arguments.json {
                scenes.iter().for_each(|scene| println!("{}", json!(scene)));
                return Ok(());
            }
            (scenes.iter().map(collection_row).collect::<Vec<_>>(), "name")
        }
        None => {
            let scenes = client.scenes(arguments.limit)?;
            if arguments.json {
                scenes.iter().for_each(|scene| println!("{}", json!(scene)));
                return Ok(());
            }
            (scenes.iter().map(scene_row).collect(), "uploaded")
        }
    };
    println!("{}", table(&["scene", "size", "range", "instances", last], &rows));
    println!("{}", count(rows.len(), "scene"));
    Ok(())
}

fn scene_row(scene: &SceneView) -> Vec<String> {
    vec![
        scene.id.clone(),
        format!("{}×{}", scene.width, scene.height),
        scene.range_kind.clone().unwrap_or_else(|| DASH.to_owned()),
        yes_or_dash(scene.instances_digest.is_some()),
        scene.created_at.clone(),
    ]
}

fn collection_row(scene: &CollectionScene) -> Vec<String> {
    vec![
        scene.id.clone(),
        format!("{}×{}", scene.width, scene.height),
        scene.range_kind.clone().unwrap_or_else(|| DASH.to_owned()),
        yes_or_dash(scene.instances),
        scene.name.clone(),
    ]
}

fn yes_or_dash(is_set: bool) -> String {
    if is_set { "yes" } else { DASH }.to_owned()
}
