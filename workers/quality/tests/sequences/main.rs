//! Features, and metrics of frames along a camera path.

#![allow(clippy::unwrap_used)]

mod features;
mod metrics;
mod room;
