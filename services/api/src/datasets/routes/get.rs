//! `GET /v1/datasets/{name}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::{Catalogue, ColumnInfo, DatasetRow};
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::extract::Path;
use crate::http::problem::{Problem, found};

/// A dataset with its columns.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct DatasetDetail {
    #[serde(flatten)]
    dataset: DatasetRow,
    /// What is known of its images.
    columns: Vec<ColumnInfo>,
}

/// See a dataset: its counts, bytes and columns.
#[utoipa::path(get, path = "/v1/datasets/{name}", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "The dataset.", body = DatasetDetail)))]
pub(crate) async fn get(
    State(catalogue): State<Arc<Catalogue>>,
    Path(name): Path<String>,
) -> Result<Json<DatasetDetail>, Problem> {
    let dataset = row(&catalogue, &name).await?;
    let columns = catalogue.columns(&name).await?;
    Ok(Json(DatasetDetail { dataset, columns }))
}

/// A dataset that exists.
pub(super) async fn row(catalogue: &Catalogue, name: &str) -> Result<DatasetRow, Problem> {
    let mut rows = catalogue.datasets().await?.into_iter();
    found(rows.find(|row| row.name == name), "dataset", name)
}
