//! `fathom child rerender`: renders stored frames again, for the service.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use renderer::{SceneBytes, SceneSource, Slot};
use serde::Deserialize;
use spec::{Job, SceneFiles};

use super::engine::EngineArguments;

/// Options of `fathom child rerender`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder with `request.json` and the files of the scene; the record and the artifacts of each frame are written to a
    /// folder in it
    #[arg(long)]
    folder: PathBuf,
    #[command(flatten)]
    engine: EngineArguments,
}

/// `request.json`, written by the service.
#[derive(Deserialize)]
struct Request {
    spec: String,
    frames: Vec<u64>,
    scene: Option<SceneFiles<String>>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folder = &arguments.folder;
    let request: Request = serde_json::from_slice(&files::read(&folder.join("request.json"))?)
        .context("request.json cannot be read")?;
    let job = Job::from_canonical(&request.spec).map_err(Failure::input)?;
    let source = match &request.scene {
        Some(scene) => SceneSource::Uploaded(Arc::new(uploaded(folder, scene)?)),
        None => SceneSource::Local,
    };
    let mut slot = Slot::new(&arguments.engine.engine()?);
    for &index in &request.frames {
        let frame = job.resolve(index).map_err(Failure::input)?;
        let rendered = slot.attempt(&frame, &source).map_err(Failure::input)?;
        let folder = folder.join(index.to_string());
        fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
        for (position, file) in rendered.files.iter().enumerate() {
            files::write(&folder.join(format!("artifact-{position}")), &file.bytes)?;
        }
        let record = serde_json::to_vec(&rendered.record).context("the record cannot be written")?;
        files::write(&folder.join("record.json"), &record)?;
    }
    Ok(())
}

/// The files of a scene, stored in the folder under their names.
fn uploaded(folder: &Path, scene: &SceneFiles<String>) -> Result<SceneBytes, Failure> {
    let mut names = scene.named().map(|(name, _)| name);
    scene.try_map(|_| files::read(&folder.join(names.next().unwrap_or_default())))
}
