//! `GET /v1/waters`.

use axum::Json;
use axum::extract::State;
use optics::preset::presets;

use crate::app::Shared;
use crate::http::paging::Page;
use crate::waters::view::WaterView;

/// List the optical waters, all on one page: the shipped ones, then the users' own.
#[utoipa::path(get, path = "/v1/waters", tag = "waters",
    responses((status = 200, description = "All waters.", body = Page<WaterView>)))]
pub(crate) async fn list(State(app): State<Shared>) -> Json<Page<WaterView>> {
    let shipped = presets().iter().map(|preset| WaterView::new(preset, None));
    let own = app.waters.all();
    let own = own
        .iter()
        .map(|own| WaterView::new(&own.preset, Some(own.created_ms)));
    Json(Page {
        items: shipped.chain(own).collect(),
        next_cursor: None,
    })
}
