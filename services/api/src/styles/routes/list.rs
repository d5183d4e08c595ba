use catalogue::Page;
use serde_json::Value;

use crate::http::{Json, Problem, State, Topic};
use crate::openapi::StyleCard;
use crate::styles::Styles;

/// List the style models with their cards on one page.
#[utoipa::path(get, path = "/v1/styles", tag = "styles", operation_id = "list_styles",
    responses((status = 200, description = "All style models: name, digest, source, licence, caveats, and whether it takes noise (`takes_noise`). The card of one that a user added warns \
                                           that nobody has measured its stability.",
               body = Page<StyleCard>)))]
pub(crate) async fn list(State(styles): Topic<Styles>) -> Result<Json<Page<Value>>, Problem> {
    let known = styles.known();
    let cards = known
        .library
        .names()
        .into_iter()
        .filter_map(|name| known.library.get(name));
    let cards: Result<_, _> = cards.map(|model| serde_json::to_value(&model.card)).collect();
    Ok(Json(Page::whole(
        cards.map_err(|error| Problem::internal(&error))?,
    )))
}
