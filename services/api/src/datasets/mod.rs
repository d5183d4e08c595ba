//! Datasets: sums, statistics and tables of their images.

pub(crate) mod routes;
