use axum::http::StatusCode;
use client::SetView;
use serde_json::Value;
use spec::{FieldError, Invalid};
use utoipa::ToSchema;

use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, Slug, State, Topic};
use crate::limits;
use crate::sets::Sets;

/// A set to import.
#[derive(ToSchema)]
pub(crate) struct NewSet {
    /// Folder or `s3://BUCKET/PREFIX`, below one of the service's stores.
    #[schema(example = "s3://reef/tour")]
    url: String,
}

impl NewSet {
    /// Parses a body and reports all errors together.
    fn parse(body: &[u8]) -> Result<Self, Problem> {
        let value = serde_json::from_slice(body);
        let value: Value = value.map_err(|error| Problem::new(Slug::InvalidBody, error.to_string()))?;
        let Value::Object(fields) = value else {
            return Err(Problem::new(
                Slug::InvalidBody,
                "the body must be an object such as {\"url\": \"…\"}",
            ));
        };
        let mut errors = Vec::new();
        for name in fields.keys().filter(|name| *name != "url") {
            let message = format!("`{name}` is not a field; must be url");
            errors.push(FieldError::new(&format!("/{name}"), message));
        }
        let limit = limits::SET_URL_BYTES;
        let url = match fields.get("url") {
            None => Err("`url` is missing".to_owned()),
            Some(Value::String(url)) if url.trim().is_empty() => Err("url is empty".to_owned()),
            Some(Value::String(url)) if url.len() > limit => {
                Err(format!("url has {} bytes; must be at most {limit}", url.len()))
            }
            Some(Value::String(url)) => Ok(url.clone()),
            Some(other) => Err(format!("url is {other}; must be a string")),
        };
        match url {
            Ok(url) if errors.is_empty() => Ok(Self { url }),
            Ok(_) => Err(Invalid(errors).into()),
            Err(message) => {
                errors.push(FieldError::new("/url", message));
                Err(Invalid(errors).into())
            }
        }
    }
}

/// Import a set, and follow it while it grows.
///
/// The images of its finished shards join a separate job; their bytes stay in the set. The response is sent when the
/// job is stored. Importing a set again only polls it immediately.
#[utoipa::path(post, path = "/v1/sets", tag = "sets", operation_id = "import_set",
    request_body(content = NewSet, content_type = "application/json"),
    responses((status = 202, description = "The import has started; `Location` is the set.", body = SetView),
              (status = 409, response = crate::openapi::Problem),
              (status = 502, response = crate::openapi::Problem)))]
pub(crate) async fn create(
    State(sets): Topic<Sets>,
    JsonBytes(body): JsonBytes,
) -> Result<Located<SetView>, Problem> {
    let NewSet { url } = NewSet::parse(&body)?;
    let row = sets.import(url).await?;
    let location = format!("/v1/sets/{}", row.id);
    Ok(located(StatusCode::ACCEPTED, location, sets.view(row).await?))
}
