//! Frames from description to bytes, jobs without a service, and the worker against a service of a hundred lines.

#![allow(clippy::unwrap_used)]

mod artifacts;
mod common;
mod fake_service;
mod folders;
mod labels;
mod lamps;
mod style;
mod suspended;
mod waters;
mod workers;
