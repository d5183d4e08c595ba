//! `GET /v1/lists`.

use catalogue::Page;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::Json;
use crate::lists::List;

/// A list of identifiers, and where each of them is sent.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = List)]
pub(crate) struct ListView {
    /// Its own name.
    #[schema(example = "metrics")]
    name: &'static str,
    /// What its entries are.
    about: &'static str,
    /// Where a user sends or meets an entry, in Markdown.
    places: &'static [&'static str],
    /// The path that lists its entries.
    #[schema(example = "/v1/lists/metrics")]
    path: String,
    /// The command that prints them.
    #[schema(example = "fathom list metrics")]
    command: String,
}

/// List the lists: every kind of identifier that a request may hold, where it is sent, and what lists it.
#[utoipa::path(get, path = "/v1/lists", tag = "lists", operation_id = "list_lists",
    responses((status = 200, description = "All lists, on one page.", body = Page<ListView>)))]
pub(crate) async fn list() -> Json<Page<ListView>> {
    let view = |list: &List| ListView {
        name: list.name,
        about: list.about,
        places: list.places,
        path: list.path(),
        command: list.command(),
    };
    Json(Page::whole(List::all().iter().map(view).collect()))
}
