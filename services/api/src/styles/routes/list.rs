//! `GET /v1/styles`.

use axum::Json;
use axum::extract::State;
use serde_json::Value;

use crate::app::Shared;
use crate::http::paging::Page;
use crate::http::problem::Problem;

/// List the style models with their cards, all on one page.
#[utoipa::path(get, path = "/v1/styles", tag = "waters",
    responses((status = 200, description = "All style models: name, digest, source, licence, caveats, and whether it takes noise (`takes_noise`). The card of one that a user added warns \
                                           that nobody has measured its stability.",
               body = Page<Value>)))]
pub(crate) async fn list(State(app): State<Shared>) -> Result<Json<Page<Value>>, Problem> {
    let known = app.styles.known();
    let library = &known.library;
    let names = library.names();
    let cards = names
        .iter()
        .filter_map(|name| library.get(name))
        .map(|model| serde_json::to_value(&model.card));
    let items = cards
        .collect::<Result<_, _>>()
        .map_err(|error| Problem::internal(&error))?;
    Ok(Json(Page {
        items,
        next_cursor: None,
    }))
}
