//! A group of routes with the same requirements.

use std::sync::Arc;
use std::time::Duration;

use utoipa_axum::router::OpenApiRouter;

use crate::app::App;
use crate::http::auth::{Scope, Tokens};
use crate::http::layers::{Choice, Group};
use crate::http::receive::Receiving;
use crate::limits;

pub(super) struct RouteGroup {
    routes: OpenApiRouter<App>,
    scope: Option<Scope>,
    budget: Choice,
    timeout: Duration,
    max_bytes: usize,
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
        }
    }

    pub(super) fn with_timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }

    pub(super) fn with_body(self, max_bytes: usize) -> Self {
        Self { max_bytes, ..self }
    }

    pub(super) fn build(self, receiving: Receiving, tokens: &Arc<Tokens>) -> OpenApiRouter<App> {
        let group = Group {
            scope: self.scope,
            budget: self.budget,
            timeout: self.timeout,
            receiving: Receiving {
                max_bytes: self.max_bytes,
                ..receiving
            },
        };
        group.wrap(self.routes, tokens)
    }
}
