//! `/v1/worker/blobs`.

pub(crate) mod blob;
