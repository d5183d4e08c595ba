//! The worker's side of the protocol: blocking HTTP with protobuf bodies.

use std::time::Duration;

use prost::Message;
use proto::CONTENT_TYPE;
use proto::wire::{
    BeatRequest, BeatResponse, CommitRequest, CommitResponse, FailRequest, FailResponse, LeaseRequest,
    LeaseResponse, PutArtifactsRequest, PutArtifactsResponse, RegisterRequest, RegisterResponse,
    ReleaseRequest, ReleaseResponse, SceneResponse, StylesResponse,
};
use ureq::http::StatusCode;

use crate::http::{Http, HttpError};

/// Longer than any long-poll: beyond it the connection is dead.
const RESPONSE_LIMIT: Duration = Duration::from_secs(120);

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

/// The worker's calls to a service; cheap to clone, shared by threads.
#[derive(Clone)]
pub struct Client(Http);

impl Client {
    /// A client of the service at this URL, with a bearer token if it wants one.
    #[must_use]
    pub fn new(server: &str, token: Option<&str>) -> Self {
        Self(Http::new(server, token, RESPONSE_LIMIT))
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

    /// The canonical description of a job.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn description(&self, job: &str) -> Result<Vec<u8>, ClientError> {
        self.get(&format!("jobs/{job}"))
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
        let headers = [("content-type", CONTENT_TYPE)];
        let path = format!("/v1/worker/{what}");
        decoded(&self.0.post(&path, &headers, request.encode_to_vec())?.bytes)
    }

    fn get(&self, what: &str) -> Result<Vec<u8>, ClientError> {
        Ok(self.0.get(&format!("/v1/worker/{what}"))?.bytes)
    }
}

fn decoded<Answer: Message + Default>(bytes: &[u8]) -> Result<Answer, ClientError> {
    let unreadable = |error: prost::DecodeError| ClientError::Refused {
        status: 200,
        problem: format!("the answer is no message of this protocol: {error}"),
    };
    Answer::decode(bytes).map_err(unreadable)
}

impl From<HttpError> for ClientError {
    fn from(error: HttpError) -> Self {
        let problem = match error {
            HttpError::Unreachable(error) => {
                let reason = error.to_string();
                return Self::Unavailable { reason };
            }
            HttpError::Problem(problem) => problem,
        };
        let (status, text) = (problem.status, problem.message());
        if problem.is("stale-lease") {
            Self::Stale
        } else if problem.is("unknown-worker") {
            Self::UnknownWorker
        } else if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
            let reason = format!("{status}: {text}");
            Self::Unavailable { reason }
        } else {
            let status = status.as_u16();
            Self::Refused {
                status,
                problem: text,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::Problem;

    #[test]
    fn a_problem_says_whether_to_drop_to_register_again_to_wait_or_to_stop() {
        let kind = |status: u16, slug: &str| {
            let body = format!("{{\"type\": \"/problems/{slug}\", \"title\": \"t\", \"detail\": \"d\"}}");
            let problem = Problem::new(StatusCode::from_u16(status).unwrap(), body.as_bytes());
            ClientError::from(HttpError::Problem(problem))
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
            ClientError::from(HttpError::Problem(Problem::new(
                StatusCode::BAD_GATEWAY,
                b"<html>"
            ))),
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
