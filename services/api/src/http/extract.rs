//! Extractors whose refusals are problems that name what was refused.

use std::marker::PhantomData;
use std::time::Duration;

use axum::RequestPartsExt;
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{FromRequest, FromRequestParts, Multipart, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use proto::MessageError;
use serde::de::DeserializeOwned;

use super::auth::Caller;
use super::problem::{Problem, Slug};
use crate::limits;

/// Query parameters.
pub(crate) struct Query<T>(pub(crate) T);

impl<T: DeserializeOwned + 'static, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        match parts.extract::<axum::extract::Query<T>>().await {
            Ok(axum::extract::Query(query)) => Ok(Self(query)),
            Err(rejection) => Err(Problem::new(Slug::InvalidQuery, cause(rejection.body_text()))),
        }
    }
}

/// Parts of the path.
pub(crate) struct Path<T>(pub(crate) T);

impl<T: DeserializeOwned + Send + 'static, S: Send + Sync> FromRequestParts<S> for Path<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        match parts.extract::<axum::extract::Path<T>>().await {
            Ok(axum::extract::Path(path)) => Ok(Self(path)),
            Err(rejection) => Err(Problem::new(Slug::InvalidPath, cause(rejection.body_text()))),
        }
    }
}

/// The body of a JSON request, unread: the description's own reader is stricter than a common one.
pub(crate) struct JsonBytes(pub(crate) Bytes);

impl<S: Send + Sync> FromRequest<S> for JsonBytes {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        // Also keeps other sites' pages out: a browser asks before it sends this content type across sites.
        media_type(request.headers(), "application/json")?;
        Ok(Self(body(request, state).await?))
    }
}

/// The fields of a multipart form, unread.
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

/// A message of a worker, decoded from its wire form and checked: no route sees one that is not.
pub(crate) struct Checked<W, M>(pub(crate) M, pub(crate) PhantomData<W>);

impl<W, M, S> FromRequest<S> for Checked<W, M>
where
    W: prost::Message + Default,
    M: TryFrom<W, Error = MessageError>,
    S: Send + Sync,
{
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        media_type(request.headers(), proto::CONTENT_TYPE)?;
        let bytes = body(request, state).await?;
        Ok(Self(proto::decode(&bytes)?, PhantomData))
    }
}

/// A protobuf message as an answer.
pub(crate) struct ProtoBody<M>(pub(crate) M);

impl<M: prost::Message> IntoResponse for ProtoBody<M> {
    fn into_response(self) -> Response {
        (
            [(header::CONTENT_TYPE, proto::CONTENT_TYPE)],
            self.0.encode_to_vec(),
        )
            .into_response()
    }
}

/// Who submits a description, and the key under which a repeat of it finds the same job.
pub(crate) struct Submitter {
    pub(crate) owner: String,
    pub(crate) idempotency_key: Option<String>,
}

impl<S: Send + Sync> FromRequestParts<S> for Submitter {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let caller = parts.extensions.get::<Caller>();
        let owner = caller.ok_or_else(|| Problem::internal(&"a route that asks for no scope"))?;
        let refuse = |why: String| Problem::new(Slug::InvalidHeader, format!("Idempotency-Key {why}"));
        let key = parts.headers.get("idempotency-key").map(|value| {
            let key = value
                .to_str()
                .map_err(|_| refuse("is not visible ASCII".to_owned()))?;
            match key.len() {
                1..=limits::IDEMPOTENCY_KEY_BYTES => Ok(key.to_owned()),
                length => Err(refuse(format!(
                    "has {length} characters, the limit is 1..={}",
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

/// `Prefer: wait=N` (RFC 7240): how long the client wants to wait for the result.
pub(crate) struct PreferredWait(pub(crate) Option<Duration>);

impl<S: Send + Sync> FromRequestParts<S> for PreferredWait {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let preferences = parts
            .headers
            .get_all("prefer")
            .into_iter()
            .filter_map(|value| value.to_str().ok());
        let mut waits = preferences.flat_map(|line| line.split(',')).filter_map(|one| {
            let (name, value) = one.split_once('=')?;
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
                format!("Prefer: wait is `{wait}` but must be a whole number of seconds"),
            )
        })?;
        Ok(Self(Some(Duration::from_secs(seconds).min(limits::MAX_WAIT))))
    }
}

async fn body<S: Send + Sync>(request: Request, state: &S) -> Result<Bytes, Problem> {
    Bytes::from_request(request, state)
        .await
        .map_err(|rejection: BytesRejection| match rejection.status() {
            StatusCode::PAYLOAD_TOO_LARGE => {
                Problem::new(Slug::TooLarge, "the body is larger than this route takes")
            }
            _ => Problem::new(Slug::InvalidBody, rejection.body_text()),
        })
}

/// Also refuses compressed bodies: what they unpack to has no limit that their length tells.
fn media_type(headers: &HeaderMap, wanted: &str) -> Result<(), Problem> {
    if let Some(encoding) = headers
        .get(header::CONTENT_ENCODING)
        .filter(|it| *it != "identity")
    {
        let encoding = String::from_utf8_lossy(encoding.as_bytes());
        return Err(Problem::new(
            Slug::UnsupportedMediaType,
            format!("the content encoding is `{encoding}`; send the body as it is"),
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
