//! Styles and waters, shipped, uploaded and trained.

pub(crate) mod networks;
pub(crate) mod style_training;
pub(crate) mod styles;
pub(crate) mod training;
pub(crate) mod waters;
