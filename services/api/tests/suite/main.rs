//! The service over real HTTP.
#![allow(
    clippy::unwrap_used,
    reason = "these are tests; helpers beside the test functions may unwrap too"
)]

mod auth;
mod common;
mod control;
mod damaged;
mod documents;
mod fairness;
mod frames;
mod jobs;
mod load;
mod prices;
mod rejections;
mod sandbox;
mod space;
mod streams;
mod versions;
