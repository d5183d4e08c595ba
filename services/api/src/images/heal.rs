//! Restores damaged rows of images while the service runs.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use catalogue::ImageId;
use tokio_util::sync::CancellationToken;

use super::Images;
use crate::http::problem::{Problem, Slug};

/// Pause before another attempt if all places for rendering processes are taken or the disk refuses writes.
const PAUSE: Duration = Duration::from_secs(5);

/// Restores every image of which a row was found damaged, one at a time. A failed restoration is not repeated before
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
    /// Restores the rows of an image from its record or, if that is damaged, from its frame rendered again.
    async fn restore(&self, image: &ImageId) -> Result<(), Problem> {
        let ImageId { job, frame } = image;
        if self.catalogue.restore_from_record(job, *frame).await? {
            return Ok(());
        }
        let again = self.rerender(job, *frame).await?;
        if self.catalogue.restore_image(job, again.record.clone()).await? {
            return Ok(());
        }
        let detail = "the frame renders to other bytes than those of its record";
        Err(Problem::new(Slug::RenderFailed, detail))
    }
}
