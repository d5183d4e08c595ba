//! The catalogue against real files.

#![allow(clippy::unwrap_used)]

mod concurrency;
mod control;
mod deletion;
mod fixture;
#[cfg(target_os = "linux")]
mod full;
mod import;
mod injection;
mod killed;
mod leaves;
mod mirror;
mod pages;
mod questions;
mod scale;
mod upgrade;
mod upkeep;
mod versions;
