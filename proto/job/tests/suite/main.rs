//! The public surface of `spec`, tested as its users see it.
#![allow(clippy::unwrap_used)]

mod common;
mod daylight;
mod documents;
mod error_page;
mod errors;
mod generated;
mod law_errors;
mod laws;
mod lights;
mod paths;
mod scenes;
mod sites;
mod soup;
mod suspended;
mod truth;
mod waters;
