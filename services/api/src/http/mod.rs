//! HTTP infrastructure of all topics: extractors, problems, layers, the accept loop.

pub(crate) mod auth;
pub(crate) mod bounds;
pub(crate) mod budget;
pub(crate) mod docs;
pub(crate) mod extract;
pub(crate) mod failure;
pub(crate) mod form;
mod held;
pub(crate) mod hosts;
pub(crate) mod layers;
pub(crate) mod lines;
pub(crate) mod listener;
pub(crate) mod located;
pub(crate) mod observe;
pub(crate) mod page;
pub(crate) mod paging;
mod patient;
pub(crate) mod picture;
pub(crate) mod problem;
pub(crate) mod problem_page;
pub(crate) mod receive;
pub(crate) mod stored;

use std::sync::Arc;

pub(crate) use axum::Json;
pub(crate) use axum::extract::State;

pub(crate) use extract::{JsonBytes, MultipartBody, Path, Protobuf, Query};
pub(crate) use problem::{Problem, Slug, found};

/// The state of a topic, for its handlers.
pub(crate) type Topic<T> = State<Arc<T>>;
