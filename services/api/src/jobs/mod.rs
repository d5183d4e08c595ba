//! Jobs: submission, events, control.

pub(crate) mod control;
mod direct;
mod follow;
pub(crate) mod machines;
pub(crate) mod prices;
mod pricing;
pub(crate) mod probe;
mod rounding;
pub(crate) mod routes;
mod submit;
mod verdict;
mod wait;

use std::sync::Arc;

use catalogue::{Catalogue, JobRow};
use spec::{EARLIER_VERSION, Vocabulary, is_of_earlier_version};
use tokio::sync::Mutex;
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::clock::{Clock, ordered_id};
use crate::engine::Engine;
use crate::http::problem::{Problem, Slug, found};
use crate::images::Images;
use crate::leases::Leases;
use crate::processes::Processes;
use crate::styles::Styles;
use crate::waters::Waters;
use prices::Prices;

/// An id for a new job; ids increase over time.
pub(crate) fn new_job_id() -> String {
    format!("job_{}", ordered_id().simple())
}

/// State needed from submission to the end of a job.
pub(crate) struct Jobs {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) leases: Arc<Leases>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) images: Arc<Images>,
    pub(crate) styles: Arc<Styles>,
    pub(crate) waters: Arc<Waters>,
    pub(crate) processes: Arc<Processes>,
    pub(crate) prices: Prices,
    /// Renders jobs in place of the workers of this service.
    pub(crate) engine: Option<Engine>,
    /// Serializes state changes of jobs.
    pub(crate) turn: Mutex<()>,
    pub(crate) clock: Clock,
    pub(crate) stop: CancellationToken,
}

impl Jobs {
    /// The current vocabulary of descriptions.
    pub(crate) fn vocabulary(&self) -> Vocabulary {
        self.styles.vocabulary(&self.waters)
    }

    /// A stored job, with a warning if it waits for a compatible worker.
    pub(crate) async fn get(&self, id: &str) -> Result<JobRow, Problem> {
        let mut row = found(self.catalogue.job(id).await?, "job", id)?;
        row.warnings.extend(self.leases.dispatch.warnings(id));
        if !row.state.has_ended() && self.check_version(id).await.is_err() {
            row.warnings.push(EARLIER_VERSION.to_owned());
        }
        Ok(row)
    }

    /// Offers the frames left open by an earlier run of the service.
    pub(crate) async fn resume_all(&self) -> Result<(), catalogue::CatalogueError> {
        let jobs = self.catalogue.open_jobs().await?;
        if !jobs.is_empty() {
            tracing::info!(jobs = jobs.len(), "resuming unfinished jobs");
        }
        let rows: Vec<JobRow> = jobs.iter().map(|job| job.row.clone()).collect();
        self.leases
            .proofs
            .resume(&rows, self.catalogue.due_checks().await?);
        for job in jobs {
            let description = self.catalogue.description(&job.row.id).await?;
            if description.as_deref().is_some_and(is_of_earlier_version) {
                tracing::warn!(job = job.row.id, "{EARLIER_VERSION}");
            } else {
                self.leases
                    .dispatch
                    .add_job(self.priced(job, description.as_deref()).await);
            }
        }
        Ok(())
    }

    /// Rejects rendering frames of a job of version 0.1.
    async fn check_version(&self, id: &str) -> Result<(), Problem> {
        let description = found(self.catalogue.description(id).await?, "job", id)?;
        match is_of_earlier_version(&description) {
            true => Err(Problem::new(Slug::JobState, EARLIER_VERSION)),
            false => Ok(()),
        }
    }
}
