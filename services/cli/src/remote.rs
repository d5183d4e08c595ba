//! The command line's side of the HTTP API: JSON in and out, problems as readable errors.

use std::time::Duration;

use anyhow::Context;
use serde_json::Value;
use ureq::Agent;
use ureq::http::Response;
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

/// The longest answer that is read into memory: an artifact of the largest picture that the service accepts.
const ANSWER_LIMIT_BYTES: u64 = 1 << 30;
/// Long-polls wait up to a minute; anything beyond this is a dead connection.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(90);

/// The longest that the service itself works on one request.
const PATIENT_TIMEOUT: Duration = Duration::from_secs(3700);

/// A connection to the service.
pub struct Remote {
    agent: Agent,
    base: String,
    token: Option<String>,
}

/// An answer whose status says that the request succeeded.
pub struct Answer {
    pub status: u16,
    pub bytes: Vec<u8>,
}

impl Answer {
    /// The body as JSON.
    pub fn json(&self) -> Result<Value, Failure> {
        Ok(serde_json::from_slice(&self.bytes).context("the service's answer is not JSON")?)
    }
}

impl Remote {
    pub fn new(arguments: &ServerArguments) -> Self {
        Self::waiting(arguments, ANSWER_TIMEOUT)
    }

    /// For a request that may take as long as the service works on it.
    pub fn with_patience(arguments: &ServerArguments) -> Self {
        Self::waiting(arguments, PATIENT_TIMEOUT)
    }

    fn waiting(arguments: &ServerArguments, timeout: Duration) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_connect(Some(Duration::from_secs(5)))
            .timeout_global(Some(timeout))
            .build();
        let base = arguments.server.trim_end_matches('/').to_owned();
        Self {
            agent: config.into(),
            base,
            token: arguments.token.clone(),
        }
    }

    pub fn get(&self, path: &str) -> Result<Answer, Failure> {
        let mut request = self.agent.get(format!("{}{path}", self.base));
        if let Some(token) = &self.token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        self.answer(request.call())
    }

    pub fn post_json(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Result<Answer, Failure> {
        let mut request = self
            .agent
            .post(format!("{}{path}", self.base))
            .header("content-type", "application/json");
        if let Some(token) = &self.token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        self.answer(request.send(body))
    }

    pub fn post_form(&self, path: &str, form: Form<'_>) -> Result<Answer, Failure> {
        let mut request = self.agent.post(format!("{}{path}", self.base));
        if let Some(token) = &self.token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        self.answer(request.send(form))
    }

    fn answer(&self, result: Result<Response<ureq::Body>, ureq::Error>) -> Result<Answer, Failure> {
        let mut response = result.map_err(|error| {
            Failure::NoServer(format!(
                "no service answers at {}: {error}; start one with `fathom serve`",
                self.base
            ))
        })?;
        let status = response.status().as_u16();
        let bytes = response
            .body_mut()
            .with_config()
            .limit(ANSWER_LIMIT_BYTES)
            .read_to_vec()
            .context("the service's answer broke off")?;
        if status < 400 {
            return Ok(Answer { status, bytes });
        }
        let problem: Value = serde_json::from_slice(&bytes).unwrap_or_default();
        Err(failure(status, &problem))
    }
}

/// A problem answer as an error: its detail, then every field error on its own line.
fn failure(status: u16, problem: &Value) -> Failure {
    let text = |name: &str| problem.get(name).and_then(Value::as_str);
    let mut message = match (text("title"), text("detail")) {
        (Some(title), Some(detail)) => format!("{title}: {detail}"),
        (Some(one), None) | (None, Some(one)) => one.to_owned(),
        (None, None) => format!("the service answered {status}"),
    };
    for error in problem
        .get("errors")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
    {
        let part = |name: &str| error.get(name).and_then(Value::as_str).unwrap_or_default();
        message.push_str(&format!("\n  {} {}", part("pointer"), part("message")));
        if let Some(near) = error.get("did_you_mean").and_then(Value::as_str) {
            message.push_str(&format!(" (did you mean `{near}`?)"));
        }
    }
    match (text("type"), status) {
        (Some(slug), _) if slug.ends_with("runtime-missing") => Failure::RuntimeMissing(message),
        (_, 400..=499) => Failure::BadInput(message),
        _ => Failure::NoServer(message),
    }
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
    use super::*;
    use serde_json::json;

    #[test]
    fn a_validation_problem_lists_every_field_error() {
        let problem = json!({"type": "/problems/validation", "title": "Invalid job", "detail": "2 errors",
            "errors": [{"pointer": "/alpha", "message": "alpha is 1.2 but at most 1"},
                       {"pointer": "/water/stile", "message": "unknown field", "did_you_mean": "style"}]});
        let Failure::BadInput(message) = failure(422, &problem) else {
            panic!("not bad input")
        };
        assert_eq!(
            message,
            "Invalid job: 2 errors\n  /alpha alpha is 1.2 but at most 1\n  /water/stile unknown field (did you mean `style`?)"
        );
    }

    #[test]
    fn a_missing_runtime_has_its_own_exit_status() {
        let problem = json!({"type": "/problems/runtime-missing", "title": "x"});
        assert!(matches!(failure(409, &problem), Failure::RuntimeMissing(_)));
    }

    #[test]
    fn query_values_keep_only_unreserved_characters() {
        assert_eq!(query_value("uiqm > 0.8"), "uiqm%20%3E%200.8");
    }
}
