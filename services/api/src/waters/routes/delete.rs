//! `DELETE /v1/waters/{name}`.

use std::sync::Arc;

use axum::extract::State;
use axum::http::StatusCode;

use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::waters::Waters;

/// Delete a water of your own.
///
/// Jobs that were accepted hold its numbers: they go on, and their frames can be rendered again. Shipped waters stay.
#[utoipa::path(delete, path = "/v1/waters/{name}", tag = "waters",
    params(("name" = String, Path, description = "Its name")),
    responses((status = 204, description = "It is gone.")))]
pub(crate) async fn delete(
    State(waters): State<Arc<Waters>>,
    Path(name): Path<String>,
) -> Result<StatusCode, Problem> {
    waters.delete(name).await?;
    Ok(StatusCode::NO_CONTENT)
}
