//! Middleware that records responses about a full disk, failed writes or damage.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;

use crate::bytes::Bytes;
use crate::http::problem::{Problem, Slug};

/// Middleware that records responses about a full disk, failed writes or damage.
pub(crate) async fn note(State(bytes): State<Arc<Bytes>>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    match response.extensions().get::<Problem>() {
        Some(problem) if problem.is(Slug::StorageFull) => bytes.space.full.store(true, Ordering::SeqCst),
        Some(problem) if problem.is(Slug::StorageFailed) => bytes.failure.note(problem.detail()),
        Some(problem) if problem.is(Slug::CorruptArtifact) => bytes.catalogue.note_damage(problem.detail()),
        _ => {}
    }
    response
}
