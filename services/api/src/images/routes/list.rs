//! `GET /v1/images`.

use axum::Json;
use axum::extract::State;
use catalogue::ImageQuery;
use serde::Deserialize;
use serde_json::Value;
use utoipa::IntoParams;

use crate::app::Shared;
use crate::http::extract::Query;
use crate::http::paging::{Page, rows};
use crate::http::problem::{Problem, Slug};
use crate::limits;

/// Which images, which columns, in which order.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only images of this dataset.
    dataset: Option<String>,
    /// A condition over parameters and metrics.
    #[param(example = r#"uiqm > 0.8 and water.style in ("muddy") and alpha between 0.2 and 0.6"#)]
    filter: Option<String>,
    /// A column; with `-` before it the largest comes first.
    #[param(example = "-uiqm")]
    order_by: Option<String>,
    /// Rows of the page, 1..=1000.
    #[param(default = 100)]
    limit: Option<u32>,
    /// `next_cursor` of the page before; the other parameters must be the same.
    cursor: Option<String>,
    /// Columns of the answer, separated by commas; absent: all that have a value.
    #[param(example = "job,frame,alpha,uiqm")]
    fields: Option<String>,
}

/// Query images by their parameters and metrics.
#[utoipa::path(get, path = "/v1/images", tag = "images", params(Parameters),
    responses((status = 200, description = "A page of rows.", body = Page<Value>)))]
pub(crate) async fn list(
    State(app): State<Shared>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Page<Value>>, Problem> {
    let fields = asked
        .fields
        .iter()
        .flat_map(|list| list.split(','))
        .map(|name| name.trim().to_owned())
        .collect();
    let query = ImageQuery {
        dataset: asked.dataset,
        filter: checked_filter(asked.filter)?,
        order_by: asked.order_by,
        limit: rows(asked.limit)?,
        cursor: asked.cursor,
        fields,
    };
    let page = app.catalogue.images(query).await?;
    Ok(Json(Page {
        items: page.items,
        next_cursor: page.next_cursor,
    }))
}

/// A filter of bearable length; an empty one is none.
pub(crate) fn checked_filter(filter: Option<String>) -> Result<Option<String>, Problem> {
    match filter {
        Some(text) if text.len() > limits::FILTER_BYTES => {
            let detail = format!(
                "the filter has {} bytes, the limit is {}",
                text.len(),
                limits::FILTER_BYTES
            );
            Err(Problem::new(Slug::InvalidFilter, detail))
        }
        filter => Ok(filter.filter(|text| !text.trim().is_empty())),
    }
}
