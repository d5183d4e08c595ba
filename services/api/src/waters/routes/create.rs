//! `POST /v1/waters`.

use axum::http::StatusCode;
use client::WaterView;

use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, State, Topic};
use crate::openapi::NewWater;
use crate::waters::Waters;

/// Add a water of your own, for jobs to use by name at once.
///
/// It passes the same self-tests as the shipped waters, or all that is wrong with it is listed. A job takes its numbers when
/// it is accepted, so frames stay what they are when the water is deleted.
#[utoipa::path(post, path = "/v1/waters", tag = "waters", operation_id = "add_water", request_body = NewWater,
    responses((status = 201, description = "Stored; `warnings` says what is odd about it.", body = WaterView),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(waters): Topic<Waters>,
    JsonBytes(body): JsonBytes,
) -> Result<Located<WaterView>, Problem> {
    let water = waters.create(body.to_vec()).await?;
    let location = format!("/v1/waters/{}", water.name);
    Ok(located(StatusCode::CREATED, location, water))
}
