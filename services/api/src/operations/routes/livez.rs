//! `GET /livez`.

/// Whether the process answers at all.
#[utoipa::path(get, path = "/livez", tag = "operations", security(()),
    responses((status = 200, description = "The process answers.", body = String)))]
pub(crate) async fn livez() -> &'static str {
    "ok\n"
}
