//! Stored bytes: the space that they take, who is about to name them, and how they go.

pub(crate) mod naming;
pub(crate) mod reclaim;
pub(crate) mod routes;
pub(crate) mod space;
