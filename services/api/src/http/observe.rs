//! The outermost layer: request id, log line, problems, panics, cross-site check.
//!
//! `tower-http` has layers for request ids, panics and logs. They are not used: every response here is a problem
//! document with the request id, and one function does this with less code than the layers and their adapters.

use std::any::Any;
use std::panic::AssertUnwindSafe;
use std::time::Instant;

use axum::extract::{MatchedPath, Request};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use futures::FutureExt;
use tracing::Instrument;

use super::problem::{Problem, Slug};
use crate::clock::ordered_id;
use crate::telemetry;

/// Maximum length of a client's request id.
const REQUEST_ID_BYTES: usize = 64;

/// The outermost layer: assigns the request id, turns problems and panics into responses, writes the log line.
pub(crate) async fn observe(request: Request, next: Next) -> Response {
    let id = request_id(request.headers());
    let method = request.method().clone();
    let path = request.uri().path().to_owned();
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("unmatched", MatchedPath::as_str)
        .to_owned();
    let start = Instant::now();
    let span = tracing::info_span!("request", id);
    let work = async {
        if crosses_sites(&request) {
            Problem::new(Slug::CrossOrigin, "the request comes from a page of another site").into_response()
        } else {
            next.run(request).await
        }
    };
    let response = AssertUnwindSafe(work.instrument(span.clone()))
        .catch_unwind()
        .await
        .unwrap_or_else(report_panic);
    let mut response = as_problem(response, &id);
    let seconds = start.elapsed().as_secs_f64();
    let status = response.status().as_u16();
    telemetry::request(&method, &route, status, seconds);
    let ms = seconds * 1e3;
    // Polling by workers, probes and followers is frequent. Errors are always logged.
    let is_read = method == Method::GET || method == Method::HEAD;
    let is_routine = is_read || route.starts_with("/v1/worker/") || !route.starts_with("/v1/");
    if is_routine && status < 500 {
        span.in_scope(|| tracing::debug!(%method, path, status, ms, "answered"));
    } else {
        span.in_scope(|| tracing::info!(%method, path, status, ms, "answered"));
    }
    if let Ok(value) = HeaderValue::from_str(&id) {
        response.headers_mut().insert("x-request-id", value);
    }
    response
}

fn request_id(headers: &HeaderMap) -> String {
    let given = headers.get("x-request-id").and_then(|value| value.to_str().ok());
    given
        .filter(|id: &&str| {
            (1..=REQUEST_ID_BYTES).contains(&id.len())
                && id
                    .bytes()
                    .all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte))
        })
        .map_or_else(|| format!("req_{}", ordered_id().simple()), str::to_owned)
}

/// Whether a browser sent this from a page of another site. A service without tokens on loopback would otherwise
/// accept it.
fn crosses_sites(request: &Request) -> bool {
    if [Method::GET, Method::HEAD, Method::OPTIONS].contains(request.method()) {
        return false;
    }
    let Some(origin) = request.headers().get(header::ORIGIN) else {
        return false;
    };
    let host = request.headers().get(header::HOST).map(HeaderValue::as_bytes);
    let site = origin
        .to_str()
        .ok()
        .and_then(|text| text.split_once("://"))
        .map(|(_, site)| site.as_bytes());
    site.is_none() || site != host
}

fn report_panic(payload: Box<dyn Any + Send>) -> Response {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    Problem::internal(&format!("panic: {}", text.unwrap_or_default())).into_response()
}

/// Renders a problem. Any other error response, such as an unsupported method, becomes one.
fn as_problem(mut response: Response, id: &str) -> Response {
    if let Some(problem) = response.extensions_mut().remove::<Problem>() {
        return problem.render(Some(id));
    }
    let slug = match response.status() {
        status if !status.is_client_error() && !status.is_server_error() => return response,
        StatusCode::NOT_FOUND => Slug::NotFound,
        StatusCode::METHOD_NOT_ALLOWED => Slug::MethodNotAllowed,
        StatusCode::PAYLOAD_TOO_LARGE => Slug::TooLarge,
        StatusCode::UNSUPPORTED_MEDIA_TYPE => Slug::UnsupportedMediaType,
        status if status.is_client_error() => Slug::InvalidBody,
        _ => Slug::Internal,
    };
    let allow = response.headers_mut().remove(header::ALLOW);
    let problem = Problem::new(slug, "see /openapi.json for routes and methods");
    let problem = match allow {
        Some(allow) => problem.header(header::ALLOW, allow),
        None => problem,
    };
    problem.render(Some(id))
}

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    #[test]
    fn only_pages_of_other_sites_are_refused() {
        let request = |origin: Option<&str>| {
            let mut request = Request::post("/")
                .header("host", "localhost:7311")
                .body(Body::empty())
                .unwrap();
            if let Some(origin) = origin {
                request.headers_mut().insert("origin", origin.parse().unwrap());
            }
            request
        };
        assert!(!crosses_sites(&request(None)));
        assert!(!crosses_sites(&request(Some("http://localhost:7311"))));
        assert!(crosses_sites(&request(Some("http://evil.example"))));
        assert!(crosses_sites(&request(Some("null"))));
    }
}
