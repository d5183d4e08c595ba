//! The router: one line for each endpoint, grouped by what they need.

use std::sync::Arc;

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{get, post};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::app::App;
use crate::bytes::space;
use crate::http::auth::{Scope, Tokens};
use crate::http::hosts::{self, Hosts};
use crate::http::layers::{Budget, Group, observe};
use crate::http::problem;
use crate::http::problem::Problem;
use crate::limits::{self, Limits};
use crate::lists::List;
use crate::{
    bytes, datasets, http, images, jobs, leases, lists, openapi, operations, pictures, scenes, sets, styles,
    waters,
};

/// The whole application.
pub(crate) fn router(app: App, tokens: &Arc<Tokens>, hosts: Hosts, limits: &Limits) -> Router {
    let probing = Budget::new("probes", limits.requests);
    let requests = Budget::new("requests", limits.requests);
    let waits = Budget::new("waits", limits.waits);
    let streams = Budget::new("streams", limits.streams);
    let uploads = Budget::new("uploads", limits.uploads);
    let pictures = Budget::new("pictures", limits.pictures);
    let backups = Budget::new("backups", 1);
    let group = |scope, budget: &Budget, timeout, body_bytes| Group {
        scope,
        budget: budget.clone(),
        timeout,
        body_bytes,
    };
    let (read, submit) = (Some(Scope::Read), Some(Scope::Submit));
    let (request, upload) = (limits::REQUEST, limits::UPLOAD);
    let wait = limits::MAX_WAIT + limits::LONG_POLL_GRACE;
    let routes = OpenApiRouter::with_openapi(openapi::frame())
        .merge(group(None, &probing, request, 0).around(probes(), tokens))
        .merge(group(read, &requests, request, 0).around(reading(), tokens))
        .merge(group(read, &waits, wait, 0).around(following(), tokens))
        .merge(group(read, &streams, request, 0).around(streaming(), tokens))
        .merge(group(submit, &requests, request, limits::JSON_BYTES).around(submitting(), tokens))
        .merge(group(submit, &waits, wait, limits::JSON_BYTES).around(rendering(), tokens))
        .merge(group(submit, &uploads, upload, limits::SCENE_BYTES).around(uploading(), tokens))
        .merge(group(submit, &uploads, upload, limits::STYLE_BYTES).around(adding(), tokens))
        .merge(group(submit, &uploads, upload, limits::PHOTOS_BYTES).around(training(), tokens))
        .merge(group(Some(Scope::Admin), &backups, limits::BACKUP, 0).around(operating(), tokens))
        .merge(group(submit, &waits, upload, limits::JSON_BYTES).around(verifying(), tokens))
        .merge(group(submit, &pictures, upload, limits::PICTURES_BYTES).around(computing(), tokens));
    let (public, routes) = routes.merge(worker_protocol(tokens, limits)).split_for_parts();
    let shipped = List::all().iter().filter(|list| list.stored_at.is_none());
    let list_names: Vec<&str> = shipped.map(|list| list.name).collect();
    let document = openapi::document(routes, &app.styles.vocabulary(&app.waters), &list_names);
    let space = Arc::clone(&app.bytes.space);
    public
        .with_state(app)
        .merge(http::docs::router(&document))
        .route("/problems/{slug}", get(problem::describe))
        .fallback(|| async { Problem::not_found("no such route; see /docs") })
        .layer(from_fn_with_state(space, space::note))
        .layer(from_fn_with_state(hosts, hosts::known))
        .layer(from_fn(observe))
}

fn probes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(operations::routes::probes::livez))
        .routes(routes!(operations::routes::probes::readyz))
        .routes(routes!(operations::routes::probes::version))
}

fn reading() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(operations::routes::probes::metrics))
        .routes(routes!(jobs::routes::list::list))
        .routes(routes!(images::routes::list::list))
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
        .routes(routes!(lists::routes::list::list))
        .routes(routes!(lists::routes::get::get))
        .routes(routes!(datasets::routes::dataset::list))
        .routes(routes!(datasets::routes::dataset::get))
        .routes(routes!(datasets::routes::stats::stats))
        .routes(routes!(datasets::routes::versions::list))
        .routes(routes!(datasets::routes::versions::get))
        .routes(routes!(datasets::routes::histogram::histogram))
        .routes(routes!(leases::routes::worker::list))
}

fn following() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::get::get))
        .routes(routes!(styles::routes::training::get))
}

fn streaming() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::events::events))
        .routes(routes!(jobs::routes::lines::results))
        .routes(routes!(jobs::routes::lines::errors))
        .routes(routes!(datasets::routes::metadata::jsonl))
        .routes(routes!(datasets::routes::metadata::csv))
}

fn submitting() -> OpenApiRouter<App> {
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

fn rendering() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(jobs::routes::render::create))
}

fn uploading() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(scenes::routes::create::create))
}

fn adding() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::create::create))
}

fn training() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::train::train))
}

fn verifying() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(images::routes::verify::verify))
        .routes(routes!(datasets::routes::versions::seal))
        .routes(routes!(datasets::routes::verify::verify))
}

fn computing() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(pictures::routes::enhance::enhance))
        .routes(routes!(pictures::routes::measure::measure))
}

fn operating() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(operations::routes::backup::create))
}

/// Calls of workers have budgets of their own: no flood of public requests can let a lease expire.
fn worker_protocol(tokens: &Arc<Tokens>, limits: &Limits) -> OpenApiRouter<App> {
    let group = |budget, timeout, body_bytes| Group {
        scope: Some(Scope::Work),
        budget,
        timeout,
        body_bytes,
    };
    let calls = OpenApiRouter::new()
        .route("/v1/worker/register", post(leases::routes::worker::register))
        .route("/v1/worker/beat", post(leases::routes::worker::beat))
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
    let waits = OpenApiRouter::new().route("/v1/worker/lease", post(leases::routes::worker::lease));
    let uploads = OpenApiRouter::new().route("/v1/worker/artifacts", post(leases::routes::frame::artifacts));
    let waiting = limits::MAX_WAIT + limits::LONG_POLL_GRACE;
    let calls_budget = Budget::new("worker calls", limits.worker_calls);
    let waits_budget = Budget::new("worker waits", limits.worker_waits);
    let uploads_budget = Budget::new("worker uploads", limits.worker_uploads);
    OpenApiRouter::new()
        .merge(group(calls_budget, limits::REQUEST, limits::WORKER_MESSAGE_BYTES).around(calls, tokens))
        .merge(group(waits_budget, waiting, limits::WORKER_MESSAGE_BYTES).around(waits, tokens))
        .merge(group(uploads_budget, limits::UPLOAD, limits::ARTIFACT_BYTES).around(uploads, tokens))
}
