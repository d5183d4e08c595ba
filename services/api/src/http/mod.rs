//! What every topic needs of HTTP: extractors, problems, layers, the accept loop.

pub(crate) mod auth;
pub(crate) mod bounds;
pub(crate) mod docs;
pub(crate) mod extract;
pub(crate) mod failure;
pub(crate) mod form;
mod held;
pub(crate) mod layers;
pub(crate) mod lines;
pub(crate) mod listener;
pub(crate) mod located;
mod patient;
pub(crate) mod problem;
pub(crate) mod stored;
