use axum::http::StatusCode;
use catalogue::{Page, VersionJob, VersionRow};
use serde::Serialize;
use utoipa::ToSchema;

use crate::datasets::Datasets;
use crate::http::located::{Located, created, located};
use crate::http::{Json, Path, Problem, State, Topic};

/// List the sealed versions of a dataset on one page, oldest first.
#[utoipa::path(get, path = "/v1/datasets/{name}/versions", tag = "datasets", operation_id = "list_sealed_versions",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 200, description = "The versions.", body = Page<VersionRow>)))]
pub(crate) async fn list(
    State(datasets): Topic<Datasets>,
    Path(name): Path<String>,
) -> Result<Json<Page<VersionRow>>, Problem> {
    super::dataset::row(&datasets.catalogue, &name).await?;
    Ok(Json(Page::whole(datasets.catalogue.versions(&name).await?)))
}

/// Seal a dataset: its present content becomes its next version, `NAME@1`, `NAME@2` and so on.
///
/// All of its jobs must have ended. A version can be used in place of a dataset name in queries. Its images can be
/// neither deleted nor extended until it is unsealed; the dataset itself may grow. Sealing an unchanged dataset
/// returns its existing version.
#[utoipa::path(post, path = "/v1/datasets/{name}/versions", tag = "datasets", operation_id = "seal_dataset",
    params(("name" = String, Path, description = "Name of the dataset")),
    responses((status = 201, description = "Sealed; `Location` is the version.", body = VersionRow),
              (status = 200, description = "Unchanged since it was sealed.", body = VersionRow),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn seal(
    State(datasets): Topic<Datasets>,
    Path(name): Path<String>,
) -> Result<Located<VersionRow>, Problem> {
    let (row, is_new) = datasets.seal(name).await?;
    let location = format!("/v1/datasets/{}/versions/{}", row.dataset, row.version);
    Ok(located(created(is_new), location, row))
}

/// A sealed version with its jobs.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct VersionDetail {
    #[serde(flatten)]
    version: VersionRow,
    /// Its jobs in the order of the root: by description digest.
    parts: Vec<VersionJob>,
}

/// Get a sealed version: its root, and the descriptions that reproduce its images.
#[utoipa::path(get, path = "/v1/datasets/{name}/versions/{version}", tag = "datasets", operation_id = "get_sealed_version",
    params(("name" = String, Path, description = "Name of the dataset"), ("version" = u64, Path, description = "From 1")),
    responses((status = 200, description = "The version.", body = VersionDetail)))]
pub(crate) async fn get(
    State(datasets): Topic<Datasets>,
    Path((name, version)): Path<(String, u64)>,
) -> Result<Json<VersionDetail>, Problem> {
    Ok(Json(VersionDetail {
        version: datasets.version(&name, version).await?,
        parts: datasets.catalogue.version_jobs(&name, version).await?,
    }))
}

/// Unseal a version. Its images are kept but no longer protected; its number is not reused.
#[utoipa::path(delete, path = "/v1/datasets/{name}/versions/{version}", tag = "datasets", operation_id = "unseal_version",
    params(("name" = String, Path, description = "Name of the dataset"), ("version" = u64, Path, description = "From 1")),
    responses((status = 204, description = "Unsealed.")))]
pub(crate) async fn delete(
    State(datasets): Topic<Datasets>,
    Path((name, version)): Path<(String, u64)>,
) -> Result<StatusCode, Problem> {
    datasets.unseal(&name, version).await?;
    Ok(StatusCode::NO_CONTENT)
}
