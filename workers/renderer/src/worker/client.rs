//! The worker's side of the protocol: blocking HTTP with protobuf bodies.

use std::time::Duration;

use prost::Message;
use proto::CONTENT_TYPE;
use proto::wire::{
    BeatRequest, BeatResponse, CommitRequest, CommitResponse, FailRequest, FailResponse, LeaseRequest,
    LeaseResponse, PutArtifactsRequest, PutArtifactsResponse, RegisterRequest, RegisterResponse,
    ReleaseRequest, ReleaseResponse, SceneResponse, StylesResponse,
};
use serde_json::Value;
use ureq::http::{Response, StatusCode};
use ureq::{Agent, Body};

/// Longer than any long-poll: beyond it the connection is dead.
const ANSWER_LIMIT: Duration = Duration::from_secs(120);
const CONNECT_LIMIT: Duration = Duration::from_secs(5);
/// The largest file that a scene may have.
const MOST_BYTES: u64 = 1 << 30;

/// Why a call came to nothing.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The lease is not held any more: drop the frame.
    #[error("the lease is stale")]
    Stale,
    /// The service does not know this worker, for instance after a restart: register again.
    #[error("the service does not know this worker")]
    UnknownWorker,
    /// No answer, or one that asks to come again: try again after a pause.
    #[error("the service is not available: {reason}")]
    Unavailable {
        /// What happened.
        reason: String,
    },
    /// The service understood and refused: trying again changes nothing.
    #[error("the service refused ({status}): {problem}")]
    Refused {
        /// HTTP status.
        status: u16,
        /// Title and detail of the problem.
        problem: String,
    },
}

/// A connection to a service; cheap to clone, shared by threads.
#[derive(Clone)]
pub struct Client {
    agent: Agent,
    base: String,
    authorization: Option<String>,
}

impl Client {
    /// A client of the service at this URL, with a bearer token if it wants one.
    #[must_use]
    pub fn new(server: &str, token: Option<&str>) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_connect(Some(CONNECT_LIMIT))
            .timeout_global(Some(ANSWER_LIMIT))
            .build();
        Self {
            agent: config.into(),
            base: format!("{}/v1/worker", server.trim_end_matches('/')),
            authorization: token.map(|token| format!("Bearer {token}")),
        }
    }

    /// Introduces the worker.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn register(&self, request: &RegisterRequest) -> Result<RegisterResponse, ClientError> {
        self.call("register", request)
    }

    /// Waits for frames to render.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn lease(&self, request: &LeaseRequest) -> Result<LeaseResponse, ClientError> {
        self.call("lease", request)
    }

    /// Prolongs leases.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn beat(&self, request: &BeatRequest) -> Result<BeatResponse, ClientError> {
        self.call("beat", request)
    }

    /// Stores the files of a frame.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn put_artifacts(&self, request: &PutArtifactsRequest) -> Result<PutArtifactsResponse, ClientError> {
        self.call("artifacts", request)
    }

    /// Makes the image of a frame visible.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn commit(&self, request: &CommitRequest) -> Result<CommitResponse, ClientError> {
        self.call("commit", request)
    }

    /// Reports a failed attempt.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn fail(&self, request: &FailRequest) -> Result<FailResponse, ClientError> {
        self.call("fail", request)
    }

    /// Hands a lease back.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn release(&self, request: &ReleaseRequest) -> Result<ReleaseResponse, ClientError> {
        self.call("release", request)
    }

    /// The files of an uploaded scene.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn scene(&self, id: &str) -> Result<SceneResponse, ClientError> {
        decoded(&self.get(&format!("scenes/{id}"))?)
    }

    /// The style models that jobs may name.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn styles(&self) -> Result<StylesResponse, ClientError> {
        decoded(&self.get("styles")?)
    }

    /// The ONNX file of a style model.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn style(&self, name: &str) -> Result<Vec<u8>, ClientError> {
        self.get(&format!("styles/{name}"))
    }

    /// Stored bytes by digest.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn blob(&self, digest: &str) -> Result<Vec<u8>, ClientError> {
        self.get(&format!("blobs/{digest}"))
    }

    fn call<Answer: Message + Default>(
        &self,
        what: &str,
        request: &impl Message,
    ) -> Result<Answer, ClientError> {
        let mut call = self
            .agent
            .post(format!("{}/{what}", self.base))
            .header("content-type", CONTENT_TYPE);
        if let Some(authorization) = &self.authorization {
            call = call.header("authorization", authorization);
        }
        decoded(&answer(call.send(request.encode_to_vec()))?)
    }

    fn get(&self, path: &str) -> Result<Vec<u8>, ClientError> {
        let mut call = self.agent.get(format!("{}/{path}", self.base));
        if let Some(authorization) = &self.authorization {
            call = call.header("authorization", authorization);
        }
        answer(call.call())
    }
}

