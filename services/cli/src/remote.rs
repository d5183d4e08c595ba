//! The command line's side of the HTTP API: JSON in and out, problems as failures.

use std::time::Duration;

use anyhow::Context;
use renderer::http::{Http, HttpError, Reply};
use serde_json::Value;
use ureq::unversioned::multipart::Form;

use crate::exit::Failure;

/// Which service to speak to.
#[derive(Debug, Clone, clap::Args)]
pub struct ServerArguments {
    /// Base URL of the service.
    #[arg(long, env = "FATHOM_SERVER", default_value = "http://127.0.0.1:7311")]
    pub server: String,
    /// Bearer token, if the service wants one.
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
}

/// Long-polls wait up to a minute; anything beyond this is a dead connection.
const RESPONSE_LIMIT: Duration = Duration::from_secs(90);
/// The longest that the service itself works on one request.
const PATIENT_LIMIT: Duration = Duration::from_secs(3700);

/// A connection to the service.
pub struct Remote(Http);

impl Remote {
    pub fn new(arguments: &ServerArguments) -> Self {
        Self(Http::new(
            &arguments.server,
            arguments.token.as_deref(),
            RESPONSE_LIMIT,
        ))
    }

    /// For a request that may take as long as the service works on it.
    pub fn with_patience(arguments: &ServerArguments) -> Self {
        Self(Http::new(
            &arguments.server,
            arguments.token.as_deref(),
            PATIENT_LIMIT,
        ))
    }

    pub fn get(&self, path: &str) -> Result<Value, Failure> {
        json(&self.0.get(path).map_err(|error| self.failure(error))?)
    }

    pub fn get_bytes(&self, path: &str) -> Result<Vec<u8>, Failure> {
        Ok(self.0.get(path).map_err(|error| self.failure(error))?.bytes)
    }

    pub fn post(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Result<Value, Failure> {
        let headers = [&[("content-type", "application/json")], headers].concat();
        let reply = self.0.post(path, &headers, body);
        json(&reply.map_err(|error| self.failure(error))?)
    }

    /// Posts a form; returns whether something new came of it, too.
    pub fn post_form(&self, path: &str, form: Form<'_>) -> Result<(Value, bool), Failure> {
        let reply = self
            .0
            .post(path, &[], form)
            .map_err(|error| self.failure(error))?;
        Ok((json(&reply)?, reply.status.as_u16() == 201))
    }

    fn failure(&self, error: HttpError) -> Failure {
        match error {
            HttpError::Unreachable(error) => Failure::NoServer(format!(
                "no service answers at {}: {error}; start one with `fathom serve`",
                self.0.base()
            )),
            HttpError::Problem(problem) if problem.is("runtime-missing") => {
                Failure::RuntimeMissing(problem.message())
            }
            HttpError::Problem(problem) if problem.status.is_client_error() => {
                Failure::BadInput(problem.message())
            }
            HttpError::Problem(problem) => Failure::NoServer(problem.message()),
        }
    }
}

fn json(reply: &Reply) -> Result<Value, Failure> {
    Ok(serde_json::from_slice(&reply.bytes).context("the service's answer is not JSON")?)
}

/// Percent-encodes a query value (RFC 3986: everything but the unreserved characters).
pub fn query_value(text: &str) -> String {
    text.bytes()
        .map(|byte| match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
                char::from(byte).to_string()
            }
            _ => format!("%{byte:02X}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use renderer::http::Problem;
    use ureq::http::StatusCode;

    use super::*;

    #[test]
    fn a_missing_runtime_has_its_own_exit_status() {
        let remote = Remote(Http::new("http://127.0.0.1:9", None, RESPONSE_LIMIT));
        let problem = Problem::new(
            StatusCode::CONFLICT,
            br#"{"type": "/problems/runtime-missing", "title": "x"}"#,
        );
        let failure = remote.failure(HttpError::Problem(problem));
        assert!(matches!(failure, Failure::RuntimeMissing(_)));
    }

    #[test]
    fn query_values_keep_only_unreserved_characters() {
        assert_eq!(query_value("uiqm > 0.8"), "uiqm%20%3E%200.8");
    }
}
