//! `GET /readyz`.

use axum::extract::State;

use crate::problem::Problem;
use crate::state::Shared;

/// Whether requests can be answered: the catalogue and the store are readable and the service is not stopping.
#[utoipa::path(get, path = "/readyz", tag = "operations", security(()),
    responses((status = 200, description = "Ready.", body = String),
              (status = 503, description = "Stopping, or the data directory cannot be read.")))]
pub(crate) async fn readyz(State(app): State<Shared>) -> Result<&'static str, Problem> {
    if app.stop.is_cancelled() {
        return Err(Problem::overloaded("the service is stopping"));
    }
    app.catalogue
        .counts()
        .await
        .map_err(|error| Problem::overloaded(error.to_string()))?;
    Ok("ready\n")
}
