//! Styles, networks and files that frames share.

pub(crate) mod engine;
pub(crate) mod source;
pub(crate) mod vocabulary;
