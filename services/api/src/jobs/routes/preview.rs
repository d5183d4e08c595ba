//! `POST /v1/jobs/preview`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::{Frame, Job};
use utoipa::{IntoParams, ToSchema};

use crate::http::bounds::beyond;
use crate::http::{Json, JsonBytes, Problem, Query, State, Topic};
use crate::jobs::Jobs;
use crate::leases::costs::Sized;
use crate::openapi::JobDescription;

/// Frames whose cost is looked at, spread over the job.
const SAMPLE: u64 = 64;
/// Frames that are shown unless the request says otherwise.
const SHOWN: u64 = 5;
/// Most frames that are shown.
const MOST_SHOWN: u64 = 100;

/// How much to show.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Frames to show, 0..=100.
    #[param(default = 5, minimum = 0, maximum = 100)]
    frames: Option<u64>,
}

/// A frame with every law replaced by its value.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct ResolvedFrame {
    /// Its number.
    frame: u64,
    /// Its description.
    #[schema(value_type = Object)]
    parameters: Value,
}

/// What the job will cost, roughly.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Estimate {
    /// From its first frame to its last, with the slots below and nothing else to do.
    seconds: f64,
    /// Stored bytes.
    bytes: f64,
    /// Slots of the workers that are here now; at least one is counted.
    slots: u64,
}

/// A job that was not submitted.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct JobPreview {
    /// How many frames it has.
    frames: u64,
    /// The first of them.
    first: Vec<ResolvedFrame>,
    /// What the user should know, though nothing is wrong.
    warnings: Vec<String>,
    /// What it will cost.
    estimate: Estimate,
}

/// See what a job would do and cost. Nothing is stored.
///
/// It refuses whatever a submission would refuse. The estimate rests on frames that were rendered here before, or on
/// typical figures where there are none.
#[utoipa::path(post, path = "/v1/jobs/preview", tag = "jobs", operation_id = "preview_job", params(Parameters),
    request_body(content = JobDescription, content_type = "application/json"),
    responses((status = 200, description = "The first frames and the cost.", body = JobPreview),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn preview(
    State(jobs): Topic<Jobs>,
    Query(asked): Query<Parameters>,
    JsonBytes(body): JsonBytes,
) -> Result<Json<JobPreview>, Problem> {
    let shown = asked.frames.unwrap_or(SHOWN);
    if shown > MOST_SHOWN {
        return Err(beyond("frames", shown, 0, MOST_SHOWN));
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
    let view = |frame: Frame| ResolvedFrame {
        frame: frame.index,
        parameters: frame.parameters,
    };
    Ok(Json(JobPreview {
        frames,
        first: first.into_iter().map(view).collect(),
        warnings,
        estimate,
    }))
}

/// The first frames, and some of the whole job at equal distances.
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
