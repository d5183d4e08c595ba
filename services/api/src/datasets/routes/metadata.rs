use std::borrow::Cow;
use std::sync::Arc;

use axum::response::Response;
use catalogue::{Catalogue, ImageQuery};
use serde::Deserialize;
use serde_json::Value;
use utoipa::IntoParams;

use crate::http::lines::{self, Batch};
use crate::http::{Path, Problem, Query, State, Topic, bounds};
use crate::limits::ROWS_BATCH;

/// Selection of images.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only images that match this filter.
    #[param(example = "uiqm > 0.8")]
    filter: Option<String>,
}

/// Export the metadata of a dataset's images, one JSON object per line.
///
/// Parameters, labels, metrics, counts, digests of the artifacts. Every row has the same members. Damaged
/// rows are left out and named in the header `Fathom-Damaged`. If one is found after the header was sent, the response is
/// cut short; a repeated request leaves it out.
#[utoipa::path(get, path = "/v1/datasets/{name}/metadata.jsonl", tag = "datasets", operation_id = "export_metadata_jsonl",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "One object per line.", content_type = "application/x-ndjson", body = String)))]
pub(crate) async fn jsonl(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Response, Problem> {
    let table = Table::open(catalogue, name, query).await?;
    table
        .stream(lines::NDJSON, Vec::new(), |_, rows| lines::json_lines(rows))
        .await
}

/// Export the metadata of a dataset's images as CSV.
///
/// The first line has the column names; absent values are empty. Text that a spreadsheet would read as a formula is
/// prefixed with an apostrophe. Damaged rows are left out and named in the header `Fathom-Damaged`. If one is found after
/// the header was sent, the response is cut short; a repeated request leaves it out.
#[utoipa::path(get, path = "/v1/datasets/{name}/metadata.csv", tag = "datasets", operation_id = "export_metadata_csv",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "RFC 4180.", content_type = "text/csv", body = String)))]
pub(crate) async fn csv(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Response, Problem> {
    let table = Table::open(catalogue, name, query).await?;
    let head = record(table.columns.iter().map(|name| quoted(name)));
    let media_type = "text/csv; charset=utf-8; header=present";
    table
        .stream(media_type, head.into_bytes(), |columns, rows| {
            Ok(records(columns, &rows))
        })
        .await
}

/// A query for all rows of a dataset.
struct Table {
    catalogue: Arc<Catalogue>,
    dataset: String,
    filter: Option<String>,
    columns: Vec<String>,
}

/// Converts rows to bytes; receives the column names.
type Write = fn(&[String], Vec<Value>) -> Result<Vec<u8>, Problem>;

impl Table {
    async fn open(catalogue: Arc<Catalogue>, dataset: String, query: Parameters) -> Result<Self, Problem> {
        super::dataset::row(&catalogue, &dataset).await?;
        let columns = catalogue.columns(&dataset).await?.into_iter();
        Ok(Self {
            filter: bounds::check_filter(query.filter)?,
            columns: columns.map(|column| column.name).collect(),
            dataset,
            catalogue,
        })
    }

    async fn stream(
        self,
        media_type: &'static str,
        mut head: Vec<u8>,
        write: Write,
    ) -> Result<Response, Problem> {
        let mut first = self.batch(None, write).await?;
        head.append(&mut first.bytes);
        first.bytes = head;
        let known = self.known_damage().await?;
        let table = Arc::new(self);
        Ok(lines::respond(media_type, first, known, move |cursor| {
            let table = Arc::clone(&table);
            async move { table.batch(Some(cursor), write).await }
        }))
    }

    async fn batch(&self, cursor: Option<String>, write: Write) -> Result<Batch<String>, Problem> {
        let query = ImageQuery {
            dataset: Some(self.dataset.clone()),
            filter: self.filter.clone(),
            order_by: None,
            limit: ROWS_BATCH,
            cursor,
            offset: 0,
            fields: self.columns.clone(),
        };
        let page = self.catalogue.images(query).await?;
        Ok(Batch {
            bytes: write(&self.columns, page.items)?,
            next: page.next_cursor,
            damaged: page.damaged,
        })
    }

    /// Rows of the dataset that were found damaged before.
    async fn known_damage(&self) -> Result<Vec<String>, Problem> {
        let dataset = self.dataset.split('@').next();
        let mut known = Vec::new();
        for damage in self.catalogue.damaged_images() {
            let job = self.catalogue.job(&damage.image.job).await?;
            if job.is_some_and(|job| Some(job.dataset.as_str()) == dataset) {
                known.push(damage.what);
            }
        }
        Ok(known)
    }
}

fn records(columns: &[String], rows: &[Value]) -> Vec<u8> {
    rows.iter()
        .map(|row: &Value| record(columns.iter().map(|name| cell(row.get(name)))))
        .collect::<String>()
        .into_bytes()
}

fn record(cells: impl Iterator<Item = String>) -> String {
    cells.collect::<Vec<_>>().join(",") + "\r\n"
}

fn cell(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => quoted(&plain(text)),
        Some(other) => quoted(&other.to_string()),
    }
}

/// Prefixes text that a spreadsheet would read as a formula with an apostrophe.
fn plain(text: &str) -> Cow<'_, str> {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        format!("'{text}").into()
    } else {
        text.into()
    }
}

fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn no_text_is_a_formula_and_no_number_changes() {
        for formula in ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1"] {
            assert_eq!(cell(Some(&json!(formula))), format!("'{formula}"));
        }
        assert_eq!(cell(Some(&json!("=A1,\"x\""))), "\"'=A1,\"\"x\"\"\"");
        assert_eq!(cell(Some(&json!(-1.5))), "-1.5");
        assert_eq!(cell(Some(&json!("a=b"))), "a=b");
    }

    #[test]
    fn cells_are_quoted_if_necessary_and_empty_if_absent() {
        let columns = ["a", "b", "c", "d"].map(str::to_owned);
        let rows = [
            json!({"a": "x, \"y\"\n", "b": 1.5, "c": null}),
            json!({"d": true}),
        ];
        let text = String::from_utf8(records(&columns, &rows)).unwrap();
        assert_eq!(text, "\"x, \"\"y\"\"\n\",1.5,,\r\n,,,true\r\n");
    }
}
