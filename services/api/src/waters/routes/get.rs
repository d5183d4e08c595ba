//! `GET /v1/waters/{name}`.

use axum::Json;
use axum::extract::State;
use optics::preset;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::waters::view::WaterView;

/// See one water. The `/` of a full name is written `%2F`; a bare name means its default source.
#[utoipa::path(get, path = "/v1/waters/{name}", tag = "waters",
    params(("name" = String, Path, description = "Its name")),
    responses((status = 200, description = "The water.", body = WaterView),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn get(
    State(app): State<Shared>,
    Path(name): Path<String>,
) -> Result<Json<WaterView>, Problem> {
    if let Some(preset) = preset::find(&name) {
        return Ok(Json(WaterView::new(preset, None)));
    }
    let own = app.waters.all().into_iter().find(|own| own.preset.name == name);
    let own = own.ok_or_else(|| Problem::not_found(format!("no water `{name}`")))?;
    Ok(Json(WaterView::new(&own.preset, Some(own.created_ms))))
}
