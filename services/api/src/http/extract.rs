//! Extractors whose rejections are problems that name the offending input.

use std::time::Duration;

use axum::body::Bytes;
use axum::extract::rejection::{BytesRejection, PathRejection, QueryRejection};
use axum::extract::{FromRequest, FromRequestParts, Multipart, Request};
use axum::http::header::AsHeaderName;
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::auth::Caller;
use super::problem::{Problem, Slug};
use crate::limits;

/// Query parameters.
#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Query), rejection(Problem))]
pub(crate) struct Query<T>(pub(crate) T);

impl From<QueryRejection> for Problem {
    fn from(rejection: QueryRejection) -> Self {
        Self::new(Slug::InvalidQuery, cause(rejection.body_text()))
    }
}

/// Path parameters.
#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Path), rejection(Problem))]
pub(crate) struct Path<T>(pub(crate) T);

impl From<PathRejection> for Problem {
    fn from(rejection: PathRejection) -> Self {
        Self::new(Slug::InvalidPath, cause(rejection.body_text()))
    }
}

/// The unparsed body of a JSON request. The description's parser is stricter than serde's.
pub(crate) struct JsonBytes(pub(crate) Bytes);

impl<S: Send + Sync> FromRequest<S> for JsonBytes {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        // Blocks cross-site requests as well: a browser sends a preflight before this content type.
        media_type(request.headers(), "application/json")?;
        Ok(Self(body(request, state).await?))
    }
}

/// The unread fields of a multipart form.
pub(crate) struct MultipartBody(pub(crate) Multipart);

impl<S: Send + Sync> FromRequest<S> for MultipartBody {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        media_type(request.headers(), "multipart/form-data")?;
        let form = Multipart::from_request(request, state).await;
        Ok(Self(form.map_err(|rejection| {
            Problem::new(Slug::InvalidBody, rejection.body_text())
        })?))
    }
}

/// A checked protobuf message. Routes only see valid messages.
pub(crate) struct Protobuf<M>(pub(crate) M);

impl<M: wire::Checked, S: Send + Sync> FromRequest<S> for Protobuf<M> {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        media_type(request.headers(), wire::CONTENT_TYPE)?;
        Ok(Self(wire::decode(&body(request, state).await?)?))
    }
}

impl<M: prost::Message> IntoResponse for Protobuf<M> {
    fn into_response(self) -> Response {
        let content_type = [(header::CONTENT_TYPE, wire::CONTENT_TYPE)];
        (content_type, self.0.encode_to_vec()).into_response()
    }
}

/// The submitter of a description, and its idempotency key.
pub(crate) struct Submitter {
    pub(crate) owner: String,
    pub(crate) idempotency_key: Option<String>,
}

impl<S: Send + Sync> FromRequestParts<S> for Submitter {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let caller = parts.extensions.get::<Caller>();
        let owner = caller.ok_or_else(|| Problem::internal(&"a route that asks for no scope"))?;
        let mut keys = parts.headers.get_all("idempotency-key").iter();
        let (key, another) = (keys.next(), keys.next());
        if another.is_some() {
            return Err(invalid_key("occurs more than once; send one"));
        }
        let key = key.map(|value| {
            let key = value.to_str().map_err(|_| invalid_key("is not visible ASCII"))?;
            match key.len() {
                1..=limits::IDEMPOTENCY_KEY_BYTES => Ok(key.to_owned()),
                length => Err(invalid_key(&format!(
                    "has {length} characters; must have 1 to {}",
                    limits::IDEMPOTENCY_KEY_BYTES
                ))),
            }
        });
        Ok(Self {
            owner: owner.owner.clone(),
            idempotency_key: key.transpose()?,
        })
    }
}

fn invalid_key(problem: &str) -> Problem {
    Problem::new(Slug::InvalidHeader, format!("Idempotency-Key {problem}"))
}

/// `Prefer: wait=N` (RFC 7240): how long the client wants to wait for the result.
pub(crate) struct PreferredWait(pub(crate) Option<Duration>);

impl<S: Send + Sync> FromRequestParts<S> for PreferredWait {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let mut waits = listed(&parts.headers, "prefer").filter_map(|preference| {
            let (name, value) = preference.split_once('=')?;
            name.trim()
                .eq_ignore_ascii_case("wait")
                .then(|| value.trim().to_owned())
        });
        let Some(wait) = waits.next() else {
            return Ok(Self(None));
        };
        let seconds: u64 = wait.parse().map_err(|_| {
            Problem::new(
                Slug::InvalidHeader,
                format!("Prefer: wait is `{wait}`; must be a whole number of seconds"),
            )
        })?;
        Ok(Self(Some(Duration::from_secs(seconds).min(limits::MAX_WAIT))))
    }
}

/// The elements of a list header, over all its lines.
pub(crate) fn listed(headers: &HeaderMap, name: impl AsHeaderName) -> impl Iterator<Item = &str> {
    let lines = headers.get_all(name).into_iter();
    let lines = lines.filter_map(|value| value.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(str::trim)
}

async fn body<S: Send + Sync>(request: Request, state: &S) -> Result<Bytes, Problem> {
    Bytes::from_request(request, state)
        .await
        .map_err(|rejection: BytesRejection| match rejection.status() {
            StatusCode::PAYLOAD_TOO_LARGE => {
                Problem::new(Slug::TooLarge, "the body exceeds the limit of this route")
            }
            _ => Problem::new(Slug::InvalidBody, rejection.body_text()),
        })
}

/// Checks the content type and rejects compressed bodies, whose length does not bound their decompressed size.
fn media_type(headers: &HeaderMap, wanted: &str) -> Result<(), Problem> {
    if let Some(encoding) = headers
        .get(header::CONTENT_ENCODING)
        .filter(|it| *it != "identity")
    {
        let encoding = String::from_utf8_lossy(encoding.as_bytes());
        return Err(Problem::new(
            Slug::UnsupportedMediaType,
            format!("the content encoding is `{encoding}`; send the body uncompressed"),
        ));
    }
    let given = headers
        .get(header::CONTENT_TYPE)
        .map(|value| String::from_utf8_lossy(value.as_bytes()));
    let essence = given
        .as_deref()
        .and_then(|text| text.split(';').next())
        .map(str::trim);
    if essence.is_some_and(|text| text.eq_ignore_ascii_case(wanted)) {
        return Ok(());
    }
    let given = essence.map_or_else(|| "missing".to_owned(), |text| format!("`{text}`"));
    Err(Problem::new(
        Slug::UnsupportedMediaType,
        format!("the content type is {given}; send `{wanted}`"),
    ))
}

/// The part of a rejection's text that names the field.
fn cause(text: String) -> String {
    text.split_once(": ")
        .map_or_else(|| text.clone(), |(_, cause)| cause.to_owned())
}
