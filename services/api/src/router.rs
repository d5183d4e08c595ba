//! The router: groups of routes with their requirements.

mod group;
mod routes;

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{get, post};
use utoipa_axum::router::OpenApiRouter;

use self::group::RouteGroup;
use self::routes::*;
use crate::app::App;
use crate::bytes::note;
use crate::http::auth::{Scope, Tokens};
use crate::http::budget::{Budget, Share};
use crate::http::hosts::{self, Hosts};
use crate::http::layers::Choice;
use crate::http::observe::observe;
use crate::http::problem::Problem;
use crate::http::problem_page;
use crate::http::receive::Receiving;
use crate::http::spool::{PLACE_BYTES, Spool};
use crate::limits::{self, Limits, SHED_AFTER, SHED_IMMEDIATELY, SHED_QUERY_AFTER, SHED_UPLOAD_AFTER};
use crate::lists::List;
use crate::{bytes, http, jobs, leases, openapi, scenes, styles};

/// The whole application.
pub(crate) fn router(app: App, tokens: &Arc<Tokens>, hosts: Hosts, limits: &Limits) -> Router {
    let budgets = Budgets(limits);
    let probing = budgets.new_budget("probes", limits.requests, SHED_AFTER);
    let requests = budgets.new_budget("reads", limits.requests, SHED_AFTER);
    let queries = budgets.new_budget("queries", limits.queries, SHED_QUERY_AFTER);
    let submissions = budgets.new_budget("submissions", limits.submissions, SHED_AFTER);
    let renders = budgets.new_budget("renders", limits.renders, SHED_IMMEDIATELY);
    let streams = budgets.new_budget("events", limits.streams, SHED_IMMEDIATELY);
    let lines = budgets.new_budget("lines", limits.lines, SHED_IMMEDIATELY);
    let uploads = budgets.new_budget("uploads", limits.uploads, SHED_UPLOAD_AFTER);
    let pictures = budgets.new_budget("pictures", limits.pictures, SHED_UPLOAD_AFTER);
    let backups = budgets.new_budget("backups", 1, SHED_IMMEDIATELY);
    let followers = Choice::ByWait {
        waits: budgets.new_budget("waits", limits.waits, SHED_IMMEDIATELY),
        others: requests.clone(),
    };
    let spool = Spool::new(app.operations.processes.scratch.path(), limits::SCENE_BYTES);
    let (read, submit) = (Some(Scope::Read), Some(Scope::Submit));
    let (upload, wait) = (limits::UPLOAD, limits::MAX_WAIT + limits::LONG_POLL_GRACE);
    let groups = [
        RouteGroup::new(probe_routes(), None, &probing),
        RouteGroup::new(read_routes(), read, &requests),
        RouteGroup::new(query_routes(), read, &queries),
        RouteGroup::new(wait_routes(), read, followers).with_timeout(wait),
        RouteGroup::new(event_routes(), read, &streams),
        RouteGroup::new(line_routes(), read, &lines),
        RouteGroup::new(submit_routes(), submit, &submissions).with_body(limits::JSON_BYTES),
        RouteGroup::new(render_routes(), submit, &renders)
            .with_timeout(wait)
            .with_body(limits::RENDER_BYTES),
        RouteGroup::new(scene_upload_routes(), submit, &uploads)
            .with_timeout(upload)
            .with_upload(limits::SCENE_BYTES, &spool),
        RouteGroup::new(style_upload_routes(), submit, &uploads)
            .with_timeout(upload)
            .with_upload(limits::STYLE_BYTES, &spool),
        RouteGroup::new(training_routes(), submit, &uploads)
            .with_timeout(upload)
            .with_upload(limits::PHOTOS_BYTES, &spool),
        RouteGroup::new(backup_routes(), Some(Scope::Admin), &backups).with_timeout(limits::BACKUP),
        RouteGroup::new(verify_routes(), submit, &renders)
            .with_timeout(upload)
            .with_body(limits::JSON_BYTES),
        RouteGroup::new(image_routes(), submit, &pictures)
            .with_timeout(upload)
            .with_upload(limits::PICTURES_BYTES, &spool),
    ];
    let memory = budgets.bodies("bodies", limits.body_bytes);
    let routes = OpenApiRouter::with_openapi(openapi::frame());
    let routes = groups.into_iter().fold(routes, |routes, group| {
        routes.merge(group.build(budgets.receiving(&memory), tokens))
    });
    let (public, routes) = routes.merge(worker_protocol(tokens, &budgets)).split_for_parts();
    let shipped = List::all().iter().filter(|list| list.stored_at.is_none());
    let list_names: Vec<&str> = shipped.map(|list| list.name).collect();
    let document = openapi::document(routes, &app.styles.vocabulary(&app.waters), &list_names);
    let stored = Arc::clone(&app.bytes);
    public
        .with_state(app)
        .merge(http::docs::router(&document))
        .merge(http::page::router())
        .route("/problems/{slug}", get(problem_page::describe))
        .fallback(|| async { Problem::not_found("no such route; see /docs") })
        .layer(from_fn_with_state(stored, note::note))
        .layer(from_fn_with_state(hosts, hosts::check_host))
        .layer(from_fn(observe))
}

