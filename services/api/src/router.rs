//! The router: one line per endpoint, grouped by requirements.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{get, post};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::app::App;
use crate::bytes::space;
use crate::http::auth::{Scope, Tokens};
use crate::http::budget::{Budget, Share};
use crate::http::hosts::{self, Hosts};
use crate::http::layers::{Choice, Group, observe};
use crate::http::problem;
use crate::http::problem::Problem;
use crate::http::receive::{PLACE_BYTES, Receiving};
use crate::limits::{self, Limits, SHED_AFTER, SHED_AT_ONCE, SHED_QUESTION_AFTER, SHED_UPLOAD_AFTER};
use crate::lists::List;
use crate::{
    bytes, datasets, http, images, jobs, leases, lists, openapi, operations, pictures, scenes, sets, styles,
    waters,
};

/// The whole application.
pub(crate) fn router(app: App, tokens: &Arc<Tokens>, hosts: Hosts, limits: &Limits) -> Router {
    let budgets = Budgets(limits);
    let probing = budgets.new_budget("probes", limits.requests, SHED_AFTER);
    let requests = budgets.new_budget("reads", limits.requests, SHED_AFTER);
    let questions = budgets.new_budget("questions", limits.questions, SHED_QUESTION_AFTER);
    let submissions = budgets.new_budget("submissions", limits.submissions, SHED_AFTER);
    let renders = budgets.new_budget("renders", limits.renders, SHED_AT_ONCE);
    let streams = budgets.new_budget("events", limits.streams, SHED_AT_ONCE);
    let lines = budgets.new_budget("lines", limits.lines, SHED_AT_ONCE);
    let uploads = budgets.new_budget("uploads", limits.uploads, SHED_UPLOAD_AFTER);
    let pictures = budgets.new_budget("pictures", limits.pictures, SHED_UPLOAD_AFTER);
    let backups = budgets.new_budget("backups", 1, SHED_AT_ONCE);
    let memory = budgets.bodies("bodies", limits.body_bytes);
    let followers = Choice::ByWait {
        waits: budgets.new_budget("waits", limits.waits, SHED_AT_ONCE),
        others: requests.clone(),
    };
    let group_of = |scope, budget, timeout, most_bytes| Group {
        scope,
        budget,
        timeout,
        receiving: budgets.receiving(&memory, most_bytes),
    };
    let group = |scope, budget: &Budget, timeout, most_bytes| {
        group_of(scope, Choice::One(budget.clone()), timeout, most_bytes)
    };
    let (read, submit) = (Some(Scope::Read), Some(Scope::Submit));
    let (request, upload) = (limits::REQUEST, limits::UPLOAD);
    let wait = limits::MAX_WAIT + limits::LONG_POLL_GRACE;
    let routes = OpenApiRouter::with_openapi(openapi::frame())
        .merge(group(None, &probing, request, 0).wrap(probe_routes(), tokens))
        .merge(group(read, &requests, request, 0).wrap(read_routes(), tokens))
        .merge(group(read, &questions, request, 0).wrap(query_routes(), tokens))
        .merge(group_of(read, followers, wait, 0).wrap(wait_routes(), tokens))
        .merge(group(read, &streams, request, 0).wrap(event_routes(), tokens))
        .merge(group(read, &lines, request, 0).wrap(line_routes(), tokens))
        .merge(group(submit, &submissions, request, limits::JSON_BYTES).wrap(submit_routes(), tokens))
        .merge(group(submit, &renders, wait, limits::JSON_BYTES).wrap(render_routes(), tokens))
        .merge(group(submit, &uploads, upload, limits::SCENE_BYTES).wrap(scene_upload_routes(), tokens))
        .merge(group(submit, &uploads, upload, limits::STYLE_BYTES).wrap(style_upload_routes(), tokens))
        .merge(group(submit, &uploads, upload, limits::PHOTOS_BYTES).wrap(training_routes(), tokens))
        .merge(group(Some(Scope::Admin), &backups, limits::BACKUP, 0).wrap(backup_routes(), tokens))
        .merge(group(submit, &renders, upload, limits::JSON_BYTES).wrap(verify_routes(), tokens))
        .merge(group(submit, &pictures, upload, limits::PICTURES_BYTES).wrap(image_routes(), tokens));
    let (public, routes) = routes.merge(worker_protocol(tokens, &budgets)).split_for_parts();
    let shipped = List::all().iter().filter(|list| list.stored_at.is_none());
    let list_names: Vec<&str> = shipped.map(|list| list.name).collect();
    let document = openapi::document(routes, &app.styles.vocabulary(&app.waters), &list_names);
    let stored = Arc::clone(&app.bytes);
    public
        .with_state(app)
        .merge(http::docs::router(&document))
        .merge(http::page::router())
        .route("/problems/{slug}", get(problem::describe))
        .fallback(|| async { Problem::not_found("no such route; see /docs") })
        .layer(from_fn_with_state(stored, space::note))
        .layer(from_fn_with_state(hosts, hosts::check_host))
        .layer(from_fn(observe))
}

fn probe_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(operations::routes::probes::livez))
        .routes(routes!(operations::routes::probes::readyz))
        .routes(routes!(operations::routes::probes::version))
}

