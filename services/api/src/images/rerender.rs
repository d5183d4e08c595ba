//! Renders stored frames again in a child process. A folder passes the description and the scene's files to it, and
//! the artifacts back.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use imaging::Samples;
use imaging::codec::{Radiance, decode_picture, decode_radiance};
use serde_json::{Value, json};
use spec::{EARLIER_VERSION, FrameRecord, Job, Scene, is_of_earlier_version};
use tempfile::TempDir;

use super::Images;
use crate::http::failure::writing;
use crate::http::problem::{Problem, Slug, found};
use crate::processes::child::{Allowance, Ended};

/// A 64 Mpx frame of the reference implementation exceeds this.
const ALLOWANCE: Allowance = Allowance {
    time: Duration::from_secs(120),
    memory_bytes: 8 << 30,
};

/// A frame rendered again.
pub(crate) struct Again {
    /// Dropped with the last frame that was rendered together with this one.
    _folder: Arc<TempDir>,
    path: PathBuf,
    pub(crate) record: FrameRecord,
}

impl Again {
    /// The bytes of the artifact of this kind.
    pub(crate) fn bytes(&self, kind: &str) -> Option<Vec<u8>> {
        let position = self
            .record
            .artifacts
            .iter()
            .position(|artifact| artifact.kind == kind)?;
        fs::read(self.path.join(format!("artifact-{position}"))).ok()
    }
}

impl Images {
    /// Renders a frame of a stored job.
    pub(crate) async fn rerender(&self, job_id: &str, frame: u64) -> Result<Again, Problem> {
        let job = self.renderable(job_id).await?;
        let scene = job.resolve(frame)?.scene;
        check_local_files(&scene)?;
        let mut again = self.render_again(&job, &[frame], scene.uploaded_id()).await?;
        again
            .pop()
            .ok_or_else(|| Problem::internal(&"no frame was rendered"))
    }

    /// Renders frames of a stored job, those without uploaded scenes in one process. Returns the result of each.
    pub(crate) async fn rerender_all(
        &self,
        job_id: &str,
        frames: &[u64],
    ) -> Result<Vec<(u64, Result<Again, Problem>)>, Problem> {
        let job = self.renderable(job_id).await?;
        let mut together = Vec::new();
        for &frame in frames {
            if matches!(job.resolve(frame)?.scene, Scene::Procedural { .. }) {
                together.push(frame);
            }
        }
        let mut results = Vec::with_capacity(frames.len());
        if together.len() > 1
            && let Ok(all) = self.render_again(&job, &together, None).await
        {
            results.extend(together.into_iter().zip(all.into_iter().map(Ok)));
        }
        // One by one if they failed together, so that only the failing one has no result.
        for &frame in frames {
            if results.iter().all(|(known, _)| *known != frame) {
                results.push((frame, self.rerender(job_id, frame).await));
            }
        }
        Ok(results)
    }

    async fn renderable(&self, job_id: &str) -> Result<Job, Problem> {
        let spec = found(self.catalogue.description(job_id).await?, "job", job_id)?;
        if is_of_earlier_version(&spec) {
            return Err(Problem::new(Slug::RenderFailed, EARLIER_VERSION));
        }
        Ok(Job::from_canonical(&spec)?)
    }

    async fn render_again(
        &self,
        job: &Job,
        frames: &[u64],
        scene: Option<&str>,
    ) -> Result<Vec<Again>, Problem> {
        let folder = self.processes.scratch.folder();
        let folder = Arc::new(folder.map_err(|error| writing(&error))?);
        let scene = match scene {
            Some(id) => self.lay_out(id, folder.path()).await?,
            None => Value::Null,
        };
        let request = json!({"spec": job.canonical(), "frames": frames, "scene": scene});
        write(folder.path(), "request.json", request.to_string().as_bytes())?;
        let arguments = [
            OsStr::new("rerender"),
            OsStr::new("--folder"),
            folder.path().as_os_str(),
            OsStr::new("--data"),
            self.data.as_os_str(),
        ];
        match self
            .processes
            .children
            .run("child", &arguments, ALLOWANCE)
            .await?
        {
            Ended::Well => {}
            Ended::Refused(why) | Ended::Lacking(why) => return Err(Problem::new(Slug::RenderFailed, why)),
            Ended::Badly(why) => {
                let detail = format!("the rendering process failed: {why}");
                return Err(Problem::new(Slug::RenderFailed, detail));
            }
        }
        frames.iter().map(|&frame| read_again(&folder, frame)).collect()
    }

    /// Writes the files of an uploaded scene; returns its description.
    async fn lay_out(&self, id: &str, folder: &Path) -> Result<Value, Problem> {
        let row = found(self.catalogue.scene(id).await?, "scene", id)?;
        for (name, digest) in row.files.named() {
            let bytes = self.bytes.store.get(digest).await?;
            let bytes = bytes.ok_or_else(|| {
                let detail = format!("file `{name}` of scene {id} is missing");
                Problem::new(Slug::CorruptArtifact, detail)
            })?;
            write(folder, name, &bytes)?;
        }
        Ok(json!(row.files))
    }
}

/// For an imported set these are paths on this machine, which the set's author has no permission to read.
fn check_local_files(scene: &Scene) -> Result<(), Problem> {
    if scene.files().is_none() {
        return Ok(());
    }
    let detail = "the frame uses local files of the machine that rendered it";
    Err(Problem::new(Slug::RenderFailed, detail))
}

fn read_again(folder: &Arc<TempDir>, frame: u64) -> Result<Again, Problem> {
    let path = folder.path().join(frame.to_string());
    let record = fs::read(path.join("record.json")).map_err(|error| Problem::internal(&error))?;
    Ok(Again {
        record: serde_json::from_slice(&record).map_err(|error| Problem::internal(&error))?,
        _folder: Arc::clone(folder),
        path,
    })
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Problem> {
    fs::write(folder.join(name), bytes).map_err(|error| writing(&error))
}

/// The maximum difference between two artifacts: in codes of an image or mask, in the unit of a linear layer. `None`
/// if they are not comparable, such as images of different sizes.
pub(crate) fn difference(stored: &[u8], again: &[u8]) -> Option<f64> {
    if stored == again {
        return Some(0.0);
    }
    if let (Ok(a), Ok(b)) = (decode_picture(stored), decode_picture(again)) {
        return match (a.samples(), b.samples()) {
            _ if (a.width(), a.height()) != (b.width(), b.height()) => None,
            (Samples::U8(a), Samples::U8(b)) => {
                largest(a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))))
            }
            (Samples::U16(a), Samples::U16(b)) => {
                largest(a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))))
            }
            _ => None,
        };
    }
    let (Ok(Radiance::Linear(a)), Ok(Radiance::Linear(b))) =
        (decode_radiance(stored), decode_radiance(again))
    else {
        return None;
    };
    let planes = a.planes().iter().zip(b.planes());
    let pairs = planes.flat_map(|(a, b)| a.data().iter().zip(b.data()));
    (a.size() == b.size()).then_some(())?;
    largest(pairs.map(|(a, b)| f64::from((a - b).abs())))
}

fn largest(differences: impl Iterator<Item = f64>) -> Option<f64> {
    differences.max_by(f64::total_cmp)
}
