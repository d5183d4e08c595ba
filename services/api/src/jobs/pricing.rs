//! The price of a job: the expected cost of all its frames, from a few of them.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use catalogue::{Charge, JobState, NewJob, OpenJob, Price};
use spec::{Frame, Job};

use super::Jobs;
use super::prices::{Reservation, SampledFrame};
use crate::http::problem::Problem;
use crate::leases::costs::{Cost, Sized, count_price};
use crate::leases::table::OpenCost;

/// Frames resolved for a price, spread over the job.
const SAMPLE: u64 = 16;
/// Maximum time to resolve them.
const MAX_SAMPLING: Duration = Duration::from_millis(5);

/// The price of a job, and the costs of its frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct JobPrice {
    pub(super) price: Price,
    pub(super) cost: Cost,
}

impl JobPrice {
    /// As the lease table counts it.
    pub(super) fn open_cost(&self) -> OpenCost {
        count_price(&self.price)
    }
}

impl Jobs {
    /// Prices a job.
    ///
    /// # Errors
    /// A frame is more expensive than the limit.
    pub(super) async fn price(&self, job: &Job) -> Result<JobPrice, Problem> {
        let price = self.estimate(job).await?;
        self.prices.check_frames(&price.cost)?;
        Ok(price)
    }

    /// Estimates the costs of a job from a sample of its frames.
    pub(super) async fn estimate(&self, job: &Job) -> Result<JobPrice, Problem> {
        let digest = job.digest();
        let sample = match self.prices.sample(&digest) {
            Some(sample) => sample,
            None => {
                let described = job.clone();
                let sampling = self.processes.compute.run(move || resolve_sample(&described));
                let sample = Arc::new(self.measure_frames(sampling.await??).await?);
                self.prices.keep_sample(&digest, Arc::clone(&sample));
                sample
            }
        };
        let sized = sample.iter().map(|SampledFrame { frame, pixels }| Sized {
            frame,
            pixels: *pixels,
        });
        let cost = self.leases.costs.estimate(&sized.collect::<Vec<_>>());
        let frames = job.frames() as f64;
        let price = Price {
            slot_seconds: cost.seconds * frames,
            bytes: (cost.bytes * frames).round() as u64,
        };
        Ok(JobPrice { price, cost })
    }

    /// Reserves room for a job among the open ones of its caller. A repeated submission needs none.
    pub(super) async fn admit(
        &self,
        new: &NewJob,
        price: JobPrice,
    ) -> Result<Option<Reservation<'_>>, Problem> {
        let Some(Charge { owner, price: of_job }) = &new.charge else {
            return Ok(None);
        };
        let reservation = self.prices.reserve(owner, price.open_cost());
        let open = self.open_cost(owner).await?.plus(reservation.before);
        let Some(problem) = self.prices.refuse_caller(open, *of_job) else {
            return Ok(Some(reservation));
        };
        drop(reservation);
        let duplicate = self.catalogue.duplicate(new).await?;
        let is_complete = duplicate.is_some_and(|job| job.state == JobState::Done);
        match is_complete || self.catalogue.has_key(new).await? {
            true => Ok(None),
            false => Err(problem),
        }
    }

    /// Reserves room for a picture of a request among the open jobs of its caller, until it is dropped.
    ///
    /// # Errors
    /// It is more expensive than the limit of a frame, or of the caller.
    pub(super) async fn admit_picture(
        &self,
        owner: &str,
        frame: &Frame,
        pixels: usize,
    ) -> Result<Reservation<'_>, Problem> {
        let pixels = pixels as f64;
        let cost = self.leases.costs.estimate(&[Sized { frame, pixels }]);
        self.prices.check_frames(&cost)?;
        let price = Price {
            slot_seconds: cost.seconds,
            // Nothing is stored.
            bytes: 0,
        };
        let reservation = self.prices.reserve(owner, count_price(&price));
        let open = self.open_cost(owner).await?.plus(reservation.before);
        match self.prices.refuse_caller(open, price) {
            Some(problem) => Err(problem),
            None => Ok(reservation),
        }
    }

    /// Adds the price of a job that was stored without one.
    pub(super) async fn priced(&self, mut job: OpenJob, description: Option<&str>) -> OpenJob {
        if job.row.price.is_none()
            && let Some(Ok(parsed)) = description.map(Job::from_canonical)
            && let Ok(price) = self.estimate(&parsed).await
        {
            job.row.price = Some(price.price);
        }
        job
    }

    /// Price of a caller's unfinished frames, those rendered by the workers of the broker included.
    async fn open_cost(&self, caller: &str) -> Result<OpenCost, Problem> {
        let mut open = self.leases.dispatch.table(|table, _| table.open_cost(caller));
        if self.engine.is_none() {
            return Ok(open);
        }
        for job in self.catalogue.open_shared_jobs(caller).await? {
            let unfinished = job.frames.saturating_sub(job.done + job.failed);
            let cost = job.price.as_ref().map(count_price).unwrap_or_default();
            open = open.plus(cost.divided(job.frames).times(unfinished));
        }
        Ok(open)
    }

    /// Warns about a job that would be refused because of the caller's other jobs.
    pub(super) async fn warn_caller(&self, caller: &str, price: JobPrice) -> Result<Option<String>, Problem> {
        let open = self.open_cost(caller).await?;
        let refused = self.prices.refuse_caller(open, price.price);
        Ok(refused.map(|problem| format!("a submission would be refused: {}", problem.detail())))
    }

    /// Adds the number of pixels to frames; that of an uploaded scene is stored with it.
    async fn measure_frames(&self, frames: Vec<Frame>) -> Result<Vec<SampledFrame>, Problem> {
        let mut uploads: BTreeMap<String, f64> = BTreeMap::new();
        let mut measured = Vec::with_capacity(frames.len());
        for frame in frames {
            let pixels = match frame.scene.uploaded_id() {
                Some(id) => match uploads.get(id) {
                    Some(pixels) => *pixels,
                    None => {
                        let row = self.catalogue.scene(id).await?;
                        let pixels = row.map_or(0.0, |row| f64::from(row.width) * f64::from(row.height));
                        uploads.insert(id.to_owned(), pixels);
                        pixels
                    }
                },
                None => frame.camera.width as f64 * frame.camera.height as f64,
            };
            measured.push(SampledFrame { frame, pixels });
        }
        Ok(measured)
    }
}

/// Frames of the whole job at equal distances.
fn resolve_sample(job: &Job) -> Result<Vec<Frame>, Problem> {
    let begun = Instant::now();
    let step = job.frames().div_ceil(SAMPLE).max(1) as usize;
    let indices = (0..job.frames()).step_by(step).enumerate();
    let affordable = indices.take_while(|(resolved, _)| *resolved == 0 || begun.elapsed() < MAX_SAMPLING);
    let frames = affordable.map(|(_, index)| job.resolve(index));
    Ok(frames.collect::<Result<_, _>>()?)
}
