//! Blocking HTTP with a bearer token; problems (RFC 9457) are errors.

use std::io::Read;
use std::time::Duration;

use serde_json::Value;
use ureq::http::{Response, StatusCode};
use ureq::{Agent, AsSendBody, Body, RequestBuilder};

use crate::proxy::{InvalidProxy, choose_proxy};

const CONNECT_LIMIT: Duration = Duration::from_secs(5);
/// The largest file: the artifacts of a frame (512 MiB) as a tar, with its record.
const FILE_BYTES: u64 = 528 << 20;
/// The largest document, and the largest file of undeclared length: a page of rows ends before 8 MiB.
pub(crate) const DOCUMENT_BYTES: u64 = 64 << 20;
/// The largest problem: a description has at most thousands of errors.
const PROBLEM_BYTES: u64 = 1 << 20;

/// A connection to a service; cheap to clone, shared by threads.
#[derive(Clone)]
pub struct Http {
    agent: Agent,
    base: String,
    /// Host and port of the proxy, if the environment has one for the service.
    proxy: Option<String>,
    /// The reason why no request can be sent.
    invalid_proxy: Option<InvalidProxy>,
    authorization: Option<String>,
}

/// A response of success.
pub struct Reply {
    /// Below 400.
    pub status: StatusCode,
    /// The body.
    pub bytes: Vec<u8>,
}

/// Why a request failed.
#[derive(Debug)]
pub enum HttpError {
    /// No response, or one that broke off.
    Unreachable(ureq::Error),
    /// A response of 400 and above.
    Problem(Problem),
}

/// The problem document of a refused request; empty if the body is not one.
#[derive(Debug)]
pub struct Problem {
    /// 400 and above.
    pub status: StatusCode,
    body: Value,
}

impl Problem {
    /// Reads the body of a response.
    #[must_use]
    pub fn new(status: StatusCode, body: &[u8]) -> Self {
        Self {
            status,
            body: serde_json::from_slice(body).unwrap_or_default(),
        }
    }

    /// Whether the service is overloaded, so that the same request may succeed after a pause.
    #[must_use]
    pub fn is_temporary(&self) -> bool {
        matches!(self.status.as_u16(), 429 | 503)
    }

    /// Whether its type is this one.
    #[must_use]
    pub fn is(&self, slug: &str) -> bool {
        self.text("type").is_some_and(|kind| kind.ends_with(slug))
    }

    /// Title and detail, then every field error on a separate line. A single error is the detail already.
    #[must_use]
    pub fn message(&self) -> String {
        let mut message = match (self.text("title"), self.text("detail")) {
            (Some(title), Some(detail)) => format!("{title}: {detail}"),
            (Some(text), None) | (None, Some(text)) => text.to_owned(),
            (None, None) => format!("the service responded with status {}", self.status.as_u16()),
        };
        let errors = self.body.get("errors").and_then(Value::as_array);
        for error in errors.into_iter().flatten() {
            let part = |name: &str| error.get(name).and_then(Value::as_str);
            let place = part("pointer").unwrap_or_default();
            let text = part("message").unwrap_or_default();
            if self.text("detail") != Some(text) {
                message.push_str(&format!("\n  {place} {text}"));
            }
            if let Some(near) = part("did_you_mean") {
                message.push_str(&format!(" (did you mean `{near}`?)"));
            }
        }
        message
    }

    /// The document itself; null if the body is not JSON.
    #[must_use]
    pub fn document(&self) -> &Value {
        &self.body
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.body.get(name).and_then(Value::as_str)
    }
}

impl Http {
    /// A client of the service at this URL, `http` unless it has a scheme; every request ends within `limit`.
    #[must_use]
    pub fn new(base: &str, token: Option<&str>, limit: Duration) -> Self {
        let base = match base.contains("://") {
            true => base.to_owned(),
            false => format!("http://{base}"),
        };
        let (proxy, invalid_proxy) = match choose_proxy(&base) {
            Ok(proxy) => (proxy, None),
            Err(invalid) => (None, Some(invalid)),
        };
        let shown = proxy
            .as_ref()
            .map(|proxy| format!("{}:{}", proxy.host(), proxy.port()));
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .proxy(proxy)
            .timeout_connect(Some(CONNECT_LIMIT))
            .timeout_global(Some(limit))
            .build();
        Self {
            agent: config.into(),
            base: base.trim_end_matches('/').to_owned(),
            proxy: shown,
            invalid_proxy,
            authorization: token.map(|token| format!("Bearer {token}")),
        }
    }

    /// The URL of the service.
    #[must_use]
    pub fn base(&self) -> &str {
        &self.base
    }

