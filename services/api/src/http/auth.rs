//! Bearer tokens with scopes. Only SHA-256 hashes of the secrets are kept.

use std::net::SocketAddr;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::middleware::Next;
use axum::response::Response;
use sha2::{Digest, Sha256};

use crate::http::problem::{Problem, Slug};

/// Permissions of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Read all non-secret data.
    Read,
    /// Submit and cancel jobs, upload scenes.
    Submit,
    /// Act as a worker.
    Work,
    /// All permissions.
    Admin,
}

impl Scope {
    const ALL: [Self; 4] = [Self::Read, Self::Submit, Self::Work, Self::Admin];

    fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Submit => "submit",
            Self::Work => "work",
            Self::Admin => "admin",
        }
    }

    fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scope| scope.name() == name)
    }
}

/// An invalid token setting. Messages never contain secrets.
#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    /// An entry without a secret.
    #[error("token entry {position} has no secret")]
    Empty {
        /// Counted from 1.
        position: usize,
    },
    /// The part before `:` is not a list of scopes.
    #[error(
        "token entry {position} names an unknown scope; scopes are read, submit, work and admin, joined by `+`"
    )]
    Scope {
        /// Counted from 1.
        position: usize,
    },
    /// The address is reachable from other machines.
    #[error("{0} can be reached from other machines: set FATHOM_TOKEN, or listen on 127.0.0.1")]
    Open(SocketAddr),
}

/// Owner of requests without a token.
const ANYONE: &str = "local";

/// The sender of a request. Rows that belong to a caller have its `owner`.
#[derive(Debug, Clone)]
pub(crate) struct Caller {
    /// Hash of the token, or `local` without tokens.
    pub(crate) owner: String,
    /// Whether it is a worker started by the service.
    pub(crate) is_own_worker: bool,
}

impl Caller {
    /// Whether it is anonymous.
    pub(crate) fn is_anonymous(&self) -> bool {
        self.owner == ANYONE
    }
}

struct Entry {
    hash: [u8; 32],
    scopes: Vec<Scope>,
}

/// The known tokens. Without any, every request has all permissions.
pub(crate) struct Tokens {
    entries: Vec<Entry>,
    /// Hash of the secret shared only with the service's workers.
    own_worker: Option<[u8; 32]>,
}

impl Tokens {
    /// Parses `SECRET` or `scope+scope:SECRET` entries, separated by commas.
    pub(crate) fn parse(setting: Option<&str>, listen: SocketAddr) -> Result<Self, TokenError> {
        let Some(setting) = setting.filter(|text| !text.is_empty()) else {
            return if listen.ip().is_loopback() {
                Ok(Self::from_entries(Vec::new()))
            } else {
                Err(TokenError::Open(listen))
            };
        };
        let entries = setting
            .split(',')
            .zip(1..)
            .map(|(text, position)| Entry::parse(text.trim(), position));
        Ok(Self::from_entries(entries.collect::<Result<_, _>>()?))
    }

    fn from_entries(entries: Vec<Entry>) -> Self {
        Self {
            entries,
            own_worker: None,
        }
    }

    /// Returns whether requests need a token.
    pub(crate) fn are_needed(&self) -> bool {
        !self.entries.is_empty()
    }

    /// Adds the secret of the service's workers, which has only their scope.
    pub(crate) fn add_own_worker(&mut self, secret: &str) {
        self.own_worker = Some(Sha256::digest(secret).into());
    }

    fn check(&self, headers: &HeaderMap, needed: Scope) -> Result<Caller, Problem> {
        let hash: Option<[u8; 32]> = bearer(headers).map(|secret| Sha256::digest(secret).into());
        if let (Some(hash), Some(own), Scope::Work) = (hash, self.own_worker, needed)
            && is_same_secret(&own, &hash)
        {
            return Ok(Caller {
                owner: spec::hex(&hash),
                is_own_worker: true,
            });
        }
        if self.entries.is_empty() {
            return Ok(Caller {
                owner: ANYONE.to_owned(),
                is_own_worker: false,
            });
        }
        let Some(hash) = hash else {
            return Err(unauthorized(
                "this request needs the header `Authorization: Bearer TOKEN`",
                "Bearer",
            ));
        };
        // Every entry is compared, to keep the time constant.
        let known = self.entries.iter().fold(None, |found, entry| {
            if is_same_secret(&entry.hash, &hash) {
                Some(entry)
            } else {
                found
            }
        });
        let Some(entry) = known else {
            return Err(unauthorized(
                "the token is unknown",
                "Bearer error=\"invalid_token\"",
            ));
        };
        if entry.scopes.contains(&needed) || entry.scopes.contains(&Scope::Admin) {
            return Ok(Caller {
                owner: spec::hex(&hash),
                is_own_worker: false,
            });
        }
        let detail = format!("this request needs a token with the scope `{}`", needed.name());
        Err(Problem::new(Slug::Forbidden, detail).with_member("scope", needed.name()))
    }
}

