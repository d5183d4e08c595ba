//! The routes of each group: one line per endpoint.

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::app::App;
use crate::{datasets, images, jobs, leases, lists, operations, pictures, scenes, sets, styles, waters};

pub(super) fn probe_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(operations::routes::probes::livez))
        .routes(routes!(operations::routes::probes::readyz))
        .routes(routes!(operations::routes::probes::version))
}

pub(super) fn read_routes() -> OpenApiRouter<App> {
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
pub(super) fn query_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(images::routes::list::list))
        .routes(routes!(datasets::routes::stats::stats))
        .routes(routes!(datasets::routes::histogram::histogram))
        .routes(routes!(datasets::routes::density::density))
}

pub(super) fn wait_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::get::get))
        .routes(routes!(jobs::routes::description::get))
        .routes(routes!(jobs::routes::warnings::warnings))
        .routes(routes!(styles::routes::training::get))
}

pub(super) fn event_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(jobs::routes::events::events))
}

pub(super) fn line_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::lines::results))
        .routes(routes!(jobs::routes::lines::errors))
        .routes(routes!(datasets::routes::metadata::jsonl))
        .routes(routes!(datasets::routes::metadata::csv))
}

pub(super) fn submit_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(jobs::routes::create::create))
        .routes(routes!(jobs::routes::preview::preview))
        .routes(routes!(jobs::routes::control::delete))
        .routes(routes!(styles::routes::training::delete))
        .routes(routes!(jobs::routes::control::cancel))
        .routes(routes!(jobs::routes::control::pause))
        .routes(routes!(jobs::routes::control::resume))
        .routes(routes!(jobs::routes::control::retry_failed))
        .routes(routes!(jobs::routes::control::finish_elsewhere))
        .routes(routes!(jobs::routes::control::start_again))
        .routes(routes!(datasets::routes::dataset::delete))
        .routes(routes!(datasets::routes::versions::delete))
        .routes(routes!(sets::routes::create::create))
        .routes(routes!(sets::routes::set::delete))
        .routes(routes!(waters::routes::create::create))
        .routes(routes!(waters::routes::water::delete))
        .routes(routes!(scenes::routes::get::delete))
        .routes(routes!(scenes::routes::collections::delete))
}

pub(super) fn render_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(jobs::routes::render::create))
}

pub(super) fn scene_upload_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(scenes::routes::create::create))
}

pub(super) fn style_upload_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::create::create))
}

pub(super) fn training_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(styles::routes::train::train))
}

pub(super) fn verify_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(images::routes::verify::verify))
        .routes(routes!(datasets::routes::versions::seal))
        .routes(routes!(datasets::routes::verify::verify))
}

pub(super) fn image_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(pictures::routes::enhance::enhance))
        .routes(routes!(pictures::routes::measure::measure))
}

pub(super) fn backup_routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(operations::routes::backup::create))
}
