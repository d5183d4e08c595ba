//! `GET /v1/datasets/{name}`.

use axum::Json;
use axum::extract::State;
use catalogue::{ColumnInfo, DatasetRow};
use serde::Serialize;
use utoipa::ToSchema;

use super::list::Dataset;
use crate::app::{App, Shared};
use crate::http::extract::Path;
use crate::http::problem::Problem;

/// A column that filters, orders and tables may name.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Column {
    /// Its name.
    #[schema(example = "camera.hfov_deg")]
    name: String,
    /// `number`, `text` or `bool`.
    kind: &'static str,
    /// Its unit, where it has one.
    #[schema(example = "degree")]
    unit: Option<&'static str>,
}

/// A dataset with its columns.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct DatasetDetail {
    #[serde(flatten)]
    dataset: Dataset,
    /// What is known of its images.
    columns: Vec<Column>,
}

/// See a dataset: its counts, bytes and columns.
#[utoipa::path(get, path = "/v1/datasets/{name}", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "The dataset.", body = DatasetDetail),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn get(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<Json<DatasetDetail>, Problem> {
    let dataset = row(&app, &name).await?.into();
    let column = |ColumnInfo { name, kind, unit }| Column { name, kind, unit };
    let columns = app
        .catalogue
        .columns(&name)
        .await?
        .into_iter()
        .map(column)
        .collect();
    Ok(Json(DatasetDetail { dataset, columns }))
}

/// A dataset that there is.
pub(super) async fn row(app: &App, name: &str) -> Result<DatasetRow, Problem> {
    let mut rows = app.catalogue.datasets().await?.into_iter();
    let row = rows.find(|row| row.name == name);
    row.ok_or_else(|| Problem::not_found(format!("no dataset `{name}`")))
}
