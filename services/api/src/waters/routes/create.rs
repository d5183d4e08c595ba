use axum::http::StatusCode;
use client::WaterView;

use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, State, Topic};
use crate::openapi::NewWater;
use crate::waters::Waters;

/// Add your water, for jobs to use by name.
///
/// It must pass the self-tests of the shipped waters; all failures are listed. An accepted job contains its numbers,
/// so frames do not change when the water is deleted.
#[utoipa::path(post, path = "/v1/waters", tag = "waters", operation_id = "add_water", request_body = NewWater,
    responses((status = 201, description = "Stored; `warnings` lists anomalies.", body = WaterView),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(waters): Topic<Waters>,
    JsonBytes(body): JsonBytes,
) -> Result<Located<WaterView>, Problem> {
    let water = waters.create(body.to_vec()).await?;
    let location = format!("/v1/waters/{}", water.name);
    Ok(located(StatusCode::CREATED, location, water))
}
