//! How fast `fathom import` is, over a set of images that were never rendered. `FATHOM_BENCH_IMAGES` says how many.
//!
//! The set is written as always: this program is also the child that its supervisor asks for frames.

use std::env;
use std::error::Error;
use std::io::{BufRead, stdin, stdout};
use std::process::Command;
use std::time::Duration;

use cli::styles::StyleArguments;
use sets::{Crew, Location, Message, NewSet, ParcelFile, Recipe, Set, run_shard};
use spec::{Job, sha256};

/// First argument of the child.
const CHILD: &str = "frames";
const BYTES: &[u8] = b"as long as a thumbnail of a thumbnail";

fn main() -> Result<(), Box<dyn Error>> {
    if env::args().nth(1).as_deref() == Some(CHILD) {
        return frames();
    }
    let images: u64 = match env::var("FATHOM_BENCH_IMAGES") {
        Ok(text) => text.parse()?,
        Err(_) => 100_000,
    };
    let folder = tempfile::tempdir()?;
    let set = folder.path().join("set");
    fill(&set, images)?;
    for _ in 0..3 {
        let data = tempfile::tempdir()?;
        let import = Command::new(env!("CARGO_BIN_EXE_fathom"))
            .arg("import")
            .arg(&set)
            .arg("--data")
            .arg(data.path())
            .status()?;
        if !import.success() {
            return Err("the import failed".into());
        }
    }
    Ok(())
}

fn fill(folder: &std::path::Path, images: u64) -> Result<(), Box<dyn Error>> {
    let text = format!(
        r#"{{"dataset": "reef", "count": {images}, "artifacts": ["rgb", "range"], "enhance": ["hscm"],
             "camera": {{"width": 8, "height": 8}}, "scene": {{"kind": "procedural", "family": "structure", "seed": 1}}}}"#
    );
    let style = StyleArguments {
        styles: None,
        onnxruntime: None,
    };
    let vocabulary = renderer::vocabulary(&style.library()?, true);
    let job = Job::parse(text.as_bytes(), &vocabulary)?;
    let new = NewSet {
        job: &job,
        frames_per_shard: None,
        parts: 1,
        code_version: renderer::CODE_VERSION,
        metrics: synthetic::metrics(),
    };
    let set = Set::begin(&Location::Folder(folder.to_owned()), &new)?;
    let recipe = Recipe {
        program: env::current_exe()?,
        arguments: vec![CHILD.into()],
        slots: 1,
        frame_limit: Duration::from_secs(60),
        memory_limit_bytes: u64::MAX,
    };
    let mut crew = Crew::new(recipe, set.job()?);
    for shard in 0..set.card().shards() {
        run_shard(&set, shard, &mut crew, &|| Ok(()))?;
    }
    Ok(())
}

/// The child: an image for every frame that is asked for.
fn frames() -> Result<(), Box<dyn Error>> {
    for line in stdin().lock().lines().skip(1) {
        let frame: u64 = line?.parse()?;
        let mut record = synthetic::record("bench", frame);
        for artifact in &mut record.artifacts {
            artifact.digest = sha256(format!("{frame} {}", artifact.kind).as_bytes());
            artifact.bytes = BYTES.len() as u64;
        }
        let file = |kind: &str| ParcelFile {
            kind: kind.to_owned(),
            extension: "png".to_owned(),
            bytes: BYTES.to_vec(),
        };
        let mut out = stdout().lock();
        Message::Begun { frame }.write(&mut out)?;
        let files = record
            .artifacts
            .iter()
            .map(|artifact| file(&artifact.kind))
            .collect();
        let record = serde_json::to_vec(&record)?;
        Message::Image { frame, record, files }.write(&mut out)?;
    }
    Ok(())
}
