//! The public surface of `spec`, tested as its users see it.
#![allow(clippy::unwrap_used)]

mod common;
mod documents;
mod error_page;
mod errors;
mod generated;
mod law_errors;
mod laws;
mod parts;
mod soup;
