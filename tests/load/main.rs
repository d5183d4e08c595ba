//! End-to-end tests that load the machine or measure time and memory. Cargo runs this binary while no other test runs.

mod bombs;
mod cancel;
mod chaos;
mod flood;
mod liars;
mod uploads;
