//! Rendering without a service, and the demonstration.

pub(crate) mod bag;
pub(crate) mod demo;
pub(crate) mod new;
pub(crate) mod plan;
pub(crate) mod render;
pub(crate) mod tradeoff;
