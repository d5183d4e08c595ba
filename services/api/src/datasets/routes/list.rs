//! `GET /v1/datasets`.

use axum::Json;
use axum::extract::State;
use catalogue::DatasetRow;
use serde::Serialize;
use utoipa::ToSchema;

use crate::app::Shared;
use crate::http::paging::Page;
use crate::http::problem::Problem;

/// A named, growing collection of images.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Dataset {
    /// Its name.
    name: String,
    /// Number of images.
    images: u64,
    /// Bytes of their artifacts, counting shared ones each time.
    bytes: u64,
    /// Number of jobs.
    jobs: u64,
}

impl From<DatasetRow> for Dataset {
    fn from(row: DatasetRow) -> Self {
        Self {
            name: row.name,
            images: row.images,
            bytes: row.bytes,
            jobs: row.jobs,
        }
    }
}

/// List datasets by name, all on one page.
#[utoipa::path(get, path = "/v1/datasets", tag = "datasets",
    responses((status = 200, description = "All datasets.", body = Page<Dataset>)))]
pub(crate) async fn list(State(app): State<Shared>) -> Result<Json<Page<Dataset>>, Problem> {
    let items = app.catalogue.datasets().await?.into_iter().map(Dataset::from);
    Ok(Json(Page {
        items: items.collect(),
        next_cursor: None,
    }))
}
