//! The store against real files.

#![allow(clippy::unwrap_used)]

mod damage;
mod deletion;
mod fixture;
#[cfg(target_os = "linux")]
mod full;
mod killed;
mod packs;
