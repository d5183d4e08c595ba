//! `fathom rerender`: one stored frame once more, for the service that asks for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use cli::styles::StyleArguments;
use renderer::{Engine, SceneBytes, SceneSource, Slot};
use serde::Deserialize;
use spec::{Job, SceneFiles};

/// Options of `fathom rerender`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder with `request.json` and the files of the scene; the record and the artifacts are written there
    #[arg(long)]
    folder: PathBuf,
    /// Folder of the service, for the styles that were added to it
    #[arg(long)]
    data: PathBuf,
    #[command(flatten)]
    style: StyleArguments,
}

/// What the service writes into the folder.
#[derive(Deserialize)]
struct Request {
    spec: String,
    frame: u64,
    scene: Option<SceneFiles<String>>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folder = &arguments.folder;
    let request: Request =
        serde_json::from_slice(&read(folder, "request.json")?).context("request.json cannot be read")?;
    let library = arguments.style.library_of_service(&arguments.data)?;
    let refused = |error: &dyn std::fmt::Display| Failure::BadInput(error.to_string());
    let job = Job::trusted(&request.spec).map_err(|error| refused(&error))?;
    let frame = job.resolve(request.frame).map_err(|error| refused(&error))?;
    let source = match &request.scene {
        Some(scene) => SceneSource::Uploaded(Arc::new(uploaded(folder, scene)?)),
        None => SceneSource::Local,
    };
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let rendered = Slot::new(&engine).attempt(&frame, &source);
    let rendered = rendered.map_err(|error| refused(&error))?;
    for (at, file) in rendered.files.iter().enumerate() {
        write(folder, &format!("artifact-{at}"), &file.bytes)?;
    }
    let record = serde_json::to_vec(&rendered.record).context("the record cannot be written")?;
    write(folder, "record.json", &record)
}

/// The files of a scene, which lie in the folder under their names.
fn uploaded(folder: &Path, scene: &SceneFiles<String>) -> Result<SceneBytes, Failure> {
    let mut names = scene.named().map(|(name, _)| name);
    scene.try_map(|_| read(folder, names.next().unwrap_or_default()))
}

fn read(folder: &Path, name: &str) -> Result<Vec<u8>, Failure> {
    let path = folder.join(name);
    Ok(fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?)
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    let path = folder.join(name);
    Ok(fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?)
}
