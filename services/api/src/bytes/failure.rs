//! Tracks whether the disk refuses writes.

use std::sync::{Arc, Mutex, PoisonError};

use super::Bytes;

/// The reason of the last failed write, until writes work again.
#[derive(Default)]
pub(crate) struct WriteFailure(Mutex<Option<String>>);

impl WriteFailure {
    pub(crate) fn note(&self, reason: &str) {
        self.set(Some(reason.to_owned()));
    }

    fn set(&self, reason: Option<String>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = reason;
    }

    fn reason(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Bytes {
    /// The reason why writes fail. After a failure it writes to the folder, the catalogue and the packs each time, so
    /// that it returns `None` as soon as all of them work.
    pub(crate) async fn write_failure(&self) -> Option<String> {
        self.failure.reason()?;
        let reason = self.check_writes().await.err();
        self.failure.set(reason.clone());
        reason
    }

    async fn check_writes(&self) -> Result<(), String> {
        let space = Arc::clone(&self.space);
        let probed = tokio::task::spawn_blocking(move || space.probe()).await;
        probed
            .map_err(|error| error.to_string())?
            .map_err(|error| format!("the data folder cannot be written: {error}"))?;
        self.catalogue
            .check_writes()
            .await
            .map_err(|error| error.to_string())?;
        self.store.check_writes().await.map_err(|error| error.to_string())
    }
}