    /// Host and port of the proxy that requests use.
    #[must_use]
    pub fn proxy(&self) -> Option<&str> {
        self.proxy.as_deref()
    }

    /// GET of a file.
    ///
    /// # Errors
    /// [`HttpError`].
    pub fn get(&self, path: &str) -> Result<Reply, HttpError> {
        self.get_within(path, FILE_BYTES)
    }

    /// GET of a document, which is shorter than a file may be.
    ///
    /// # Errors
    /// [`HttpError`].
    pub fn get_document(&self, path: &str) -> Result<Reply, HttpError> {
        self.get_within(path, DOCUMENT_BYTES)
    }

    fn get_within(&self, path: &str, most: u64) -> Result<Reply, HttpError> {
        self.check_proxy()?;
        let request = self.agent.get(format!("{}{path}", self.base));
        reply(self.with_headers(request, &[]).call(), most)
    }

    /// GET of a body that is read as it arrives.
    ///
    /// # Errors
    /// [`HttpError`].
    pub fn stream(&self, path: &str) -> Result<impl Read + use<>, HttpError> {
        self.check_proxy()?;
        let request = self.agent.get(format!("{}{path}", self.base));
        let response = self.with_headers(request, &[]).call();
        let response = response.map_err(HttpError::Unreachable)?;
        if response.status().as_u16() < 400 {
            return Ok(response.into_body().into_reader());
        }
        match reply(Ok(response), PROBLEM_BYTES) {
            Ok(reply) => Err(HttpError::Problem(Problem::new(reply.status, &reply.bytes))),
            Err(error) => Err(error),
        }
    }

    /// POST.
    ///
    /// # Errors
    /// [`HttpError`].
    pub fn post(
        &self,
        path: &str,
        headers: &[(&str, &str)],
        body: impl AsSendBody,
    ) -> Result<Reply, HttpError> {
        self.check_proxy()?;
        let request = self.agent.post(format!("{}{path}", self.base));
        reply(self.with_headers(request, headers).send(body), DOCUMENT_BYTES)
    }

    /// DELETE.
    ///
    /// # Errors
    /// [`HttpError`].
    pub fn delete(&self, path: &str) -> Result<Reply, HttpError> {
        self.check_proxy()?;
        let request = self.agent.delete(format!("{}{path}", self.base));
        reply(self.with_headers(request, &[]).call(), DOCUMENT_BYTES)
    }

    fn check_proxy(&self) -> Result<(), HttpError> {
        match &self.invalid_proxy {
            Some(invalid) => Err(HttpError::Unreachable(invalid.clone().into())),
            None => Ok(()),
        }
    }

    fn with_headers<Any>(
        &self,
        request: RequestBuilder<Any>,
        headers: &[(&str, &str)],
    ) -> RequestBuilder<Any> {
        let token = self
            .authorization
            .as_deref()
            .map(|token| ("authorization", token));
        let headers = headers.iter().copied().chain(token);
        headers.fold(request, |request, (name, value)| request.header(name, value))
    }
}

/// Reads a response of at most this many bytes; without a declared length, at most those of a document.
fn reply(response: Result<Response<Body>, ureq::Error>, most: u64) -> Result<Reply, HttpError> {
    let mut response = response.map_err(HttpError::Unreachable)?;
    let status = response.status();
    let declared = response.body().content_length();
    let limit = match (status.as_u16(), declared) {
        (400.., _) => PROBLEM_BYTES,
        (_, Some(_)) => most,
        (_, None) => most.min(DOCUMENT_BYTES),
    };
    if declared.is_some_and(|length| length > limit) {
        return Err(HttpError::Unreachable(ureq::Error::BodyExceedsLimit(limit)));
    }
    let body = response.body_mut().with_config().limit(limit);
    let bytes = body.read_to_vec().map_err(HttpError::Unreachable)?;
    match status.as_u16() {
        ..400 => Ok(Reply { status, bytes }),
        _ => Err(HttpError::Problem(Problem::new(status, &bytes))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_validation_problem_lists_every_field_error() {
        let body = br#"{"type": "/problems/validation", "title": "Invalid job", "detail": "2 errors",
            "errors": [{"pointer": "/alpha", "message": "alpha is 1.2 but at most 1"},
                       {"pointer": "/water/stile", "message": "unknown field", "did_you_mean": "style"}]}"#;
        let problem = Problem::new(StatusCode::UNPROCESSABLE_ENTITY, body);
        assert!(problem.is("validation") && !problem.is("stale-lease"));
        assert_eq!(
            problem.message(),
            "Invalid job: 2 errors\n  /alpha alpha is 1.2 but at most 1\n  /water/stile unknown field (did you mean `style`?)"
        );
    }
}
