//! Jobs of a service.

pub(crate) mod control;
pub(crate) mod errors;
pub(crate) mod jobs;
pub(crate) mod submit;
pub(crate) mod wait;
