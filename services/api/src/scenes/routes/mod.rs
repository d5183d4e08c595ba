pub(crate) mod collections;
pub(crate) mod create;
pub(crate) mod files;
pub(crate) mod get;
pub(crate) mod list;
