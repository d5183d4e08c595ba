//! RFC 9457 problems: every refusal of the service, and the only list of their types.

use std::fmt;

use axum::Json;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{AppendHeaders, IntoResponse, Response};
use serde_json::{Map, Value, json};
use spec::Invalid;

use crate::http::extract::Path;

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

            /// What the kind means.
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
    /// The description of a job or scene breaks rules; `errors` lists all of them with JSON pointers.
    Validation = "validation", UNPROCESSABLE_ENTITY, "The description is not valid";
    /// A query parameter is unknown, missing or of the wrong type.
    InvalidQuery = "invalid-query", BAD_REQUEST, "A query parameter is not valid";
    /// The filter does not parse or names an unknown column; `position` counts characters from 0.
    InvalidFilter = "invalid-filter", BAD_REQUEST, "The filter is not valid";
    /// The cursor was not made by this list.
    InvalidCursor = "invalid-cursor", BAD_REQUEST, "The cursor is not valid";
    /// A part of the path cannot be what it stands for.
    InvalidPath = "invalid-path", BAD_REQUEST, "The path is not valid";
    /// A request header has a value that cannot be used.
    InvalidHeader = "invalid-header", BAD_REQUEST, "A header is not valid";
    /// The body ended early or is not what its content type says.
    InvalidBody = "invalid-body", BAD_REQUEST, "The body cannot be read";
    /// No token, or one that is not known.
    Unauthorized = "unauthorized", UNAUTHORIZED, "A valid token is needed";
    /// The token lacks the scope that this request needs.
    Forbidden = "forbidden", FORBIDDEN, "The token does not allow this";
    /// A browser sent this from a page of another site.
    CrossOrigin = "cross-origin", FORBIDDEN, "Requests from other sites are refused";
    /// The `Host` header names another service; without tokens only the names of this machine and those of `--hosts` are known.
    UnknownHost = "unknown-host", MISDIRECTED_REQUEST, "This service has another name";
    /// No such route, job, image, artifact, dataset or scene.
    NotFound = "not-found", NOT_FOUND, "There is no such thing";
    /// The route exists, for other methods.
    MethodNotAllowed = "method-not-allowed", METHOD_NOT_ALLOWED, "The method is not allowed here";
    /// The client was too slow to send its request.
    RequestTimeout = "request-timeout", REQUEST_TIMEOUT, "The request took too long";
    /// The lease ended or was given to another worker; nothing was changed.
    StaleLease = "stale-lease", CONFLICT, "The lease is stale";
    /// The worker is not registered with this life of the service; register again.
    UnknownWorker = "unknown-worker", CONFLICT, "The worker is not registered";
    /// The job uses a style and no worker has an ONNX Runtime.
    RuntimeMissing = "runtime-missing", CONFLICT, "The runtime of the style models is missing";
    /// The frame could not be rendered; `detail` is the last error.
    RenderFailed = "render-failed", UNPROCESSABLE_ENTITY, "The frame cannot be rendered";
    /// The name belongs to something else, which is never replaced.
    NameTaken = "name-taken", CONFLICT, "The name is taken";
    /// Jobs need what is to be deleted; `detail` names one of them.
    InUse = "in-use", CONFLICT, "It is in use";
    /// The images belong to a sealed version of their dataset, which never changes; unseal it first.
    Sealed = "sealed", CONFLICT, "The images are sealed";
    /// What was asked for makes no sense for a job in this state, such as resuming one that has ended.
    JobState = "job-state", CONFLICT, "The job is in another state";
    /// The question needs longer than the limit; narrow it with a filter or a dataset.
    QueryTooSlow = "query-too-slow", UNPROCESSABLE_ENTITY, "The question takes too long";
    /// The same idempotency key was used with another description.
    IdempotencyKeyReused = "idempotency-key-reused", UNPROCESSABLE_ENTITY, "The idempotency key belongs to another job";
    /// The body is larger than the limit.
    TooLarge = "too-large", PAYLOAD_TOO_LARGE, "The body is too large";
    /// The body has another content type than this route takes.
    UnsupportedMediaType = "unsupported-media-type", UNSUPPORTED_MEDIA_TYPE, "The content type is not supported";
    /// The artifact is shorter than the first byte that was asked for.
    RangeNotSatisfiable = "range-not-satisfiable", RANGE_NOT_SATISFIABLE, "The range lies outside the artifact";
    /// Too many requests at once, or the service is stopping; try again after `Retry-After` seconds.
    Overloaded = "overloaded", SERVICE_UNAVAILABLE, "The service is too busy";
    /// The disk is full: reading goes on, writing works again when there is space.
    StorageFull = "storage-full", INSUFFICIENT_STORAGE, "The disk is full";
    /// Stored bytes do not match their digest; they are not served.
    CorruptArtifact = "corrupt-artifact", INTERNAL_SERVER_ERROR, "The stored bytes are damaged";
    /// The tar of the set that held the artifact is gone or holds other bytes; they are not served.
    SetChanged = "set-changed", GONE, "The set has changed";
    /// The store that holds the set does not respond or refuses access; the same request may succeed later.
    SetUnreachable = "set-unreachable", BAD_GATEWAY, "The set cannot be read";
    /// A fault of the service; the log has it under the same request id.
    Internal = "internal", INTERNAL_SERVER_ERROR, "The service failed";
}

/// A problem on its way to the client. The request id is added by the outermost layer.
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

    /// What is wrong this time.
    pub(crate) fn detail(&self) -> &str {
        &self.detail
    }

    /// Adds a member beside the standard ones.
    pub(crate) fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.more.insert(name.to_owned(), value.into());
        self
    }

    /// Adds a response header.
    pub(crate) fn header(mut self, name: HeaderName, value: HeaderValue) -> Self {
        self.headers.push((name, value));
        self
    }

    /// One invalid field, in the form that a description's errors have.
    pub(crate) fn field(pointer: &str, message: impl Into<String>) -> Self {
        let message = message.into();
        let errors = json!([{"pointer": pointer, "message": message}]);
        Self::new(Slug::Validation, message).with("errors", errors)
    }

    /// A fault that the client cannot fix: logged here with its cause, reported without it.
    pub(crate) fn internal(error: &dyn std::fmt::Display) -> Self {
        tracing::error!(%error, "the service failed");
        Self::new(
            Slug::Internal,
            "an unexpected fault; the service's log has the details",
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

/// Returns the row, or the problem that names what is missing.
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

/// `GET /problems/{slug}`: what the `type` of a problem means.
pub(crate) async fn describe(Path(name): Path<String>) -> Result<String, Problem> {
    let slug = Slug::ALL.iter().find(|slug| slug.name() == name);
    let slug = slug.ok_or_else(|| Problem::not_found(format!("no problem type `{name}`")))?;
    Ok(format!(
        "{} ({})\n\n{}\n",
        slug.title(),
        slug.status(),
        slug.meaning()
    ))
}

impl From<Invalid> for Problem {
    fn from(invalid: Invalid) -> Self {
        let detail = match invalid.0.as_slice() {
            [only] => only.message.clone(),
            errors => format!("{} errors", errors.len()),
        };
        let errors = serde_json::to_value(&invalid.0).unwrap_or_default();
        Self::new(Slug::Validation, detail).with("errors", errors)
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
