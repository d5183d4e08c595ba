use crate::http::{Problem, Query, State, Topic, bounds};

use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use catalogue::{Catalogue, ImageQuery, Page};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::openapi::ImageRow;

/// Selection, columns and order of images.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only images of this dataset; `GET /v1/datasets` lists them.
    dataset: Option<String>,
    /// A condition over columns; `GET /v1/lists/columns` and `GET /v1/datasets/{name}` list them.
    #[param(example = r#"uiqm > 0.8 and water.style in ("muddy") and alpha between 0.2 and 0.6"#)]
    filter: Option<String>,
    /// A column to sort by; prefix `-` for descending order.
    #[param(example = "-uiqm")]
    order_by: Option<String>,
    /// Rows of the page, 1..=1000; a page of large rows ends before 8 MiB.
    #[param(default = 100, minimum = 1, maximum = 1000)]
    limit: Option<u32>,
    /// `next_cursor` of the previous page; the other parameters must be the same.
    cursor: Option<String>,
    /// Rows to skip, instead of a cursor.
    #[param(default = 0)]
    offset: Option<u64>,
    /// Columns of the response, separated by commas; absent: all with a value.
    #[param(example = "job,frame,alpha,uiqm")]
    fields: Option<String>,
}

/// Query images by their parameters and metrics.
#[utoipa::path(get, path = "/v1/images", tag = "images", operation_id = "list_images", params(Parameters),
    responses((status = 200, description = "A page of rows.", body = Page<ImageRow>)))]
pub(crate) async fn list(
    State(catalogue): Topic<Catalogue>,
    Query(query): Query<Parameters>,
) -> Result<impl IntoResponse, Problem> {
    let query = ImageQuery {
        dataset: query.dataset,
        filter: bounds::check_filter(query.filter)?,
        order_by: query.order_by,
        limit: bounds::check_rows(query.limit)?,
        cursor: query.cursor,
        offset: query.offset.unwrap_or_default(),
        fields: query
            .fields
            .as_deref()
            .map(bounds::split_names)
            .unwrap_or_default(),
    };
    let page = catalogue.images_as_json(query).await?;
    Ok(([(CONTENT_TYPE, "application/json")], page))
}