fn decoded<Answer: Message + Default>(bytes: &[u8]) -> Result<Answer, ClientError> {
    let unreadable = |error: prost::DecodeError| ClientError::Refused {
        status: 200,
        problem: format!("the answer is no message of this protocol: {error}"),
    };
    Answer::decode(bytes).map_err(unreadable)
}

fn answer(result: Result<Response<Body>, ureq::Error>) -> Result<Vec<u8>, ClientError> {
    let unavailable = |error: ureq::Error| ClientError::Unavailable {
        reason: error.to_string(),
    };
    let mut response = result.map_err(unavailable)?;
    let status = response.status();
    let bytes = response
        .body_mut()
        .with_config()
        .limit(MOST_BYTES)
        .read_to_vec()
        .map_err(unavailable)?;
    if status.is_success() {
        Ok(bytes)
    } else {
        Err(refusal(status, &bytes))
    }
}

fn refusal(status: StatusCode, body: &[u8]) -> ClientError {
    let problem: Value = serde_json::from_slice(body).unwrap_or_default();
    let text = |name: &str| {
        problem
            .get(name)
            .and_then(Value::as_str)
            .unwrap_or_default()
            .to_owned()
    };
    let (slug, told) = (text("type"), format!("{}: {}", text("title"), text("detail")));
    if slug.ends_with("stale-lease") {
        ClientError::Stale
    } else if slug.ends_with("unknown-worker") {
        ClientError::UnknownWorker
    } else if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
        ClientError::Unavailable {
            reason: format!("{status}: {told}"),
        }
    } else {
        ClientError::Refused {
            status: status.as_u16(),
            problem: told,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_says_whether_to_drop_to_register_again_to_wait_or_to_stop() {
        let kind = |status: u16, slug: &str| {
            let body = format!("{{\"type\": \"/problems/{slug}\", \"title\": \"t\", \"detail\": \"d\"}}");
            refusal(StatusCode::from_u16(status).unwrap(), body.as_bytes())
        };
        assert!(matches!(kind(409, "stale-lease"), ClientError::Stale));
        assert!(matches!(kind(404, "unknown-worker"), ClientError::UnknownWorker));
        assert!(matches!(kind(503, "overloaded"), ClientError::Unavailable { .. }));
        assert!(matches!(
            kind(507, "storage-full"),
            ClientError::Unavailable { .. }
        ));
        assert!(matches!(
            kind(401, "unauthorized"),
            ClientError::Refused { status: 401, .. }
        ));
        assert!(matches!(
            refusal(StatusCode::BAD_GATEWAY, b"<html>"),
            ClientError::Unavailable { .. }
        ));
    }

    #[test]
    fn no_service_is_a_reason_to_wait() {
        let client = Client::new("http://127.0.0.1:9/", None);
        assert!(matches!(
            client.scene("scn_1"),
            Err(ClientError::Unavailable { .. })
        ));
    }
}
