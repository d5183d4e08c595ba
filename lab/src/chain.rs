//! Failure modes of the water chain: hostile frames and the limits of their measured figures. Each finding is a test of the same
//! name; docs/science/stability.md describes it.

mod experiment;
mod finding;
mod geometry;
mod numbers;
mod shapes;
mod trial;

pub use experiment::{FINDINGS, NamedFinding, run};
pub use finding::{Figure, Finding, Limit};
