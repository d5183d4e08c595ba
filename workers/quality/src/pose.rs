//! Relative pose of two frames from matched rays: the essential matrix by five points in RANSAC, and its error.

pub(crate) mod cubic;
pub(crate) mod error;
pub(crate) mod essential;
pub(crate) mod five_point;
pub(crate) mod matrix;
pub(crate) mod null_space;
pub(crate) mod polynomial;
pub(crate) mod ransac;
pub(crate) mod rays;
pub(crate) mod refine;
