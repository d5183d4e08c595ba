//! What those who run the service ask.

pub(crate) mod routes;
