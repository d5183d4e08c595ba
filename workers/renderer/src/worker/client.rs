//! The worker's side of the protocol: blocking HTTP with protobuf bodies.

use std::time::Duration;

use client::{Http, HttpError};
use prost::Message;
use spec::SceneFiles;
use ureq::http::StatusCode;
use wire::messages::{
    BeatRequest, BeatResponse, CommitRequest, CommitResponse, FailRequest, Lease, LeaseRequest,
    LeaseResponse, PutArtifactsRequest, RegisterRequest, RegisterResponse, ReleaseRequest, Style,
    StylesResponse,
};
use wire::{CONTENT_TYPE, Checked, decode};

/// Longer than any long-poll: beyond it the connection is dead.
const RESPONSE_LIMIT: Duration = Duration::from_secs(120);

/// Why a call failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The lease is no longer held: drop the frame.
    #[error("the lease is stale")]
    Stale,
    /// The service does not know this worker, for instance after a restart: register again.
    #[error("the service does not know this worker")]
    UnknownWorker,
    /// No response, or a request to retry: retry after a pause.
    #[error("the service is not available: {reason}")]
    Unavailable {
        /// What happened.
        reason: String,
    },
    /// The service understood and refused the request: a retry is useless.
    #[error("the service refused ({status}): {problem}")]
    Refused {
        /// HTTP status.
        status: u16,
        /// Title and detail of the problem.
        problem: String,
    },
}

/// The result of a call.
pub type Outcome<T> = Result<T, ClientError>;

/// The worker's calls to a service; cheap to clone, shared by threads. Each fails with a [`ClientError`].
#[derive(Clone)]
pub struct Client(Http);

#[allow(clippy::missing_errors_doc, reason = "said once, at the type")]
impl Client {
    /// A client of the service at this URL, with a bearer token if the service requires one.
    #[must_use]
    pub fn new(server: &str, token: Option<&str>) -> Self {
        Self(Http::new(server, token, RESPONSE_LIMIT))
    }

    /// Registers the worker.
    pub fn register(&self, about: &RegisterRequest) -> Outcome<RegisterResponse> {
        self.post("register", about)
    }

    /// Waits for frames to render.
    pub fn lease(&self, request: &LeaseRequest) -> Outcome<Option<Lease>> {
        let response: LeaseResponse = self.post("lease", request)?;
        Ok(response.lease)
    }

    /// Extends leases.
    pub fn beat(&self, beat: &BeatRequest) -> Outcome<BeatResponse> {
        self.post("beat", beat)
    }

    /// Stores the files of a frame.
    pub fn put_artifacts(&self, files: &PutArtifactsRequest) -> Outcome<()> {
        self.post("artifacts", files)
    }

    /// Makes the image of a frame visible; returns whether it already was.
    pub fn commit(&self, commit: &CommitRequest) -> Outcome<bool> {
        let response: CommitResponse = self.post("commit", commit)?;
        Ok(response.already_there)
    }

    /// Reports a failed attempt.
    pub fn fail(&self, fail: &FailRequest) -> Outcome<()> {
        self.post("fail", fail)
    }

    /// Releases a lease.
    pub fn release(&self, token: u64, reason: &str) -> Outcome<()> {
        let reason = reason.to_owned();
        self.post("release", &ReleaseRequest { token, reason })
    }

    /// The canonical description of a job.
    pub fn description(&self, job: &str) -> Outcome<Vec<u8>> {
        self.get(&format!("jobs/{job}"))
    }

    /// The digests of the files of an uploaded scene.
    pub fn scene(&self, id: &str) -> Outcome<SceneFiles<String>> {
        let files = self.get(&format!("scenes/{id}"))?;
        serde_json::from_slice(&files).map_err(|error| unreadable(&error))
    }

    /// The style models that jobs may name.
    pub fn styles(&self) -> Outcome<Vec<Style>> {
        let response: StylesResponse = decoded(&self.get("styles")?)?;
        Ok(response.styles)
    }

    /// The ONNX file of a style model.
    pub fn style(&self, name: &str) -> Outcome<Vec<u8>> {
        self.get(&format!("styles/{name}"))
    }

    /// Stored bytes by digest.
    pub fn blob(&self, digest: &str) -> Outcome<Vec<u8>> {
        self.get(&format!("blobs/{digest}"))
    }

    fn post<Response: Checked>(&self, what: &str, request: &impl Message) -> Outcome<Response> {
        let headers = [("content-type", CONTENT_TYPE)];
        let path = format!("/v1/worker/{what}");
        decoded(&self.0.post(&path, &headers, request.encode_to_vec())?.bytes)
    }

    fn get(&self, what: &str) -> Outcome<Vec<u8>> {
        Ok(self.0.get(&format!("/v1/worker/{what}"))?.bytes)
    }
}

fn decoded<Response: Checked>(bytes: &[u8]) -> Outcome<Response> {
    decode(bytes).map_err(|error| unreadable(&error))
}

/// Treats a malformed response as a refusal, since a retry would return it again.
fn unreadable(error: &dyn std::error::Error) -> ClientError {
    ClientError::Refused {
        status: 200,
        problem: format!("the response cannot be used: {error}"),
    }
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
    use ::client::Problem;

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
