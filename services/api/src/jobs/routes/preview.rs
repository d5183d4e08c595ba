use std::collections::BTreeMap;

use client::{Estimate, JobPreview, ResolvedFrame};
use serde::Deserialize;
use spec::{Frame, Job};
use utoipa::IntoParams;

use crate::http::bounds::out_of_range;
use crate::http::{Json, JsonBytes, Problem, Query, State, Topic};
use crate::jobs::Jobs;
use crate::leases::costs::Sized;
use crate::openapi::JobDescription;

/// Frames sampled for the estimate, spread over the job.
const SAMPLE: u64 = 64;
/// Default number of frames in a preview.
const SHOWN: u64 = 5;
/// Maximum number of frames in a preview.
const MAX_SHOWN: u64 = 100;

/// Size of the preview.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Frames to return, 0..=100.
    #[param(default = 5, minimum = 0, maximum = 100)]
    frames: Option<u64>,
}

/// Preview a job: frames and estimated cost. Nothing is stored.
///
/// Rejects the same descriptions as a submission. The estimate uses frames rendered by this service, or typical
/// figures without any.
#[utoipa::path(post, path = "/v1/jobs/preview", tag = "jobs", operation_id = "preview_job", params(Parameters),
    request_body(content = JobDescription, content_type = "application/json"),
    responses((status = 200, description = "The first frames and the cost.", body = JobPreview),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn preview(
    State(jobs): Topic<Jobs>,
    Query(query): Query<Parameters>,
    JsonBytes(body): JsonBytes,
) -> Result<Json<JobPreview>, Problem> {
    let shown = query.frames.unwrap_or(SHOWN);
    if shown > MAX_SHOWN {
        return Err(out_of_range("frames", shown, 0, MAX_SHOWN));
    }
    let job = jobs.parse(&body).await?;
    jobs.check_runtime(&job)?;
    let (frames, warnings) = (job.frames(), job.warnings().to_vec());
    let (first, sample) = jobs
        .processes
        .compute
        .run(move || resolved(&job, shown))
        .await??;
    let estimate = estimate(&jobs, &sample, frames).await?;
    Ok(Json(JobPreview {
        frames,
        first: first
            .into_iter()
            .map(|frame: Frame| ResolvedFrame {
                frame: frame.index,
                parameters: frame.parameters,
            })
            .collect(),
        warnings,
        estimate,
    }))
}

/// The first frames, and a sample of the whole job at equal distances.
fn resolved(job: &Job, shown: u64) -> Result<(Vec<Frame>, Vec<Frame>), Problem> {
    let step = job.frames().div_ceil(SAMPLE) as usize;
    let first = (0..shown.min(job.frames())).map(|index| job.resolve(index));
    let sample = (0..job.frames()).step_by(step).map(|index| job.resolve(index));
    Ok((
        first.collect::<Result<_, _>>()?,
        sample.collect::<Result<_, _>>()?,
    ))
}

async fn estimate(jobs: &Jobs, sample: &[Frame], frames: u64) -> Result<Estimate, Problem> {
    let mut uploads: BTreeMap<&str, f64> = BTreeMap::new();
    let mut sized = Vec::with_capacity(sample.len());
    for frame in sample {
        let pixels = match frame.scene.uploaded_id() {
            Some(id) => match uploads.get(id) {
                Some(pixels) => *pixels,
                None => {
                    let row = jobs.catalogue.scene(id).await?;
                    let pixels = row.map_or(0.0, |row| f64::from(row.width) * f64::from(row.height));
                    uploads.insert(id, pixels);
                    pixels
                }
            },
            None => frame.camera.width as f64 * frame.camera.height as f64,
        };
        sized.push(Sized { frame, pixels });
    }
    let cost = jobs.leases.costs.mean(&sized);
    let slots = jobs.leases.dispatch.slots().max(1);
    Ok(Estimate {
        seconds: cost.seconds * frames as f64 / slots as f64,
        bytes: (cost.bytes * frames as f64).round(),
        slots,
    })
}