fn read_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(operations::routes::probes::metrics))
        .routes(routes!(jobs::routes::list::list))
        .routes(routes!(images::routes::image::get))
        .routes(routes!(images::routes::image::artifact))
        .routes(routes!(images::routes::image::artifacts))
        .routes(routes!(images::routes::image::preview))
        .routes(routes!(scenes::routes::list::list))
        .routes(routes!(scenes::routes::get::get))
        .routes(routes!(scenes::routes::collections::list))
        .routes(routes!(scenes::routes::collections::get))
        .routes(routes!(sets::routes::set::list))
        .routes(routes!(sets::routes::set::get))
        .routes(routes!(waters::routes::water::list))
        .routes(routes!(waters::routes::water::get))
        .routes(routes!(styles::routes::list::list))
        .routes(routes!(styles::routes::training::preview))
        .routes(routes!(lists::routes::list::list))
        .routes(routes!(lists::routes::get::get))
        .routes(routes!(datasets::routes::dataset::list))
        .routes(routes!(datasets::routes::dataset::get))
        .routes(routes!(datasets::routes::versions::list))
        .routes(routes!(datasets::routes::versions::get))
        .routes(routes!(leases::routes::worker::list))
}

/// Queries whose time grows with the number of images.
fn query_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(images::routes::list::list))
        .routes(routes!(datasets::routes::stats::stats))
        .routes(routes!(datasets::routes::histogram::histogram))
        .routes(routes!(datasets::routes::density::density))
}

fn wait_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::get::get))
        .routes(routes!(jobs::routes::description::get))
        .routes(routes!(styles::routes::training::get))
}

fn event_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(jobs::routes::events::events))
}

fn line_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::lines::results))
        .routes(routes!(jobs::routes::lines::errors))
        .routes(routes!(datasets::routes::metadata::jsonl))
        .routes(routes!(datasets::routes::metadata::csv))
}

fn submit_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::create::create))
        .routes(routes!(jobs::routes::preview::preview))
        .routes(routes!(jobs::routes::control::delete))
        .routes(routes!(styles::routes::training::delete))
        .routes(routes!(jobs::routes::control::cancel))
        .routes(routes!(jobs::routes::control::pause))
        .routes(routes!(jobs::routes::control::resume))
        .routes(routes!(jobs::routes::control::retry_failed))
        .routes(routes!(datasets::routes::dataset::delete))
        .routes(routes!(datasets::routes::versions::delete))
        .routes(routes!(sets::routes::create::create))
        .routes(routes!(sets::routes::set::delete))
        .routes(routes!(waters::routes::create::create))
        .routes(routes!(waters::routes::water::delete))
        .routes(routes!(scenes::routes::get::delete))
        .routes(routes!(scenes::routes::collections::delete))
}

fn render_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(jobs::routes::render::create))
}

fn scene_upload_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(scenes::routes::create::create))
}

fn style_upload_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::create::create))
}

fn training_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::train::train))
}

fn verify_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(images::routes::verify::verify))
        .routes(routes!(datasets::routes::versions::seal))
        .routes(routes!(datasets::routes::verify::verify))
}

fn image_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(pictures::routes::enhance::enhance))
        .routes(routes!(pictures::routes::measure::measure))
}

fn backup_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(operations::routes::backup::create))
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
        self.new_budget(name, bytes / PLACE_BYTES, SHED_AT_ONCE)
    }

    fn receiving(&self, memory: &Budget, most_bytes: usize) -> Receiving {
        Receiving {
            most_bytes,
            grace: self.0.body_grace,
            memory: memory.clone(),
        }
    }
}

/// Worker calls have separate budgets, so that a flood of public requests cannot let a lease expire.
fn worker_protocol(tokens: &Arc<Tokens>, budgets: &Budgets<'_>) -> OpenApiRouter<App> {
    let limits = budgets.0;
    let memory = budgets.bodies("bodies of workers", limits.worker_body_bytes);
    let group = |name, places, patience, timeout, most_bytes| Group {
        scope: Some(Scope::Work),
        budget: Choice::One(budgets.new_budget(name, places, patience)),
        timeout,
        receiving: budgets.receiving(&memory, most_bytes),
    };
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
    let (request, waiting) = (limits::REQUEST, limits::MAX_WAIT + limits::LONG_POLL_GRACE);
    let message = limits::WORKER_MESSAGE_BYTES;
    let (upload, files) = (limits::UPLOAD, limits::ARTIFACT_BYTES);
    let calling = group("worker calls", limits.worker_calls, SHED_AFTER, request, message);
    let beating = group("worker beats", limits.worker_beats, SHED_AFTER, waiting, message);
    let leasing = group("worker waits", limits.worker_waits, SHED_AFTER, waiting, message);
    let uploading = group("worker uploads", limits.worker_uploads, SHED_AFTER, upload, files);
    OpenApiRouter::new()
        .merge(calling.wrap(calls, tokens))
        .merge(beating.wrap(beats, tokens))
        .merge(leasing.wrap(waits, tokens))
        .merge(uploading.wrap(uploads, tokens))
}
