//! `GET /v1/datasets`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::{Catalogue, DatasetRow, Page};

use crate::http::problem::Problem;

/// List datasets by name, all on one page.
#[utoipa::path(get, path = "/v1/datasets", tag = "datasets",
    responses((status = 200, description = "All datasets.", body = Page<DatasetRow>)))]
pub(crate) async fn list(State(catalogue): State<Arc<Catalogue>>) -> Result<Json<Page<DatasetRow>>, Problem> {
    Ok(Json(Page::whole(catalogue.datasets().await?)))
}
