//! Responses that name the place of what was made.

use axum::Json;
use axum::http::{HeaderName, StatusCode, header};

/// A status, `Location`, and what was made.
pub(crate) type Located<T> = (StatusCode, [(HeaderName, String); 1], Json<T>);

pub(crate) fn located<T>(status: StatusCode, location: String, body: T) -> Located<T> {
    (status, [(header::LOCATION, location)], Json(body))
}

/// 201 for what is new, 200 for what was there.
pub(crate) fn created(new: bool) -> StatusCode {
    if new { StatusCode::CREATED } else { StatusCode::OK }
}
