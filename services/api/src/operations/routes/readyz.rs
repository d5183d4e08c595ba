//! `GET /readyz`.

use axum::extract::State;

use crate::app::Shared;
use crate::http::problem::{Problem, Slug};

/// Whether requests can be answered: the catalogue is readable, there is space, and the service is not stopping.
///
/// A full disk is looked at again each time: as soon as there is space the answer is 200.
#[utoipa::path(get, path = "/readyz", tag = "operations", security(()),
    responses((status = 200, description = "Ready.", body = String),
              (status = 507, response = crate::openapi::Problem)))]
pub(crate) async fn readyz(State(app): State<Shared>) -> Result<&'static str, Problem> {
    if app.stop.is_cancelled() {
        return Err(Problem::overloaded("the service is stopping"));
    }
    if app.space.is_full().await {
        let detail = "there is no space left for the data directory; reading goes on";
        return Err(Problem::new(Slug::StorageFull, detail));
    }
    app.catalogue
        .job("")
        .await
        .map_err(|error| Problem::overloaded(error.to_string()))?;
    Ok("ready\n")
}
