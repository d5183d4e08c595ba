//! Host names of a service without tokens.
//!
//! A foreign page may rebind its host name to this machine after a browser has loaded it (DNS rebinding), so that the
//! browser treats the service as the same site. The `Host` header still reveals this. A service with tokens does not
//! need this check: the page has no token.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::HOST;
use axum::http::uri::Authority;
use axum::middleware::Next;
use axum::response::Response;

use crate::http::problem::{Problem, Slug};

/// Accepted host names.
#[derive(Clone)]
pub(crate) enum Hosts {
    /// Any name: every request needs a token.
    Any,
    /// This machine's loopback names, and the listed ones.
    Loopback(Arc<[String]>),
}

impl Hosts {
    pub(crate) fn new(are_tokens_needed: bool, names: &[String]) -> Self {
        if are_tokens_needed {
            return Self::Any;
        }
        let names = names.iter().map(|name| name.to_ascii_lowercase());
        Self::Loopback(names.collect())
    }

    fn has(&self, host: &str) -> bool {
        let Self::Loopback(names) = self else { return true };
        let Ok(authority) = host.parse::<Authority>() else {
            return false;
        };
        // A trailing dot makes a name absolute.
        let name = authority.host().to_ascii_lowercase();
        let name = name.strip_suffix('.').unwrap_or(&name);
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let is_loopback = bare.parse().is_ok_and(|ip: IpAddr| ip.is_loopback());
        is_loopback || name == "localhost" || names.iter().any(|known| known == name)
    }
}

/// Passes requests for a name of this service. A request without a host is HTTP/1.0, which no browser uses.
pub(crate) async fn check_host(
    State(hosts): State<Hosts>,
    request: Request,
    next: Next,
) -> Result<Response, Problem> {
    let headers = request.headers().get_all(HOST).iter();
    let texts: Option<Vec<&str>> = headers.map(|value| value.to_str().ok()).collect();
    let asked = request.uri().authority().map(Authority::as_str);
    let mut all = texts.iter().flatten().copied().chain(asked);
    if texts.is_some() && all.all(|host| hosts.has(host)) {
        return Ok(next.run(request).await);
    }
    let names = texts.unwrap_or_default().join(", ");
    let detail = format!(
        "`{names}` is not a name of this service; without tokens it accepts localhost, 127.0.0.0/8, [::1] and the names of --hosts"
    );
    Err(Problem::new(Slug::UnknownHost, detail))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_service_has_loopback_names_and_those_of_its_setting() {
        let hosts = Hosts::new(false, &["Fathom.Lan".to_owned()]);
        for host in [
            "localhost",
            "LOCALHOST:7311",
            "localhost.",
            "127.0.0.1:7311",
            "127.8.9.1",
            "[::1]:7311",
            "fathom.lan:80",
        ] {
            assert!(hosts.has(host), "{host}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example",
            "127.0.0.1.evil.example:7311",
            "evil@localhost.example",
            "10.0.0.1",
            "[::2]",
            "0.0.0.0",
            "",
            "local host",
            "::1",
        ] {
            assert!(!hosts.has(host), "{host}");
        }
        assert!(Hosts::new(true, &[]).has("evil.example"));
    }
}
