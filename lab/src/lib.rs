//! The laboratory: speed against accuracy, stability, and the look of the waters. Its experiments make the tables and charts of
//! `docs/`; the product does not depend on it.

pub mod campaign;
pub mod chain;
pub mod chart;
pub mod experiments;
pub mod ibla;
pub mod jobs;
pub mod look;
pub mod measurement;
pub mod parallel;
pub mod report;
pub mod setup;
pub mod stability;
pub mod statistics;
pub mod studio;
pub mod table;
