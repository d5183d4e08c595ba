//! Carries the requests of the S3 client over the HTTP client that the rest of the program uses.
//!
//! Signing, retries, multipart uploads and the protocol are those of `object_store`. With this transport it compiles no
//! second HTTP client and no second TLS library.

use std::error::Error;
use std::io;
use std::time::Duration;

use async_trait::async_trait;
use bytes::Bytes;
use http_body_util::BodyExt;
use object_store::ClientOptions;
use object_store::client::{
    HttpClient, HttpConnector, HttpError, HttpErrorKind, HttpRequest, HttpResponse, HttpService,
};
use ureq::Agent;
use ureq::http::{Method, Request, Response};

const CONNECT_LIMIT: Duration = Duration::from_secs(5);
/// Longest time of one request: a part of an upload over a slow line.
const REQUEST_LIMIT: Duration = Duration::from_secs(60);
/// Largest response; readers request far smaller ranges.
const MOST_BYTES: u64 = 256 << 20;

/// Hands the transport to the S3 client.
#[derive(Debug)]
pub(crate) struct Connector;

impl HttpConnector for Connector {
    fn connect(&self, _options: &ClientOptions) -> object_store::Result<HttpClient> {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .timeout_connect(Some(CONNECT_LIMIT))
            .timeout_global(Some(REQUEST_LIMIT));
        Ok(HttpClient::new(Transport(config.build().into())))
    }
}

#[derive(Debug)]
struct Transport(Agent);

#[async_trait]
impl HttpService for Transport {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        let (parts, body) = request.into_parts();
        let body = body.collect().await?.to_bytes();
        let agent = self.0.clone();
        let request = Request::from_parts(parts, body);
        let sent = tokio::task::spawn_blocking(move || send(&agent, request)).await;
        sent.map_err(|error| HttpError::new(HttpErrorKind::Unknown, error))?
    }
}

fn send(agent: &Agent, request: Request<Bytes>) -> Result<HttpResponse, HttpError> {
    let has_body = matches!(*request.method(), Method::PUT | Method::POST);
    let (parts, body) = request.into_parts();
    let proxy = client::choose_proxy(&parts.uri.to_string()).map_err(|error| failure(error.into()))?;
    let sent = if has_body {
        let request = Request::from_parts(parts, &body[..]);
        agent.run(agent.configure_request(request).proxy(proxy).build())
    } else {
        let request = Request::from_parts(parts, ());
        agent.run(agent.configure_request(request).proxy(proxy).build())
    };
    let (parts, mut body) = sent.map_err(failure)?.into_parts();
    let bytes = body
        .with_config()
        .limit(MOST_BYTES)
        .read_to_vec()
        .map_err(failure)?;
    Ok(Response::from_parts(parts, bytes.into()))
}

/// Tells the S3 client whether the request may be repeated.
fn failure(error: ureq::Error) -> HttpError {
    let kind = match &error {
        ureq::Error::HostNotFound | ureq::Error::ConnectionFailed => HttpErrorKind::Connect,
        ureq::Error::Timeout(ureq::Timeout::Connect | ureq::Timeout::Resolve) => HttpErrorKind::Connect,
        ureq::Error::Timeout(_) => HttpErrorKind::Timeout,
        ureq::Error::Io(error) if error.kind() == io::ErrorKind::ConnectionRefused => HttpErrorKind::Connect,
        ureq::Error::Io(_) => HttpErrorKind::Interrupted,
        ureq::Error::Protocol(_) => HttpErrorKind::Request,
        _ => HttpErrorKind::Unknown,
    };
    HttpError::new(kind, error)
}

/// The error of the file system at the root of a failure, if there is one.
pub(crate) fn io_error<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a io::Error> {
    let mut next = Some(error);
    while let Some(error) = next {
        if let Some(error) = error.downcast_ref::<io::Error>() {
            return Some(error);
        }
        next = error.source();
    }
    None
}
