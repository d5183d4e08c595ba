//! The store against real files.

#![allow(clippy::unwrap_used)]

mod damage;
mod deletion;
mod fixture;
mod packs;
