//! RFC 9457 problems: every error response of the service, and the list of their types.

use std::fmt;

use axum::Json;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{AppendHeaders, IntoResponse, Response};
use serde_json::{Map, Value, json};
use spec::Invalid;

macro_rules! slugs {
    ($($(#[doc = $doc:literal])+ $variant:ident = $slug:literal, $status:ident, $title:literal;)+) => {
        /// The kinds of problem. `type` is `/problems/<slug>`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Slug { $($(#[doc = $doc])+ $variant,)+ }

        impl Slug {
            /// Every kind, in the order of the documentation.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];

            /// The last segment of `type`.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $slug,)+ }
            }

            /// The title, the same for every problem of the kind.
            #[must_use]
            pub fn title(self) -> &'static str {
                match self { $(Self::$variant => $title,)+ }
            }

            /// Meaning of the kind.
            #[must_use]
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// The HTTP status.
            #[must_use]
            pub fn status(self) -> StatusCode {
                match self { $(Self::$variant => StatusCode::$status,)+ }
            }
        }
    };
}

slugs! {
    /// The description of a job or scene is invalid; `errors` lists all errors with JSON pointers.
    Validation = "validation", UNPROCESSABLE_ENTITY, "The description is not valid";
    /// A query parameter is unknown, missing or of the wrong type.
    InvalidQuery = "invalid-query", BAD_REQUEST, "A query parameter is not valid";
    /// The filter does not parse or names an unknown column, and `position` counts characters from 0; or `parameter` is the name of
    /// another parameter that is not valid.
    InvalidFilter = "invalid-filter", BAD_REQUEST, "The query is not valid";
    /// The cursor is not from this list.
    InvalidCursor = "invalid-cursor", BAD_REQUEST, "The cursor is not valid";
    /// A part of the path is malformed.
    InvalidPath = "invalid-path", BAD_REQUEST, "The path is not valid";
    /// A request header has an invalid value.
    InvalidHeader = "invalid-header", BAD_REQUEST, "A header is not valid";
    /// The body ended early or does not match its content type.
    InvalidBody = "invalid-body", BAD_REQUEST, "The body cannot be read";
    /// The token is missing or unknown.
    Unauthorized = "unauthorized", UNAUTHORIZED, "A valid token is needed";
    /// The token lacks the scope of this request.
    Forbidden = "forbidden", FORBIDDEN, "The token does not allow this";
    /// A browser sent this from a page of another site.
    CrossOrigin = "cross-origin", FORBIDDEN, "Requests from other sites are rejected";
    /// The `Host` header names another service. Without tokens only this machine's names and those of `--hosts` are
    /// accepted.
    UnknownHost = "unknown-host", MISDIRECTED_REQUEST, "This service has another name";
    /// No such route, job, image, artifact, dataset or scene.
    NotFound = "not-found", NOT_FOUND, "Not found";
    /// The route exists for other methods.
    MethodNotAllowed = "method-not-allowed", METHOD_NOT_ALLOWED, "The method is not allowed here";
    /// The client was too slow to send its request.
    RequestTimeout = "request-timeout", REQUEST_TIMEOUT, "The request took too long";
    /// The lease expired or was reassigned; the request had no effect.
    StaleLease = "stale-lease", CONFLICT, "The lease is stale";
    /// The worker is not registered since the service started; register again.
    UnknownWorker = "unknown-worker", CONFLICT, "The worker is not registered";
    /// The job uses a style and no worker has an ONNX Runtime.
    RuntimeMissing = "runtime-missing", CONFLICT, "The runtime of the style models is missing";
    /// The service was started without `--store`, so it imports no sharded datasets.
    ImportsDisabled = "imports-disabled", CONFLICT, "This service imports no sharded datasets";
    /// The frame could not be rendered; `detail` is the last error.
    RenderFailed = "render-failed", UNPROCESSABLE_ENTITY, "The frame cannot be rendered";
    /// The name is in use; existing items are never replaced.
    NameTaken = "name-taken", CONFLICT, "The name is taken";
    /// Jobs still need the item; `detail` names one of them.
    InUse = "in-use", CONFLICT, "It is in use";
    /// The images belong to a sealed version of their dataset; unseal it first.
    Sealed = "sealed", CONFLICT, "The images are sealed";
    /// The job's state does not allow this, such as resuming a job that has ended.
    JobState = "job-state", CONFLICT, "The job is in another state";
    /// The query exceeds the time limit; narrow it with a filter or a dataset.
    QueryTooSlow = "query-too-slow", UNPROCESSABLE_ENTITY, "The query takes too long";
    /// The same idempotency key was used with another description.
    IdempotencyKeyReused = "idempotency-key-reused", UNPROCESSABLE_ENTITY, "The idempotency key belongs to another job";
    /// A frame is expected to exceed the limit on slot time; `detail` has the figure and the limit.
    TooExpensive = "too-expensive", UNPROCESSABLE_ENTITY, "The frames are too expensive";
    /// The open jobs of this caller would exceed its limit; `detail` has the figures. Retry after some of
    /// them have ended.
    CallerLimit = "caller-limit", TOO_MANY_REQUESTS, "This caller has too much open work";
    /// The body is larger than the limit.
    TooLarge = "too-large", PAYLOAD_TOO_LARGE, "The body is too large";
    /// The content type is not supported by this route.
    UnsupportedMediaType = "unsupported-media-type", UNSUPPORTED_MEDIA_TYPE, "The content type is not supported";
    /// The artifact is shorter than the start of the requested range.
    RangeNotSatisfiable = "range-not-satisfiable", RANGE_NOT_SATISFIABLE, "The range lies outside the artifact";
    /// Too many concurrent requests, or the service is stopping; retry after `Retry-After` seconds.
    Overloaded = "overloaded", SERVICE_UNAVAILABLE, "The service is too busy";
    /// The disk is full. Reads still work; writes work again once there is space.
    StorageFull = "storage-full", INSUFFICIENT_STORAGE, "The disk is full";
    /// The disk refuses writes; `detail` has the reason. Nothing was stored; retry after `Retry-After` seconds.
    StorageFailed = "storage-failed", SERVICE_UNAVAILABLE, "The data folder cannot be written";
    /// Stored bytes do not match their digest; they are not served.
    CorruptArtifact = "corrupt-artifact", INTERNAL_SERVER_ERROR, "The stored bytes are damaged";
    /// The tar of the artifact's set is missing or has changed; its bytes are not served.
    SetChanged = "set-changed", GONE, "The set has changed";
    /// The store of the set does not respond or refuses access; a retry may succeed.
    SetUnreachable = "set-unreachable", BAD_GATEWAY, "The set cannot be read";
    /// An internal error; the log has it under the same request id.
    Internal = "internal", INTERNAL_SERVER_ERROR, "The service failed";
}

