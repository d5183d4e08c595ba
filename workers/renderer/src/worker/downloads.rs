//! Data fetched from the service.

pub(crate) mod fetch;
pub(crate) mod jobs;
pub(crate) mod scenes;
pub(crate) mod styles;
