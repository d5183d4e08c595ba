//! A group of routes with the same requirements.

use std::sync::Arc;
use std::time::Duration;

use utoipa_axum::router::OpenApiRouter;

use crate::app::App;
use crate::http::auth::{Scope, Tokens};
use crate::http::layers::{Choice, Group};
use crate::http::receive::Receiving;
use crate::http::spool::Spool;
use crate::limits;

pub(super) struct RouteGroup {
    routes: OpenApiRouter<App>,
    scope: Option<Scope>,
    budget: Choice,
    timeout: Duration,
    max_bytes: usize,
    spool: Option<Spool>,
}

impl RouteGroup {
    /// Routes with the default timeout and without a body.
    pub(super) fn new(routes: OpenApiRouter<App>, scope: Option<Scope>, budget: impl Into<Choice>) -> Self {
        Self {
            routes,
            scope,
            budget: budget.into(),
            timeout: limits::REQUEST,
            max_bytes: 0,
            spool: None,
        }
    }

    pub(super) fn with_timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }

    pub(super) fn with_body(self, max_bytes: usize) -> Self {
        Self { max_bytes, ..self }
    }

    /// A large body, kept on disk until its turn.
    pub(super) fn with_upload(self, max_bytes: usize, spool: &Spool) -> Self {
        Self {
            max_bytes,
            spool: Some(spool.clone()),
            ..self
        }
    }

    pub(super) fn build(self, receiving: Receiving, tokens: &Arc<Tokens>) -> OpenApiRouter<App> {
        let group = Group {
            scope: self.scope,
            budget: self.budget,
            timeout: self.timeout,
            receiving: Receiving {
                max_bytes: self.max_bytes,
                spool: self.spool,
                ..receiving
            },
        };
        group.wrap(self.routes, tokens)
    }
}
