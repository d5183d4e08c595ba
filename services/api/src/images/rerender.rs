//! Renders a stored frame again in a child process. A folder passes the description and the scene's files to it, and
//! the artifacts back.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::time::Duration;

use imaging::Samples;
use imaging::codec::{Radiance, decode_picture, decode_radiance};
use serde_json::{Value, json};
use spec::{EARLIER_VERSION, FrameRecord, Job, is_of_earlier_version};
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
    folder: TempDir,
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
        fs::read(self.folder.path().join(format!("artifact-{position}"))).ok()
    }
}

impl Images {
    /// Renders a frame of a stored job.
    pub(crate) async fn rerender(&self, job_id: &str, frame: u64) -> Result<Again, Problem> {
        let spec = found(self.catalogue.description(job_id).await?, "job", job_id)?;
        if is_of_earlier_version(&spec) {
            return Err(Problem::new(Slug::RenderFailed, EARLIER_VERSION));
        }
        let resolved = Job::from_canonical(&spec)?.resolve(frame)?;
        if resolved.scene.files().is_some() {
            // For an imported set these are paths on this machine, which the set's author has no permission to read.
            let detail = "the frame uses local files of the machine that rendered it";
            return Err(Problem::new(Slug::RenderFailed, detail));
        }
        let folder = self.processes.scratch.folder().map_err(|error| writing(&error))?;
        let scene = match resolved.scene.uploaded_id() {
            Some(id) => self.lay_out(id, folder.path()).await?,
            None => Value::Null,
        };
        let request = json!({"spec": spec, "frame": frame, "scene": scene});
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
        let record =
            fs::read(folder.path().join("record.json")).map_err(|error| Problem::internal(&error))?;
        let record = serde_json::from_slice(&record).map_err(|error| Problem::internal(&error))?;
        Ok(Again { folder, record })
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
