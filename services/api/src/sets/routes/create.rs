//! `POST /v1/sets`.

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
    /// Folder or `s3://BUCKET/PREFIX`, below a store that the service was started with.
    #[schema(example = "s3://reef/tour")]
    url: String,
}

impl NewSet {
    /// Reads a body; all that is wrong with it is reported together.
    fn parse(body: &[u8]) -> Result<Self, Problem> {
        let value = serde_json::from_slice(body);
        let value: Value = value.map_err(|error| Problem::new(Slug::InvalidBody, error.to_string()))?;
        let Value::Object(fields) = value else {
            return Err(Problem::new(
                Slug::InvalidBody,
                "the body is no object; send {\"url\": \"…\"}",
            ));
        };
        let mut errors = Vec::new();
        for name in fields.keys().filter(|name| *name != "url") {
            let message = format!("there is no field `{name}`; fields are url");
            errors.push(FieldError::new(&format!("/{name}"), message));
        }
        let limit = limits::SET_URL_BYTES;
        let url = match fields.get("url") {
            None => Err("`url` is missing".to_owned()),
            Some(Value::String(url)) if url.trim().is_empty() => Err("url is empty".to_owned()),
            Some(Value::String(url)) if url.len() > limit => {
                Err(format!("url has {} bytes, the limit is {limit}", url.len()))
            }
            Some(Value::String(url)) => Ok(url.clone()),
            Some(other) => Err(format!("url is {other} but must be a text")),
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
/// The images of its finished shards join a job of their own; their bytes stay in the set. The response comes when the job is
/// stored. Importing a set again changes nothing but that the service looks at once for what is new.
#[utoipa::path(post, path = "/v1/sets", tag = "sets", operation_id = "import_set",
    request_body(content = NewSet, content_type = "application/json"),
    responses((status = 202, description = "Its images are on their way; `Location` is the set.", body = SetView),
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
