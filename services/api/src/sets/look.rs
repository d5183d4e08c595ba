//! One poll of a set: imports its new images.

use catalogue::{JobRow, UnixMs};
use futures::StreamExt;
use uuid::Uuid;

use super::Sets;
use super::intake::{Intake, IntakeError};
use super::look_error::LookError;
use super::reader::Reader;
use crate::http::problem::{Problem, Slug};

impl From<LookError> for Problem {
    fn from(error: LookError) -> Self {
        match error {
            LookError::Catalogue(error) | LookError::Intake(IntakeError::Catalogue(error)) => error.into(),
            LookError::Later(_) => Self::new(Slug::SetUnreachable, error.to_string()),
            LookError::Intake(IntakeError::AnotherJob { .. }) => {
                Self::new(Slug::NameTaken, error.to_string())
            }
            LookError::Refused(_)
            | LookError::Damaged(_)
            | LookError::Intake(IntakeError::Job { .. } | IntakeError::Record { .. }) => {
                Self::field("/url", error.to_string())
            }
        }
    }
}

impl Sets {
    /// Opens a set and stores its job unless it exists; with this id, if services share it.
    pub(super) async fn begin(
        &self,
        reader: &Reader,
        url: &str,
        id: Option<&str>,
    ) -> Result<JobRow, LookError> {
        let (head, _reading) = reader.open(url).await?;
        let mut intake = Intake::open(&self.jobs.catalogue, head, &self.jobs.vocabulary()).await?;
        let is_new = !intake.is_there();
        if let Some(id) = id.filter(|_| is_new) {
            intake.set_id(id);
        }
        let accepted_at = id.and_then(accepted_at).unwrap_or_else(|| self.jobs.clock.wall());
        let row = intake.begin(accepted_at).await?;
        if is_new {
            let (job, dataset, set) = (&row.id, &row.dataset, &row.set);
            tracing::info!(job, dataset, set, "following a set");
        }
        Ok(row)
    }

    /// Imports the new images of a set; returns its job, or `None` if that was deleted.
    pub(super) async fn look(
        &self,
        reader: &Reader,
        location: &str,
        job: &str,
    ) -> Result<Option<JobRow>, LookError> {
        let catalogue = &self.jobs.catalogue;
        if catalogue.job(job).await?.is_none() {
            return Ok(None);
        }
        let (head, mut reading) = reader.open(location).await?;
        let intake = Intake::open(catalogue, head, &self.jobs.vocabulary()).await?;
        if intake.id() != job {
            return Ok(None);
        }
        let known = intake.known().await?;
        let mut parts = std::pin::pin!(reading.ask(&known, catalogue, &intake).await?);
        let mut storing = intake.storing();
        while let Some(part) = parts.next().await {
            let part = part?;
            storing.store(part.images, part.shard).await?;
            self.jobs.leases.changes.notify(job);
        }
        storing.finish().await?;
        self.jobs.leases.changes.notify(job);
        Ok(catalogue.job(job).await?)
    }
}

/// The time at which the accepting service created the id.
fn accepted_at(id: &str) -> Option<UnixMs> {
    let id = Uuid::parse_str(id.strip_prefix("job_")?).ok()?;
    let (seconds, nanoseconds) = id.get_timestamp()?.to_unix();
    Some(UnixMs(seconds * 1000 + u64::from(nanoseconds / 1_000_000)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::new_job_id;

    #[test]
    fn an_id_contains_the_time_of_acceptance() {
        let now = std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap().as_millis() as u64;
        let accepted = accepted_at(&new_job_id()).unwrap();
        assert!(accepted.0.abs_diff(now) < 60_000, "{accepted} is not now");
        assert_eq!(accepted_at("job_a"), None);
    }
}
