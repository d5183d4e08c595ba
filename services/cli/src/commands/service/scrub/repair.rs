//! Restores artifacts by rendering their frames again, and compares the stored records with these frames.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use api::Data;
use catalogue::{CatalogueError, NamedDigest};
use renderer::{Engine, File, SceneBytes, SceneSource, Slot};
use serde::Deserialize;
use spec::{Agreement, FrameRecord, Job, compare_records, describe_differences};
use store::Blob;
use style::Library;

use super::findings::Row;

const DIFFERS: &str = "the frame now renders to other bytes: this build, ONNX Runtime or processor differs from that of the record";

/// Renders frames of stored jobs.
pub(crate) struct Repair {
    slot: Slot,
    /// The last frame, since its artifacts are often damaged together.
    last: Option<Rendered>,
    /// Stored records that contradict their frames.
    pub(super) false_records: Vec<Row>,
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
            false_records: Vec::new(),
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
            None => {
                let rendered = self.render(data, job, frame).await?;
                // A frame is rendered again for each of its artifacts that are far apart.
                if let Some(row) = find_false_record(data, &rendered).await?
                    && self.false_records.iter().all(|known| known.what != row.what)
                {
                    self.false_records.push(row);
                }
                rendered
            }
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

/// Compares the stored record of a frame with that of the frame rendered again. `None` if they agree, if another program or
/// kind of machine rendered the frame, or if the stored record is damaged, which is reported separately.
async fn find_false_record(data: &Data, rendered: &Rendered) -> anyhow::Result<Option<Row>> {
    let Rendered {
        job, frame, record, ..
    } = rendered;
    let stored = match data.catalogue.image(job, *frame).await {
        Ok(Some(image)) => FrameRecord::deserialize(&image)?,
        Ok(None) | Err(CatalogueError::Damaged { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let (then, now) = (&stored.provenance, &record.provenance);
    let is_comparable = then.code_version == now.code_version
        && then.cpu_features == now.cpu_features
        && then.onnx_runtime == now.onnx_runtime;
    if !is_comparable {
        return Ok(None);
    }
    let difference = describe_differences(&compare_records(record, &stored, Agreement::Exact));
    Ok(difference.map(|difference| Row {
        what: format!("record of {job}/{frame}: {difference}"),
        repaired: Some(false),
        reason: Some(format!("`fathom start-again {job}` renders the job again")),
    }))
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
