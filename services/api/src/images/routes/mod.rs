//! `/v1/images`.

pub(crate) mod artifact;
pub(crate) mod get;
pub(crate) mod list;
pub(crate) mod preview;
pub(crate) mod verify;
