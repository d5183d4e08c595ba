//! The router: one line for each endpoint, grouped by what they need.

pub(crate) mod backups;
pub(crate) mod datasets;
pub(crate) mod health;
pub(crate) mod images;
pub(crate) mod jobs;
pub(crate) mod pictures;
pub(crate) mod renders;
pub(crate) mod scenes;
pub(crate) mod styles;
pub(crate) mod waters;
pub(crate) mod worker;
pub(crate) mod workers;

use std::sync::Arc;

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{get, post};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use utoipa_swagger_ui::SwaggerUi;

use crate::auth::{Scope, Tokens};
use crate::layers::{Budget, Group, observe};
use crate::limits::{self, Limits};
use crate::problem::Problem;
use crate::state::Shared;
use crate::{openapi, problem, space};

/// The whole application.
pub(crate) fn router(app: Shared, tokens: &Arc<Tokens>, limits: &Limits) -> Router {
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
    let (public, mut document) = routes.merge(worker_protocol(tokens, limits)).split_for_parts();
    openapi::complete(&mut document);
    let pages = SwaggerUi::new("/docs").url("/openapi.json", document);
    let space = Arc::clone(&app.space);
    public
        .with_state(app)
        .merge(pages)
        .route("/problems/{slug}", get(problem::describe))
        .fallback(|| async { Problem::not_found("no such route; see /docs") })
        .layer(from_fn_with_state(space, space::note))
        .layer(from_fn(observe))
}

fn probes() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(health::livez::livez))
        .routes(routes!(health::readyz::readyz))
        .routes(routes!(health::version::version))
}

fn reading() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(health::metrics::metrics))
        .routes(routes!(jobs::list::list))
        .routes(routes!(images::list::list))
        .routes(routes!(images::get::get))
        .routes(routes!(images::artifact::artifact))
        .routes(routes!(images::preview::preview))
        .routes(routes!(scenes::list::list))
        .routes(routes!(waters::list::list))
        .routes(routes!(waters::get::get))
        .routes(routes!(styles::list::list))
        .routes(routes!(datasets::list::list))
        .routes(routes!(datasets::get::get))
        .routes(routes!(datasets::stats::stats))
        .routes(routes!(datasets::histogram::histogram))
        .routes(routes!(workers::list::list))
}

fn following() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(jobs::get::get))
        .routes(routes!(styles::training::get))
}

fn streaming() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(jobs::events::events))
        .routes(routes!(jobs::results::results))
        .routes(routes!(jobs::errors::errors))
        .routes(routes!(datasets::metadata::jsonl))
        .routes(routes!(datasets::metadata::csv))
}

fn submitting() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(jobs::create::create))
        .routes(routes!(jobs::preview::preview))
        .routes(routes!(jobs::delete::delete))
        .routes(routes!(styles::training::delete))
        .routes(routes!(jobs::cancel::cancel))
        .routes(routes!(jobs::pause::pause))
        .routes(routes!(jobs::resume::resume))
        .routes(routes!(jobs::retry_failed::retry_failed))
        .routes(routes!(datasets::delete::delete))
        .routes(routes!(waters::create::create))
        .routes(routes!(waters::delete::delete))
}

fn rendering() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(renders::create::create))
}

fn uploading() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(scenes::create::create))
}

fn adding() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(styles::create::create))
}

fn training() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(styles::train::train))
}

fn verifying() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(images::verify::verify))
}

fn computing() -> OpenApiRouter<Shared> {
    OpenApiRouter::new()
        .routes(routes!(pictures::enhance::enhance))
        .routes(routes!(pictures::measure::measure))
}

fn operating() -> OpenApiRouter<Shared> {
    OpenApiRouter::new().routes(routes!(backups::create::create))
}

/// Calls of workers have budgets of their own: no flood of public requests can let a lease expire.
fn worker_protocol(tokens: &Arc<Tokens>, limits: &Limits) -> OpenApiRouter<Shared> {
    let group = |budget, timeout, body_bytes| Group {
        scope: Some(Scope::Work),
        budget,
        timeout,
        body_bytes,
    };
    let calls = OpenApiRouter::new()
        .route("/v1/worker/register", post(worker::register::register))
        .route("/v1/worker/beat", post(worker::beat::beat))
        .route("/v1/worker/commit", post(worker::commit::commit))
        .route("/v1/worker/fail", post(worker::fail::fail))
        .route("/v1/worker/release", post(worker::release::release))
        .route("/v1/worker/scenes/{id}", get(worker::scene::scene))
        .route("/v1/worker/styles", get(worker::style::styles))
        .route("/v1/worker/styles/{name}", get(worker::style::style))
        .route("/v1/worker/blobs/{digest}", get(worker::blob::blob));
    let waits = OpenApiRouter::new().route("/v1/worker/lease", post(worker::lease::lease));
    let uploads = OpenApiRouter::new().route("/v1/worker/artifacts", post(worker::artifacts::artifacts));
    let waiting = limits::MAX_WAIT + limits::LONG_POLL_GRACE;
    let calls_budget = Budget::new("worker calls", limits.worker_calls);
    let waits_budget = Budget::new("worker waits", limits.worker_waits);
    let uploads_budget = Budget::new("worker uploads", limits.worker_uploads);
    OpenApiRouter::new()
        .merge(group(calls_budget, limits::REQUEST, limits::WORKER_MESSAGE_BYTES).around(calls, tokens))
        .merge(group(waits_budget, waiting, limits::WORKER_MESSAGE_BYTES).around(waits, tokens))
        .merge(group(uploads_budget, limits::UPLOAD, limits::ARTIFACT_BYTES).around(uploads, tokens))
}
