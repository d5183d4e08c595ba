//! Datasets and their sealed versions.

pub(crate) mod routes;

use std::sync::Arc;

use catalogue::{Catalogue, VersionRow};

use crate::clock::Clock;
use crate::http::problem::{Problem, found};
use crate::images::Images;
use crate::processes::Processes;
use crate::processes::compute::to_the_end;

/// Sealing and verification of datasets.
pub(crate) struct Datasets {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) images: Arc<Images>,
    pub(crate) processes: Arc<Processes>,
    pub(crate) clock: Clock,
}

impl Datasets {
    /// Seals a dataset; returns the version, and whether it is new. Completes even if the client disconnects.
    async fn seal(self: &Arc<Self>, dataset: String) -> Result<(VersionRow, bool), Problem> {
        let datasets = Arc::clone(self);
        to_the_end(async move {
            let (row, is_new) = datasets.catalogue.seal(&dataset, datasets.clock.wall()).await?;
            let VersionRow {
                name, images, root, ..
            } = &row;
            tracing::info!(version = name, images, root, is_new, "dataset sealed");
            Ok((row, is_new))
        })
        .await
    }

    /// Unseals a version.
    async fn unseal(&self, dataset: &str, version: u64) -> Result<(), Problem> {
        self.catalogue.unseal(dataset, version, self.clock.wall()).await?;
        tracing::info!(dataset, version, "version unsealed");
        Ok(())
    }

    /// Returns a sealed version.
    async fn version(&self, dataset: &str, version: u64) -> Result<VersionRow, Problem> {
        let row = self.catalogue.version(dataset, version).await?;
        found(row, "sealed version", format_args!("{dataset}@{version}"))
    }
}
