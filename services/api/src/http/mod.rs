//! HTTP infrastructure of all topics: extractors, problems, layers, the accept loop.

pub(crate) mod auth;
pub(crate) mod bounds;
pub(crate) mod budget;
mod connection;
pub(crate) mod extract;
pub(crate) mod failure;
pub(crate) mod form;
pub(crate) mod layers;
pub(crate) mod located;
pub(crate) mod observe;
pub(crate) mod paging;
pub(crate) mod problem;
mod response;

use std::sync::Arc;

pub(crate) use axum::Json;
pub(crate) use axum::extract::State;

use connection::{held, patient};
pub(crate) use connection::{hosts, listener, receive, spool};
pub(crate) use extract::{JsonBytes, MultipartBody, Path, Protobuf, Query};
pub(crate) use problem::{Problem, Slug, found};
pub(crate) use response::{docs, lines, page, picture, problem_page, stored};

/// The state of a topic, for its handlers.
pub(crate) type Topic<T> = State<Arc<T>>;
