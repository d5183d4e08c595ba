use catalogue::Page;

use crate::http::{Json, Path, Problem, State, Topic};
use crate::lists::entry::{Entry, List};
use crate::openapi::ListName;
use crate::styles::Styles;

/// Get a list of built-in identifiers.
///
/// `GET /v1/lists` names the endpoints of user-defined entries.
#[utoipa::path(get, path = "/v1/lists/{list}", tag = "lists", operation_id = "get_list",
    params(("list" = ListName, Path, description = "Name of the list")),
    responses((status = 200, description = "All entries, on one page.", body = Page<Entry>)))]
pub(crate) async fn get(
    State(styles): Topic<Styles>,
    Path(name): Path<String>,
) -> Result<Json<Page<Entry>>, Problem> {
    let list =
        List::parse(&name).ok_or_else(|| Problem::not_found(format!("no list `{name}`; see /v1/lists")))?;
    match (list.stored_at, list.shipped) {
        (None, Some(shipped)) => Ok(Json(Page::whole(shipped(&styles.known().library)))),
        _ => Err(Problem::not_found(format!(
            "the list `{name}` is at {}",
            list.path()
        ))),
    }
}
