//! Restores artifacts by rendering their frames again.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use api::Data;
use catalogue::NamedDigest;
use renderer::{Engine, File, SceneBytes, SceneSource, Slot};
use spec::{FrameRecord, Job};
use store::Blob;
use style::Library;

const DIFFERS: &str = "the frame now renders to other bytes: this build, ONNX Runtime or processor differs from that of the record";

/// Renders frames of stored jobs.
pub(crate) struct Repair {
    slot: Slot,
    /// The last frame, since its artifacts are often damaged together.
    last: Option<Rendered>,
}

struct Rendered {
    job: String,
    frame: u64,
    record: FrameRecord,
    files: Vec<Blob>,
}

impl Repair {
    pub(crate) fn new(library: Library, onnxruntime: Option<&Path>) -> Self {
        let engine = Arc::new(Engine::new(library, onnxruntime));
        Self {
            slot: Slot::new(&engine),
            last: None,
        }
    }

    /// Restores an artifact, if the frame still renders to the same digest.
    pub(crate) async fn artifact(&mut self, data: &Data, artifact: &NamedDigest) -> anyhow::Result<()> {
        let (job, frame) = (&artifact.job_id, artifact.frame);
        let files = &self.rendered(data, job, frame).await?.files;
        let file = files
            .iter()
            .find(|file| file.digest == artifact.digest)
            .context(DIFFERS)?;
        Ok(data.store.put_all(vec![file.clone()]).await?)
    }

    /// Restores the rows of an image from its record, or by rendering its frame if the record is damaged.
    pub(crate) async fn image(&mut self, data: &Data, job: &str, frame: u64) -> anyhow::Result<()> {
        if data.catalogue.restore_from_record(job, frame).await? {
            return Ok(());
        }
        let record = self.rendered(data, job, frame).await?.record.clone();
        anyhow::ensure!(data.catalogue.restore_image(job, record).await?, DIFFERS);
        Ok(())
    }

    async fn rendered(&mut self, data: &Data, job: &str, frame: u64) -> anyhow::Result<&Rendered> {
        let last = self
            .last
            .take()
            .filter(|last| last.job == *job && last.frame == frame);
        let last = match last {
            Some(last) => last,
            None => self.render(data, job, frame).await?,
        };
        Ok(self.last.insert(last))
    }

    async fn render(&mut self, data: &Data, job: &str, frame: u64) -> anyhow::Result<Rendered> {
        let spec = data.catalogue.description(job).await?;
        let spec = spec.with_context(|| format!("job {job} is not stored"))?;
        let described = Job::from_canonical(&spec)?.resolve(frame)?;
        let source = match described.scene.uploaded_id() {
            Some(id) => SceneSource::Uploaded(Arc::new(uploaded(data, id).await?)),
            None => SceneSource::Local,
        };
        let rendered = tokio::task::block_in_place(|| self.slot.render(&described, &source))?;
        Ok(Rendered {
            job: job.to_owned(),
            frame,
            record: rendered.record,
            files: rendered
                .files
                .into_iter()
                .map(|file: File| Blob {
                    digest: file.digest,
                    bytes: file.bytes,
                })
                .collect(),
        })
    }
}

/// The files of an uploaded scene.
async fn uploaded(data: &Data, id: &str) -> anyhow::Result<SceneBytes> {
    let row = data.catalogue.scene(id).await?;
    let row = row.with_context(|| format!("scene {id} is not stored"))?;
    let mut files = BTreeMap::new();
    for (_, digest) in row.files.named() {
        files.insert(digest, data.store.get(digest).await?);
    }
    row.files.try_map(|digest| {
        let file = files.get(digest).cloned().flatten();
        file.with_context(|| format!("a file of scene {id} is gone"))
    })
}
