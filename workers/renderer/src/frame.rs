//! One frame: its inputs, effects and light.

pub(crate) mod comparable;
pub(crate) mod content;
pub(crate) mod context;
pub(crate) mod daylight_bounds;
pub(crate) mod effects;
pub(crate) mod inputs;
pub(crate) mod light;
pub(crate) mod preview;
