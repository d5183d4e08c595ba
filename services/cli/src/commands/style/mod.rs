//! Waters and styles.

pub(crate) mod styles;
pub(crate) mod train;
pub(crate) mod waters;
