//! Jobs: submitted, followed, controlled.

pub(crate) mod control;
pub(crate) mod follow;
pub(crate) mod routes;
pub(crate) mod submit;
pub(crate) mod view;
pub(crate) mod wait;
