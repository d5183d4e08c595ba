//! Frames, and the scenes, styles and waters that they use.

pub(crate) mod forms;
mod images;
pub(crate) mod lamps;
mod model_error;
pub(crate) mod networks;
pub(crate) mod pictures;
pub(crate) mod rendered;
pub(crate) mod scenes;
pub(crate) mod styles;
pub(crate) mod suspended;
pub(crate) mod waters;