/// A problem. The outermost layer adds the request id.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    slug: Slug,
    detail: String,
    more: Map<String, Value>,
    headers: Vec<(HeaderName, HeaderValue)>,
}

impl Problem {
    pub(crate) fn new(slug: Slug, detail: impl Into<String>) -> Self {
        Self {
            slug,
            detail: detail.into(),
            more: Map::new(),
            headers: Vec::new(),
        }
    }

    /// Returns whether the problem is of this kind.
    pub(crate) fn is(&self, slug: Slug) -> bool {
        self.slug == slug
    }

    /// The description of this occurrence.
    pub(crate) fn detail(&self) -> &str {
        &self.detail
    }

    /// Adds an extension member.
    pub(crate) fn with_member(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.more.insert(name.to_owned(), value.into());
        self
    }

    /// Adds a response header.
    pub(crate) fn header(mut self, name: HeaderName, value: HeaderValue) -> Self {
        self.headers.push((name, value));
        self
    }

    /// One invalid field, in the format of description errors.
    pub(crate) fn field(pointer: &str, message: impl Into<String>) -> Self {
        let message = message.into();
        let errors = json!([{"pointer": pointer, "message": message}]);
        Self::new(Slug::Validation, message).with_member("errors", errors)
    }

    /// An internal error: logged here with its cause, reported without it.
    pub(crate) fn internal(error: &dyn std::fmt::Display) -> Self {
        tracing::error!(%error, "the service failed");
        Self::new(
            Slug::Internal,
            "an internal error; the service's log has the details",
        )
    }

    pub(crate) fn overloaded(detail: impl Into<String>) -> Self {
        Self::new(Slug::Overloaded, detail).header(header::RETRY_AFTER, HeaderValue::from_static("1"))
    }

    pub(crate) fn not_found(detail: impl Into<String>) -> Self {
        Self::new(Slug::NotFound, detail)
    }

    /// Renders the response; `instance` is the request id.
    pub(crate) fn render(self, instance: Option<&str>) -> Response {
        let status = self.slug.status();
        let mut body = self.more;
        body.insert("type".into(), format!("/problems/{}", self.slug.name()).into());
        body.insert("title".into(), self.slug.title().into());
        body.insert("status".into(), status.as_u16().into());
        body.insert("detail".into(), self.detail.into());
        if let Some(instance) = instance {
            body.insert("instance".into(), instance.into());
        }
        let content_type = [(header::CONTENT_TYPE, "application/problem+json")];
        (
            status,
            AppendHeaders(self.headers),
            content_type,
            Json(Value::Object(body)),
        )
            .into_response()
    }
}

/// Returns the row, or a not-found problem.
pub(crate) fn found<T>(row: Option<T>, what: &str, name: impl fmt::Display) -> Result<T, Problem> {
    row.ok_or_else(|| Problem::not_found(format!("no {what} `{name}`")))
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.slug.title(), self.detail)
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = self.slug.status().into_response();
        response.extensions_mut().insert(self);
        response
    }
}

impl From<Invalid> for Problem {
    fn from(invalid: Invalid) -> Self {
        let detail = match invalid.0.as_slice() {
            [only] => only.message.clone(),
            errors => format!("{} errors", errors.len()),
        };
        let errors = serde_json::to_value(&invalid.0).unwrap_or_default();
        Self::new(Slug::Validation, detail).with_member("errors", errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_unique_and_every_one_is_an_error() {
        let mut names: Vec<_> = Slug::ALL.iter().map(|slug| slug.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Slug::ALL.len());
        assert!(
            Slug::ALL
                .iter()
                .all(|slug| slug.status().as_u16() >= 400 && !slug.meaning().is_empty())
        );
    }
}
