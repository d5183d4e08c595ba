//! The public surface of `spec`, tested as its users see it.
#![allow(clippy::unwrap_used)]

mod common;
mod daylight;
mod documents;
mod errors;
mod law_errors;
mod laws;
mod lights;
mod scenes;
mod sites;
mod soup;
mod suspended;
mod truth;
mod waters;
