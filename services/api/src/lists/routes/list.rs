use catalogue::Page;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::Json;
use crate::lists::entry::List;

/// A list of identifiers and their uses.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = List)]
pub(crate) struct ListView {
    /// Name of the list.
    #[schema(example = "metrics")]
    name: &'static str,
    /// Meaning of the entries.
    about: &'static str,
    /// Uses of an entry, in Markdown.
    places: &'static [&'static str],
    /// The path of the list.
    #[schema(example = "/v1/lists/metrics")]
    path: String,
    /// The command that prints it.
    #[schema(example = "fathom list metrics")]
    command: String,
}

/// List all kinds of identifiers in requests, with their uses and endpoints.
#[utoipa::path(get, path = "/v1/lists", tag = "lists", operation_id = "list_lists",
    responses((status = 200, description = "All lists, on one page.", body = Page<ListView>)))]
pub(crate) async fn list() -> Json<Page<ListView>> {
    Json(Page::whole(
        List::all()
            .iter()
            .map(|list: &List| ListView {
                name: list.name,
                about: list.about,
                places: list.places,
                path: list.path(),
                command: list.command(),
            })
            .collect(),
    ))
}
