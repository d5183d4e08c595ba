//! Restores damaged rows and artifacts of images while the service runs.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use catalogue::ImageId;
use store::{Blob, StoreError};
use tokio_util::sync::CancellationToken;

use super::Images;
use crate::http::problem::{Problem, Slug};

/// Pause before another attempt if all places for rendering processes are taken or the disk refuses writes.
const PAUSE: Duration = Duration::from_secs(5);

/// Restores every image with a damaged row or artifact, one at a time. A failed restoration is not repeated before
/// the next start.
pub(crate) async fn run(images: Arc<Images>, end: CancellationToken) {
    end.run_until_cancelled(restore_all(&images)).await;
}

async fn restore_all(images: &Images) {
    let mut given_up = BTreeSet::new();
    loop {
        let found = images.catalogue.damaged_images().into_iter();
        let found: BTreeSet<ImageId> = found.map(|damage| damage.image).collect();
        let open: Vec<ImageId> = found.difference(&given_up).cloned().collect();
        if open.is_empty() {
            images.catalogue.wait_for_damaged_image().await;
        }
        for image in open {
            let ImageId { job, frame } = &image;
            let result = images.restore(&image).await;
            let is_deleted = result.is_err() && matches!(images.catalogue.description(job).await, Ok(None));
            match result {
                Ok(()) => {
                    tracing::warn!(job, frame, "a damaged image is restored");
                    images.catalogue.forget_damage(&image);
                }
                Err(_) if is_deleted => images.catalogue.forget_damage(&image),
                Err(problem) if is_temporary(&problem) => tokio::time::sleep(PAUSE).await,
                Err(problem) => {
                    tracing::error!(job, frame, %problem, "a damaged image cannot be restored");
                    given_up.insert(image);
                }
            }
        }
    }
}

fn is_temporary(problem: &Problem) -> bool {
    [Slug::Overloaded, Slug::StorageFull, Slug::StorageFailed]
        .into_iter()
        .any(|slug| problem.is(slug))
}

impl Images {
    async fn restore(&self, image: &ImageId) -> Result<(), Problem> {
        self.restore_rows(image).await?;
        self.restore_artifacts(image).await
    }

    /// Stores damaged and missing artifacts of an image again, from its frame rendered again.
    async fn restore_artifacts(&self, ImageId { job, frame }: &ImageId) -> Result<(), Problem> {
        let mut damaged = Vec::new();
        for artifact in self.artifacts(job, *frame).await? {
            if artifact.place.is_some() {
                continue;
            }
            match self.read_pack(&artifact).await {
                Ok(Some(_)) => {}
                Ok(None) | Err(StoreError::Corrupt { .. }) => damaged.push(artifact.entry),
                Err(error) => return Err(error.into()),
            }
        }
        if damaged.is_empty() {
            return Ok(());
        }
        let again = self.rerender(job, *frame).await?;
        let mut blobs = Vec::with_capacity(damaged.len());
        for entry in damaged {
            let bytes = again
                .bytes(&entry.kind)
                .filter(|_| again.record.artifacts.contains(&entry));
            let bytes = bytes.ok_or_else(renders_otherwise)?;
            blobs.push(Blob {
                digest: entry.digest,
                bytes,
            });
        }
        let digests = blobs.iter().map(|blob| blob.digest.clone());
        self.bytes.naming.announce(digests).await;
        Ok(self.bytes.store.put_all(blobs).await?)
    }

    /// Restores the rows of an image from its record. Renders the frame again if the record is damaged.
    async fn restore_rows(&self, image: &ImageId) -> Result<(), Problem> {
        let ImageId { job, frame } = image;
        if self.catalogue.restore_from_record(job, *frame).await? {
            return Ok(());
        }
        let again = self.rerender(job, *frame).await?;
        if self.catalogue.restore_image(job, again.record.clone()).await? {
            return Ok(());
        }
        Err(renders_otherwise())
    }
}

fn renders_otherwise() -> Problem {
    let detail = "the frame renders to other bytes than those of its record";
    Problem::new(Slug::RenderFailed, detail)
}
