//! The lease table in random histories, and the worker against a service that loses answers.

#![allow(clippy::unwrap_used)]

mod control;
mod fake_service;
mod poison;
mod promises;
mod simulation;
mod workers;
