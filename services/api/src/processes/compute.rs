//! The pool for computations: decoding, hashing, thumbnails.

use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::http::problem::Problem;

/// Completes a change even if the client disconnects.
pub(crate) async fn to_the_end<T: Send + 'static>(
    change: impl Future<Output = Result<T, Problem>> + Send + 'static,
) -> Result<T, Problem> {
    tokio::spawn(change)
        .await
        .map_err(|error| Problem::internal(&error))?
}

/// Runs closures on separate threads, a bounded number at a time.
pub(crate) struct Compute(Arc<Semaphore>);

impl Compute {
    pub(crate) fn new(threads: usize) -> Self {
        Self(Arc::new(Semaphore::new(threads)))
    }

    /// Runs a computation. It completes, and keeps its permit, even if the caller is dropped.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        computation: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, Problem> {
        let place = Arc::clone(&self.0).acquire_owned().await;
        let place = place.map_err(|error| Problem::internal(&error))?;
        let task = tokio::task::spawn_blocking(move || {
            let _place = place;
            computation()
        });
        task.await.map_err(|error| Problem::internal(&error))
    }
}
