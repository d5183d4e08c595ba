//! Responses with the location of a created resource.

use axum::Json;
use axum::http::{HeaderName, StatusCode, header};

/// A status, `Location`, and the resource.
pub(crate) type Located<T> = (StatusCode, [(HeaderName, String); 1], Json<T>);

pub(crate) fn located<T>(status: StatusCode, location: String, body: T) -> Located<T> {
    (status, [(header::LOCATION, location)], Json(body))
}

/// 201 for a new resource, 200 for an existing one.
pub(crate) fn created(new: bool) -> StatusCode {
    if new { StatusCode::CREATED } else { StatusCode::OK }
}
