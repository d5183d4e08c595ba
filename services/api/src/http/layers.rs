//! Middleware of a group of routes: scope, timeout, body, concurrency permit. [`super::observe`] is outside of it.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{DefaultBodyLimit, Request, State};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::Response;
use utoipa_axum::router::OpenApiRouter;

use crate::http::auth::{Guard, Scope, Tokens, require};
use crate::http::budget::{Budget, identify_caller};
use crate::http::held::Held;
use crate::http::problem::{Problem, Slug};
use crate::http::receive::{Receiving, receive};

/// Middleware settings of a group of routes.
pub(crate) struct Group {
    pub(crate) scope: Option<Scope>,
    pub(crate) budget: Choice,
    pub(crate) timeout: Duration,
    pub(crate) receiving: Receiving,
}

/// The budget of a request.
#[derive(Clone)]
pub(crate) enum Choice {
    /// One budget for the whole group.
    One(Budget),
    /// Separate budget for long polls.
    ByWait { waits: Budget, others: Budget },
}

impl From<&Budget> for Choice {
    fn from(budget: &Budget) -> Self {
        Self::One(budget.clone())
    }
}

impl Choice {
    fn select(&self, request: &Request) -> &Budget {
        match self {
            Self::One(budget) => budget,
            Self::ByWait { waits, .. } if wants_to_wait(request) => waits,
            Self::ByWait { others, .. } => others,
        }
    }
}

/// Whether the query, read as its route reads it, has a `wait` other than 0.
fn wants_to_wait(request: &Request) -> bool {
    let query = request.uri().query().unwrap_or_default();
    form_urlencoded::parse(query.as_bytes()).any(|(name, seconds)| name == "wait" && seconds != "0")
}

impl Group {
    /// Adds the group's middleware to its routes only; unknown routes belong to no group.
    pub(crate) fn wrap<S: Clone + Send + Sync + 'static>(
        self,
        routes: OpenApiRouter<S>,
        tokens: &Arc<Tokens>,
    ) -> OpenApiRouter<S> {
        let routes = routes
            .route_layer(DefaultBodyLimit::max(self.receiving.max_bytes))
            .route_layer(from_fn_with_state(self.budget, limit_concurrency))
            .route_layer(from_fn_with_state(self.receiving, receive))
            .route_layer(from_fn_with_state(self.timeout, enforce_timeout));
        match self.scope {
            Some(scope) => routes.route_layer(from_fn_with_state(
                Guard {
                    tokens: Arc::clone(tokens),
                    scope,
                },
                require,
            )),
            None => routes,
        }
    }
}

async fn limit_concurrency(
    State(choice): State<Choice>,
    request: Request,
    next: Next,
) -> Result<Response, Problem> {
    let permit = choice
        .select(&request)
        .acquire(&identify_caller(&request))
        .await?;
    let response = next.run(request).await;
    Ok(response.map(|body| Held::wrap(body, permit)))
}

async fn enforce_timeout(
    State(limit): State<Duration>,
    request: Request,
    next: Next,
) -> Result<Response, Problem> {
    tokio::time::timeout(limit, next.run(request)).await.map_err(|_| {
        Problem::new(
            Slug::RequestTimeout,
            format!("the request took longer than {} s", limit.as_secs()),
        )
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use axum::Router;
    use axum::body::Body;
    use axum::http::header;
    use axum::middleware::from_fn;
    use axum::routing::get;
    use tokio::sync::Barrier;
    use tower::ServiceExt;

    use super::*;
    use crate::http::budget::Share;
    use crate::http::observe::observe;
    use crate::limits::SHED_AFTER;

    async fn send(app: &Router, request: Request) -> Response {
        app.clone().oneshot(request).await.unwrap()
    }

    fn path(path: &str) -> Request {
        Request::get(path).body(Body::empty()).unwrap()
    }

    #[tokio::test(start_paused = true)]
    async fn the_budget_holds_over_all_routes_together_and_sheds_the_rest() {
        let (inside, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
        let gate = Arc::new(Barrier::new(4));
        let work = {
            let (inside, most, gate) = (Arc::clone(&inside), Arc::clone(&most), Arc::clone(&gate));
            move || async move {
                most.fetch_max(inside.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                gate.wait().await;
                inside.fetch_sub(1, Ordering::SeqCst);
            }
        };
        let budget = Budget::new("tests", 3, Share { percent: 100 }, SHED_AFTER);
        let app = Router::new()
            .route("/a", get(work.clone()))
            .route("/b", get(work))
            .layer(from_fn_with_state(Choice::One(budget), limit_concurrency))
            .layer(from_fn(observe));
        let calls: Vec<_> = (0..40)
            .map(|i| tokio::spawn(app.clone().oneshot(path(if i % 2 == 0 { "/a" } else { "/b" }))))
            .collect();
        tokio::time::sleep(SHED_AFTER * 2).await;
        assert_eq!(inside.load(Ordering::SeqCst), 3);
        gate.wait().await;
        let mut statuses = Vec::new();
        for call in calls {
            let response = call.await.unwrap().unwrap();
            if response.status() == 503 {
                assert_eq!(response.headers()[header::RETRY_AFTER], "1");
            }
            statuses.push(response.status().as_u16());
        }
        assert_eq!(statuses.iter().filter(|status| **status == 200).count(), 3);
        assert_eq!(statuses.iter().filter(|status| **status == 503).count(), 37);
        assert_eq!(most.load(Ordering::SeqCst), 3);
    }

    #[tokio::test(start_paused = true)]
    async fn panics_and_timeouts_are_problems_with_the_request_id() {
        let app = Router::new()
            .route(
                "/panic",
                get(|| async {
                    if true {
                        panic!("on purpose")
                    }
                }),
            )
            .route("/late", get(std::future::pending::<()>))
            .layer(from_fn_with_state(Duration::from_secs(5), enforce_timeout))
            .layer(from_fn(observe));
        for (route, status) in [("/panic", 500), ("/late", 408)] {
            let mut request = path(route);
            request
                .headers_mut()
                .insert("x-request-id", "mine-1".parse().unwrap());
            let response = send(&app, request).await;
            assert_eq!(response.status(), status);
            assert_eq!(
                response.headers()[header::CONTENT_TYPE],
                "application/problem+json"
            );
            assert_eq!(response.headers()["x-request-id"], "mine-1");
            let body = axum::body::to_bytes(response.into_body(), 4096).await.unwrap();
            assert!(String::from_utf8_lossy(&body).contains(r#""instance":"mine-1""#));
        }
    }

    #[test]
    fn only_a_request_with_a_wait_is_a_long_poll() {
        let asks = |query: &str| wants_to_wait(&path(&format!("/v1/jobs/a{query}")));
        assert!(asks("?wait=10") && asks("?since=3&wait=60") && asks("?%77ait=60") && asks("?w%61it=1"));
        assert!(!asks("") && !asks("?wait=0") && !asks("?since=3") && !asks("?xwait=3"));
    }
}
