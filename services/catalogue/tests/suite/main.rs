//! The catalogue against real files.

#![allow(clippy::unwrap_used)]

mod control;
mod deletion;
mod fixture;
mod questions;
mod upkeep;
