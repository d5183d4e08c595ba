//! Uploaded scenes.

pub(crate) mod form;
pub(crate) mod keep;
pub(crate) mod routes;
pub(crate) mod view;
