//! The columnar replica: files with rows of images by columns.

pub(crate) mod files;
pub(crate) mod parts;
