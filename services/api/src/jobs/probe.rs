//! Spot checks: frames rendered a second time by a process of the service and compared with a worker's commit. A
//! worker with a different frame is dismissed; its frames since the last good check lose their images and are
//! rendered by others.

use std::sync::Arc;
use std::time::{Duration, Instant};

use imaging::Samples;
use imaging::codec::decode_picture;
use serde_json::json;
use tokio_util::sync::CancellationToken;

use super::Jobs;
use crate::http::problem::Problem;
use crate::images::rerender::Again;
use crate::leases::probes::Probe;
use crate::telemetry;

/// Interval of looking for frames to check.
const LOOK: Duration = Duration::from_millis(200);
/// Checks take at most one part in this many of the time of one core, because small frames arrive faster than a
/// process starts.
const MAX_PAUSES: u32 = 99;
/// Parts of a record that depend only on the job, for one program and kind of machine.
const FACTS: [&str; 8] = [
    "parameters",
    "optics",
    "plan",
    "measurements",
    "artifacts",
    "counts",
    "warnings",
    "scene",
];
/// Maximum mean difference of two images on different kinds of machines, 8-bit codes: rounding of the last bit.
const OTHER_MACHINE_CODES: f64 = 1.0;

/// Result of a check.
enum Verdict {
    Good,
    /// The check is inconclusive.
    Open(String),
    /// The frames differ.
    Differs(String),
}

/// Checks frames until the service stops.
pub(crate) async fn run(jobs: Arc<Jobs>, end: CancellationToken) {
    let probes = &jobs.leases.probes;
    let pauses =
        u32::try_from(probes.one_in.saturating_sub(1)).map_or(MAX_PAUSES, |rest| rest.min(MAX_PAUSES));
    let work = async {
        loop {
            let Some(probe) = probes.next() else {
                tokio::time::sleep(LOOK).await;
                continue;
            };
            let begun = Instant::now();
            jobs.check(&probe).await;
            tokio::time::sleep(begun.elapsed() * pauses).await;
        }
    };
    end.run_until_cancelled(work).await;
}

impl Jobs {
    /// Checks a frame and handles the result.
    async fn check(self: &Arc<Self>, probe: &Probe) {
        let Probe {
            worker, job, frame, ..
        } = probe;
        let job: &str = job;
        let verdict = match self.verdict(job, *frame).await {
            Ok(verdict) => verdict,
            Err(problem) => Verdict::Open(problem.to_string()),
        };
        match verdict {
            Verdict::Good => {
                telemetry::checked("good");
                self.leases.probes.mark_good(probe);
            }
            Verdict::Open(why) => {
                telemetry::checked("open");
                tracing::info!(worker, job, frame, why, "a frame could not be checked");
                self.leases.probes.mark_inconclusive(probe);
            }
            Verdict::Differs(what) => {
                telemetry::checked("differs");
                tracing::error!(worker, job, frame, what, "a committed frame is wrong");
                let events = self.leases.dispatch.dismiss(worker);
                self.leases.record_strikes(events).await;
                self.take_back(worker).await;
            }
        }
    }

    /// Renders all unproven frames of a worker again.
    async fn take_back(self: &Arc<Self>, worker: &str) {
        for (job, frames) in self.leases.probes.take(worker) {
            let count = frames.len();
            match self.reopen(job.clone(), frames).await {
                Ok(row) => {
                    tracing::warn!(job, worker, frames = count, state = %row.state, "rendering images again")
                }
                Err(problem) => {
                    tracing::error!(job, worker, frames = count, %problem, "cannot render images again")
                }
            }
        }
    }

    async fn verdict(&self, job: &str, frame: u64) -> Result<Verdict, Problem> {
        let image = self.images.get(job, frame).await?;
        let again = self.images.rerender(job, frame).await?;
        let record = json!(again.record);
        let differing: Vec<_> = ["code_version", "onnx_runtime", "inputs", "cpu_features"]
            .into_iter()
            .filter(|name| image["provenance"].get(name) != record["provenance"].get(name))
            .collect();
        match differing.first() {
            Some(&("code_version" | "onnx_runtime")) => {
                Ok(Verdict::Open("the frame is of another version".to_owned()))
            }
            Some(&"inputs") => Ok(Verdict::Differs("/provenance/inputs".to_owned())),
            Some(_) => self.compare_images(job, frame, again).await,
            None => {
                let different = FACTS.iter().find(|name| image[**name] != record[**name]);
                Ok(different.map_or(Verdict::Good, |name| Verdict::Differs((*name).to_owned())))
            }
        }
    }

    /// Compares only the images, which may differ by rounding.
    async fn compare_images(&self, job: &str, frame: u64, again: Again) -> Result<Verdict, Problem> {
        const PICTURE: &str = "rgb";
        let Some(bytes) = again.bytes(PICTURE) else {
            return Ok(Verdict::Open(
                "the frame is of another kind of machine and has no image".to_owned(),
            ));
        };
        let stored = self.images.artifact(job, frame, PICTURE).await?;
        let stored = self.images.stored(stored).await?.bytes;
        let mean = self
            .processes
            .compute
            .run(move || mean_difference(&stored, &bytes))
            .await?;
        Ok(match mean {
            Some(codes) if codes <= OTHER_MACHINE_CODES => Verdict::Good,
            Some(codes) => Verdict::Differs(format!("{PICTURE}, by {codes:.1} codes in the mean")),
            None => Verdict::Differs(format!("the size of {PICTURE}")),
        })
    }
}

/// Mean difference of two images of one size and depth, 8-bit codes.
fn mean_difference(one: &[u8], other: &[u8]) -> Option<f64> {
    let (one, other) = (decode_picture(one).ok()?, decode_picture(other).ok()?);
    let (sum, count): (f64, _) = match (one.samples(), other.samples()) {
        (Samples::U8(a), Samples::U8(b)) if a.len() == b.len() => {
            let differences = a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)));
            (differences.sum(), a.len())
        }
        (Samples::U16(a), Samples::U16(b)) if a.len() == b.len() => {
            let differences = a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)) / 257.0);
            (differences.sum(), a.len())
        }
        _ => return None,
    };
    Some(sum / count.max(1) as f64)
}
