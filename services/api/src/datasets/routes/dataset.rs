//! `GET /v1/datasets`; `GET` and `DELETE /v1/datasets/{name}`.

use catalogue::{Catalogue, DatasetRow, Deleted, Page};
use client::DatasetDetail;

use crate::http::paging::Paging;
use crate::http::{Json, Path, Problem, Query, State, Topic, bounds, found};
use crate::jobs::Jobs;

/// List datasets by name.
#[utoipa::path(get, path = "/v1/datasets", tag = "datasets", operation_id = "list_datasets", params(Paging),
    responses((status = 200, description = "A page of datasets.", body = Page<DatasetRow>)))]
pub(crate) async fn list(
    State(catalogue): Topic<Catalogue>,
    Query(query): Query<Paging>,
) -> Result<Json<Page<DatasetRow>>, Problem> {
    let limit = bounds::check_rows(query.limit)?;
    Ok(Json(catalogue.datasets(limit, query.cursor).await?))
}

/// See a dataset, or a sealed version such as `tour@1`: its counts, bytes and columns.
#[utoipa::path(get, path = "/v1/datasets/{name}", tag = "datasets", operation_id = "get_dataset",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "The dataset.", body = DatasetDetail)))]
pub(crate) async fn get(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
) -> Result<Json<DatasetDetail>, Problem> {
    let dataset = row(&catalogue, &name).await?;
    let columns = catalogue.columns(&name).await?;
    Ok(Json(DatasetDetail { dataset, columns }))
}

/// Returns an existing dataset.
pub(super) async fn row(catalogue: &Catalogue, name: &str) -> Result<DatasetRow, Problem> {
    found(catalogue.dataset(name).await?, "dataset", name)
}

/// Delete a dataset with all its jobs and images.
///
/// Running jobs and sealed versions prevent this: cancel the jobs and unseal the versions first. Space is reclaimed
/// in the background. Scenes are kept.
#[utoipa::path(delete, path = "/v1/datasets/{name}", tag = "datasets", operation_id = "delete_dataset",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "Deleted.", body = Deleted),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn delete(
    State(jobs): Topic<Jobs>,
    Path(name): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(jobs.delete_dataset(name).await?))
}
