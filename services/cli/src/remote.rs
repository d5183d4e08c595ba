//! Client of the HTTP API: JSON in and out, problems as failures.

use std::time::Duration;

use anyhow::Context;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use renderer::http::{Http, HttpError};
use serde_json::Value;
use ureq::unversioned::multipart::Form;

use crate::exit::Failure;

/// Where `fathom serve` listens unless told otherwise.
pub const LOCAL_SERVICE: &str = "http://127.0.0.1:7311";

/// Which service to talk to.
#[derive(Debug, Clone, clap::Args)]
pub struct ServerArguments {
    /// Base URL of the service.
    #[arg(long, env = "FATHOM_SERVER", default_value = LOCAL_SERVICE)]
    pub server: String,
    /// Bearer token, if the service requires one.
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
}

/// A service to ask in place of this program itself.
#[derive(Debug, Clone, clap::Args)]
pub struct OtherServer {
    /// Ask a service instead of this program [URL: FATHOM_SERVER, or else http://127.0.0.1:7311]
    #[arg(long, value_name = "URL", num_args = 0..=1)]
    server: Option<Option<String>>,
    /// Bearer token, if the service requires one.
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    token: Option<String>,
}

impl OtherServer {
    /// A connection to the service, if one is to be asked.
    pub fn remote(&self) -> Option<Remote> {
        let named = self.server.clone()?;
        let server = named
            .or_else(|| std::env::var("FATHOM_SERVER").ok())
            .unwrap_or_else(|| LOCAL_SERVICE.to_owned());
        let token = self.token.clone();
        Some(Remote::new(&ServerArguments { server, token }))
    }
}

/// Everything but the unreserved characters of RFC 3986.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');
/// Long-polls wait up to a minute; anything beyond this is a dead connection.
const RESPONSE_LIMIT: Duration = Duration::from_secs(90);
/// The longest that the service itself works on one request.
const PATIENT_LIMIT: Duration = Duration::from_secs(3700);

/// Most rows of one request.
pub(crate) const PAGE_ROWS: usize = 500;

/// A connection to the service.
pub struct Remote(Http);

impl Remote {
    pub fn new(arguments: &ServerArguments) -> Self {
        Self::with_limit(arguments, RESPONSE_LIMIT)
    }

    /// For requests that may take the service up to an hour.
    pub fn with_patience(arguments: &ServerArguments) -> Self {
        Self::with_limit(arguments, PATIENT_LIMIT)
    }

    fn with_limit(arguments: &ServerArguments, limit: Duration) -> Self {
        let token = arguments.token.as_deref();
        Self(Http::new(&arguments.server, token, limit))
    }

    pub fn get(&self, path: &str) -> Result<Value, Failure> {
        json(&self.get_bytes(path)?)
    }

    /// What stands under a path; none where there is nothing.
    pub fn find(&self, path: &str) -> Result<Option<Value>, Failure> {
        match self.0.get(path) {
            Ok(reply) => json(&reply.bytes).map(Some),
            Err(HttpError::Problem(problem)) if problem.status.as_u16() == 404 => Ok(None),
            Err(error) => Err(self.failure(error)),
        }
    }

    pub fn get_bytes(&self, path: &str) -> Result<Vec<u8>, Failure> {
        Ok(self.0.get(path).map_err(|error| self.failure(error))?.bytes)
    }

    pub fn post(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Result<Value, Failure> {
        let headers = [&[("content-type", "application/json")], headers].concat();
        let reply = self.0.post(path, &headers, body);
        json(&reply.map_err(|error| self.failure(error))?.bytes)
    }

    /// Deletes what stands under a path; returns what the service says about it, null where it says nothing.
    pub fn delete(&self, path: &str) -> Result<Value, Failure> {
        let reply = self.0.delete(path).map_err(|error| self.failure(error))?;
        match reply.bytes.as_slice() {
            [] => Ok(Value::Null),
            body => json(body),
        }
    }

    /// All rows of a list of pages, up to a limit.
    pub fn rows(
        &self,
        path: &str,
        parameters: &[(&str, Option<&str>)],
        limit: usize,
    ) -> Result<Vec<Value>, Failure> {
        let (mut rows, mut cursor) = (Vec::new(), None::<String>);
        while rows.len() < limit {
            let most = (limit - rows.len()).min(PAGE_ROWS).to_string();
            let page = [("limit", Some(most.as_str())), ("cursor", cursor.as_deref())];
            let mut page = self.get(&with_query(path, &[parameters, &page].concat()))?;
            let more = page["items"]
                .as_array_mut()
                .map(std::mem::take)
                .unwrap_or_default();
            let is_empty = more.is_empty();
            rows.extend(more);
            cursor = page["next_cursor"].as_str().map(str::to_owned);
            if cursor.is_none() || is_empty {
                break;
            }
        }
        Ok(rows)
    }

    /// Posts a form; returns the response and whether the request created something new.
    pub fn post_form(&self, path: &str, form: Form<'_>) -> Result<(Value, bool), Failure> {
        let reply = self
            .0
            .post(path, &[], form)
            .map_err(|error| self.failure(error))?;
        Ok((json(&reply.bytes)?, reply.status.as_u16() == 201))
    }

    fn failure(&self, error: HttpError) -> Failure {
        match error {
            HttpError::Unreachable(error) => Failure::NoServer(format!(
                "no service responds at {}: {error}; start one with `fathom serve`",
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

fn json(body: &[u8]) -> Result<Value, Failure> {
    Ok(serde_json::from_slice(body).context("the service's response is not JSON")?)
}

/// Percent-encodes a part of a URL.
pub fn encode(text: &str) -> String {
    utf8_percent_encode(text, RESERVED).to_string()
}

/// A path with a query; parameters without a value or with an empty one are left out.
pub fn with_query(path: &str, parameters: &[(&str, Option<&str>)]) -> String {
    let given = parameters.iter().filter_map(|(name, value)| {
        let value = value.filter(|value| !value.trim().is_empty())?;
        Some(format!("{name}={}", encode(value)))
    });
    let given: Vec<String> = given.collect();
    [path, &given.join("&")].join("?")
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
    fn a_query_has_the_parameters_that_are_given() {
        let parameters = [
            ("filter", Some("uiqm > 0.8")),
            ("cursor", None),
            ("order_by", Some("-uiqm")),
        ];
        assert_eq!(
            with_query("/v1/images", &parameters),
            "/v1/images?filter=uiqm%20%3E%200.8&order_by=-uiqm"
        );
    }
}