impl Entry {
    fn parse(text: &str, position: usize) -> Result<Self, TokenError> {
        let (scopes, secret) = match text.split_once(':') {
            None => (vec![Scope::Admin], text),
            Some((names, secret)) => {
                let scopes: Option<Vec<_>> = names.split('+').map(Scope::parse).collect();
                (scopes.ok_or(TokenError::Scope { position })?, secret)
            }
        };
        if secret.is_empty() {
            return Err(TokenError::Empty { position });
        }
        Ok(Self {
            hash: Sha256::digest(secret).into(),
            scopes,
        })
    }
}

fn unauthorized(detail: &str, challenge: &'static str) -> Problem {
    Problem::new(Slug::Unauthorized, detail)
        .header(header::WWW_AUTHENTICATE, HeaderValue::from_static(challenge))
}

fn bearer(headers: &HeaderMap) -> Option<&[u8]> {
    let value = headers.get(header::AUTHORIZATION)?.as_bytes();
    let (scheme, secret) = value.split_at_checked(7)?;
    scheme
        .eq_ignore_ascii_case(b"bearer ")
        .then(|| secret.trim_ascii())
}

/// Compares in constant time.
fn is_same_secret(a: &[u8; 32], b: &[u8; 32]) -> bool {
    a.iter().zip(b).fold(0, |difference, (x, y)| difference | (x ^ y)) == 0
}

/// The scope required by a group of routes.
#[derive(Clone)]
pub(crate) struct Guard {
    pub(crate) tokens: std::sync::Arc<Tokens>,
    pub(crate) scope: Scope,
}

/// Passes requests with the required scope, with their [`Caller`] as an extension.
pub(crate) async fn require(
    State(guard): State<Guard>,
    mut request: Request,
    next: Next,
) -> Result<Response, Problem> {
    let caller = guard.tokens.check(request.headers(), guard.scope)?;
    request.extensions_mut().insert(caller);
    Ok(next.run(request).await)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(setting: &str) -> Tokens {
        Tokens::parse(Some(setting), local()).unwrap()
    }

    fn local() -> SocketAddr {
        "127.0.0.1:0".parse().unwrap()
    }

    fn status(tokens: &Tokens, secret: &str, scope: Scope) -> u16 {
        let mut headers = HeaderMap::new();
        headers.insert(header::AUTHORIZATION, format!("Bearer {secret}").parse().unwrap());
        tokens
            .check(&headers, scope)
            .map_or_else(|problem| problem.render(None).status().as_u16(), |_| 200)
    }

    #[test]
    fn a_plain_secret_may_do_everything_and_a_scoped_one_only_its_scopes() {
        let tokens = tokens("boss, read+submit:alice");
        assert_eq!(status(&tokens, "boss", Scope::Work), 200);
        assert_eq!(status(&tokens, "alice", Scope::Submit), 200);
        assert_eq!(status(&tokens, "alice", Scope::Work), 403);
        assert_eq!(status(&tokens, "mallory", Scope::Read), 401);
        assert_eq!(status(&tokens, "read+submit:alice", Scope::Read), 401);
    }

    #[test]
    fn a_misspelt_scope_never_becomes_a_secret_that_may_do_everything() {
        assert!(matches!(
            Tokens::parse(Some("raed:alice"), local()),
            Err(TokenError::Scope { position: 1 })
        ));
        assert!(matches!(
            Tokens::parse(Some("boss,read:"), local()),
            Err(TokenError::Empty { position: 2 })
        ));
        assert!(matches!(
            Tokens::parse(Some("boss,"), local()),
            Err(TokenError::Empty { position: 2 })
        ));
    }

    #[test]
    fn other_machines_are_only_let_in_with_a_token() {
        let open: SocketAddr = "0.0.0.0:7311".parse().unwrap();
        assert!(matches!(Tokens::parse(None, open), Err(TokenError::Open(_))));
        assert!(matches!(Tokens::parse(Some(""), open), Err(TokenError::Open(_))));
        assert!(Tokens::parse(Some("boss"), open).is_ok());
        assert!(Tokens::parse(None, "[::1]:7311".parse().unwrap()).is_ok());
    }
}
