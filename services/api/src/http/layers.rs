//! Middleware of all requests, from the outside in: request id and log line, problems, panics, cross-site check; then
//! that of the route's group: scope, timeout, body, concurrency permit.
//!
//! `tower-http` has layers for request ids, panics, timeouts and logs. They are not used: each response here is a
//! problem document with the request id, and one function does it with less code than the layers and their adapters.

use std::any::Any;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::{DefaultBodyLimit, MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use futures::FutureExt;
use tracing::Instrument;
use utoipa_axum::router::OpenApiRouter;

use crate::clock::ordered_id;
use crate::http::auth::{Guard, Scope, Tokens, require};
use crate::http::budget::{Budget, identify_caller};
use crate::http::held::Held;
use crate::http::problem::{Problem, Slug};
use crate::http::receive::{Receiving, receive};
use crate::telemetry;

/// Maximum length of a client's request id.
const REQUEST_ID_BYTES: usize = 64;

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

/// Whether the query has a `wait` other than 0.
fn wants_to_wait(request: &Request) -> bool {
    let query = request.uri().query().unwrap_or_default();
    let waits = query.split('&').filter_map(|pair| pair.strip_prefix("wait="));
    waits.into_iter().any(|seconds| seconds != "0")
}

impl Group {
    /// Adds the group's middleware to its routes only; unknown routes belong to no group.
    pub(crate) fn wrap<S: Clone + Send + Sync + 'static>(
        self,
        routes: OpenApiRouter<S>,
        tokens: &Arc<Tokens>,
    ) -> OpenApiRouter<S> {
        let routes = routes
            .route_layer(DefaultBodyLimit::max(self.receiving.most_bytes))
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

/// The outermost layer: assigns the request id, turns problems and panics into responses, writes the log line.
pub(crate) async fn observe(request: Request, next: Next) -> Response {
    let id = request_id(request.headers());
    let method = request.method().clone();
    let path = request.uri().path().to_owned();
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("unmatched", MatchedPath::as_str)
        .to_owned();
    let start = Instant::now();
    let span = tracing::info_span!("request", id);
    let work = async {
        if crosses_sites(&request) {
            Problem::new(Slug::CrossOrigin, "the request comes from a page of another site").into_response()
        } else {
            next.run(request).await
        }
    };
    let response = AssertUnwindSafe(work.instrument(span.clone()))
        .catch_unwind()
        .await
        .unwrap_or_else(report_panic);
    let mut response = as_problem(response, &id);
    let seconds = start.elapsed().as_secs_f64();
    let status = response.status().as_u16();
    telemetry::request(&method, &route, status, seconds);
    let ms = seconds * 1e3;
    // Polling by workers, probes and followers is frequent. Errors are always logged.
    let is_read = method == Method::GET || method == Method::HEAD;
    let is_routine = is_read || route.starts_with("/v1/worker/") || !route.starts_with("/v1/");
    if is_routine && status < 500 {
        span.in_scope(|| tracing::debug!(%method, path, status, ms, "answered"));
    } else {
        span.in_scope(|| tracing::info!(%method, path, status, ms, "answered"));
    }
    if let Ok(value) = HeaderValue::from_str(&id) {
        response.headers_mut().insert("x-request-id", value);
    }
    response
}

fn request_id(headers: &HeaderMap) -> String {
    let given = headers.get("x-request-id").and_then(|value| value.to_str().ok());
    given
        .filter(|id: &&str| {
            (1..=REQUEST_ID_BYTES).contains(&id.len())
                && id
                    .bytes()
                    .all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte))
        })
        .map_or_else(|| format!("req_{}", ordered_id().simple()), str::to_owned)
}

/// Whether a browser sent this from a page of another site. A service without tokens on loopback would otherwise
/// accept it.
fn crosses_sites(request: &Request) -> bool {
    if [Method::GET, Method::HEAD, Method::OPTIONS].contains(request.method()) {
        return false;
    }
    let Some(origin) = request.headers().get(header::ORIGIN) else {
        return false;
    };
    let host = request.headers().get(header::HOST).map(HeaderValue::as_bytes);
    let site = origin
        .to_str()
        .ok()
        .and_then(|text| text.split_once("://"))
        .map(|(_, site)| site.as_bytes());
    site.is_none() || site != host
}

fn report_panic(payload: Box<dyn Any + Send>) -> Response {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    Problem::internal(&format!("panic: {}", text.unwrap_or_default())).into_response()
}

/// Renders a problem. Any other error response, such as an unsupported method, becomes one.
fn as_problem(mut response: Response, id: &str) -> Response {
    if let Some(problem) = response.extensions_mut().remove::<Problem>() {
        return problem.render(Some(id));
    }
    let slug = match response.status() {
        status if !status.is_client_error() && !status.is_server_error() => return response,
        StatusCode::NOT_FOUND => Slug::NotFound,
        StatusCode::METHOD_NOT_ALLOWED => Slug::MethodNotAllowed,
        StatusCode::PAYLOAD_TOO_LARGE => Slug::TooLarge,
        StatusCode::UNSUPPORTED_MEDIA_TYPE => Slug::UnsupportedMediaType,
        status if status.is_client_error() => Slug::InvalidBody,
        _ => Slug::Internal,
    };
    let allow = response.headers_mut().remove(header::ALLOW);
    let problem = Problem::new(slug, "see /openapi.json for routes and methods");
    let problem = match allow {
        Some(allow) => problem.header(header::ALLOW, allow),
        None => problem,
    };
    problem.render(Some(id))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use axum::Router;
    use axum::body::Body;
    use axum::middleware::from_fn;
    use axum::routing::get;
    use tokio::sync::Barrier;
    use tower::ServiceExt;

    use super::*;
    use crate::http::budget::Share;
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
    async fn panics_and_late_answers_are_problems_with_the_request_id() {
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
    fn only_a_request_that_asks_to_wait_counts_as_one() {
        let asks = |query: &str| wants_to_wait(&path(&format!("/v1/jobs/a{query}")));
        assert!(asks("?wait=10") && asks("?since=3&wait=60"));
        assert!(!asks("") && !asks("?wait=0") && !asks("?since=3") && !asks("?xwait=3"));
    }

    #[test]
    fn only_pages_of_other_sites_are_refused() {
        let request = |origin: Option<&str>| {
            let mut request = Request::post("/")
                .header("host", "localhost:7311")
                .body(Body::empty())
                .unwrap();
            if let Some(origin) = origin {
                request.headers_mut().insert("origin", origin.parse().unwrap());
            }
            request
        };
        assert!(!crosses_sites(&request(None)));
        assert!(!crosses_sites(&request(Some("http://localhost:7311"))));
        assert!(crosses_sites(&request(Some("http://evil.example"))));
        assert!(crosses_sites(&request(Some("null"))));
    }
}