/// Creates budgets with the same share per caller.
struct Budgets<'a>(&'a Limits);

impl Budgets<'_> {
    fn new_budget(&self, name: &'static str, places: usize, patience: Duration) -> Budget {
        let share = Share {
            percent: self.0.caller_percent,
        };
        Budget::new(name, places, share, patience)
    }

    /// A budget of bodies in memory.
    fn bodies(&self, name: &'static str, bytes: usize) -> Budget {
        self.new_budget(name, bytes / PLACE_BYTES, SHED_IMMEDIATELY)
    }

    /// Settings for receiving bodies; by default none is accepted.
    fn receiving(&self, memory: &Budget) -> Receiving {
        Receiving {
            max_bytes: 0,
            grace: self.0.body_grace,
            memory: memory.clone(),
            spool: None,
        }
    }
}

/// Worker calls have separate budgets, so that a flood of public requests cannot let a lease expire.
fn worker_protocol(tokens: &Arc<Tokens>, budgets: &Budgets<'_>) -> OpenApiRouter<App> {
    let limits = budgets.0;
    let memory = budgets.bodies("bodies of workers", limits.worker_body_bytes);
    let calls = OpenApiRouter::new()
        .route("/v1/worker/register", post(leases::routes::worker::register))
        .route("/v1/worker/commit", post(leases::routes::frame::commit))
        .route("/v1/worker/fail", post(leases::routes::frame::fail))
        .route("/v1/worker/release", post(leases::routes::worker::release))
        .route(
            "/v1/worker/jobs/{id}",
            get(jobs::routes::description::description),
        )
        .route("/v1/worker/scenes/{id}", get(scenes::routes::files::scene))
        .route("/v1/worker/styles", get(styles::routes::model::styles))
        .route("/v1/worker/styles/{name}", get(styles::routes::model::style))
        .route("/v1/worker/blobs/{digest}", get(bytes::routes::blob));
    let beats = OpenApiRouter::new().route("/v1/worker/beat", post(leases::routes::worker::beat));
    let waits = OpenApiRouter::new().route("/v1/worker/lease", post(leases::routes::worker::lease));
    let uploads = OpenApiRouter::new().route("/v1/worker/artifacts", post(leases::routes::frame::artifacts));
    let wait = limits::MAX_WAIT + limits::LONG_POLL_GRACE;
    let work = Some(Scope::Work);
    let calling = budgets.new_budget("worker calls", limits.worker_calls, SHED_AFTER);
    let beating = budgets.new_budget("worker beats", limits.worker_beats, SHED_AFTER);
    let waiting = budgets.new_budget("worker waits", limits.worker_waits, SHED_AFTER);
    let uploading = budgets.new_budget("worker uploads", limits.worker_uploads, SHED_AFTER);
    let message = limits::WORKER_MESSAGE_BYTES;
    let groups = [
        RouteGroup::new(calls, work, &calling).with_body(message),
        RouteGroup::new(beats, work, &beating)
            .with_timeout(wait)
            .with_body(message),
        RouteGroup::new(waits, work, &waiting)
            .with_timeout(wait)
            .with_body(message),
        RouteGroup::new(uploads, work, &uploading)
            .with_timeout(limits::UPLOAD)
            .with_body(limits::ARTIFACT_BYTES),
    ];
    groups.into_iter().fold(OpenApiRouter::new(), |routes, group| {
        routes.merge(group.build(budgets.receiving(&memory), tokens))
    })
}
