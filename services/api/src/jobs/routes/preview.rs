use client::{Estimate, JobPreview, ResolvedFrame};
use serde::Deserialize;
use spec::{Frame, Job};
use utoipa::IntoParams;

use crate::http::bounds::out_of_range;
use crate::http::extract::Submitter;
use crate::http::{Json, JsonBytes, Problem, Query, State, Topic};
use crate::jobs::Jobs;
use crate::jobs::pricing::JobPrice;
use crate::openapi::JobDescription;

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
/// Rejects the same descriptions as a submission, including too expensive ones. The estimate uses frames of the same kind
/// rendered by this service, or typical figures without any.
#[utoipa::path(post, path = "/v1/jobs/preview", tag = "jobs", operation_id = "preview_job", params(Parameters),
    request_body(content = JobDescription, content_type = "application/json"),
    responses((status = 200, description = "The first frames and the cost.", body = JobPreview),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn preview(
    State(jobs): Topic<Jobs>,
    submitter: Submitter,
    Query(query): Query<Parameters>,
    JsonBytes(body): JsonBytes,
) -> Result<Json<JobPreview>, Problem> {
    let shown = query.frames.unwrap_or(SHOWN);
    if shown > MAX_SHOWN {
        return Err(out_of_range("frames", shown, 0, MAX_SHOWN));
    }
    let job = jobs.parse(&body).await?;
    jobs.check_runtime(&job)?;
    let price = jobs.price(&job).await?;
    let (frames, mut warnings) = (job.frames(), job.warnings().to_vec());
    warnings.extend(jobs.warn_caller(&submitter.owner, price).await?);
    let compute = &jobs.processes.compute;
    let first = compute.run(move || resolve_first(&job, shown)).await??;
    let estimate = estimate(&jobs, price);
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

fn resolve_first(job: &Job, shown: u64) -> Result<Vec<Frame>, Problem> {
    let first = (0..shown.min(job.frames())).map(|index| job.resolve(index));
    Ok(first.collect::<Result<_, _>>()?)
}

fn estimate(jobs: &Jobs, JobPrice { price, cost }: JobPrice) -> Estimate {
    let slots = jobs.leases.dispatch.slots().max(1);
    Estimate {
        seconds: price.slot_seconds / slots as f64,
        bytes: price.bytes as f64,
        slots,
        slot_seconds: price.slot_seconds,
        frame_seconds: cost.most_seconds,
        measured: cost.is_measured,
    }
}
