//! Failed requests.

use crate::http::{Http, HttpError, Problem};
use crate::proxy::InvalidProxy;

/// Why a request failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// No response, or one that broke off.
    #[error("no service responds at {base}{}: {source}; {}", describe_proxy(proxy.as_deref()), suggest_remedy(proxy.as_deref()))]
    Unreachable {
        /// URL of the service.
        base: String,
        /// Host and port of the proxy of the request.
        proxy: Option<String>,
        /// The error of the connection.
        source: ureq::Error,
    },
    /// No request was sent.
    #[error(transparent)]
    Proxy(InvalidProxy),
    /// The service refused.
    #[error("{}", .0.message())]
    Refused(Problem),
    /// A response that is longer than any of the service.
    #[error(
        "the response is longer than {limit} bytes, the most that a service sends here; check the address of the service"
    )]
    TooLong {
        /// Most bytes.
        limit: u64,
    },
    /// A list whose cursors do not end.
    #[error(
        "the list {path} has no end after {pages} pages; check the address of the service, or request fewer rows with a filter"
    )]
    EndlessList {
        /// The path of the list.
        path: String,
        /// Pages that were read.
        pages: usize,
    },
    /// A response of success that is not of the expected form.
    #[error("the response to {path} is not of the expected form")]
    Unreadable {
        /// The path of the request.
        path: String,
        /// The error of the parser.
        source: serde_json::Error,
    },
}

fn describe_proxy(proxy: Option<&str>) -> String {
    proxy.map_or(String::new(), |proxy| {
        format!(" through the proxy {proxy} of the environment")
    })
}

fn suggest_remedy(proxy: Option<&str>) -> &'static str {
    match proxy {
        Some(_) => "add its host to `no_proxy` to connect directly",
        None => "start one with `fathom serve`",
    }
}

impl ClientError {
    pub(crate) fn new(http: &Http, error: HttpError) -> Self {
        match error {
            HttpError::Unreachable(ureq::Error::Other(source)) if source.is::<InvalidProxy>() => {
                Self::Proxy(*source.downcast().expect("its type was tested"))
            }
            HttpError::Unreachable(ureq::Error::BodyExceedsLimit(limit)) => Self::TooLong { limit },
            HttpError::Unreachable(source) => Self::Unreachable {
                base: http.base().to_owned(),
                proxy: http.proxy().map(str::to_owned),
                source,
            },
            HttpError::Problem(problem) => Self::Refused(problem),
        }
    }

    /// Whether the path is unknown to the service.
    #[must_use]
    pub fn is_not_found(&self) -> bool {
        matches!(self, Self::Refused(problem) if problem.status.as_u16() == 404)
    }
}
