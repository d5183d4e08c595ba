use catalogue::Page;
use serde::Deserialize;
use serde_json::Value;
use style::ModelRole;
use utoipa::IntoParams;

use crate::http::{Json, Problem, Query, State, Topic};
use crate::openapi::StyleCard;
use crate::styles::Styles;

/// Selection of models.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only models of this role; all by default.
    role: Option<ModelRole>,
}

/// List the style models, enhancers and metric networks with their cards on one page.
#[utoipa::path(get, path = "/v1/styles", tag = "styles", operation_id = "list_styles", params(Parameters),
    responses((status = 200, description = "All models: name, role, digest, source, licence, caveats, and whether it takes noise (`takes_noise`). The card of one that a user added warns \
                                           that nobody has measured its stability.",
               body = Page<StyleCard>)))]
pub(crate) async fn list(
    State(styles): Topic<Styles>,
    Query(query): Query<Parameters>,
) -> Result<Json<Page<Value>>, Problem> {
    let known = styles.known();
    let models = known.library.models();
    let models = models.filter(|model| query.role.is_none_or(|role| model.card.role == role));
    let cards: Result<_, _> = models.map(|model| serde_json::to_value(&model.card)).collect();
    Ok(Json(Page::whole(
        cards.map_err(|error| Problem::internal(&error))?,
    )))
}
