//! The catalogue against real files.

#![allow(clippy::unwrap_used)]

mod changes;
mod concurrency;
mod fixture;
#[cfg(target_os = "linux")]
mod full;
mod injection;
mod killed;
mod leaves;
mod mirror;
mod pages;
mod questions;
mod scale;
mod upgrade;
