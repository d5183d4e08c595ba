//! The service over real HTTP.
#![allow(
    clippy::unwrap_used,
    reason = "these are tests; helpers beside the test functions may unwrap too"
)]

mod auth;
mod bad_input;
mod bad_uploads;
mod common;
mod control;
mod documents;
mod error_page;
mod hostile;
mod images;
mod jobs;
mod lamps;
mod load;
mod messages;
mod misbehavior;
mod pictures;
mod rendered;
mod scenes;
mod space;
mod streams;
mod styles;
mod suspended;
mod versions;
mod waters;
