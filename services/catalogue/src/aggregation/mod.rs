//! Aggregation over the images of a dataset: statistics, histograms, 2-D histograms.

pub(crate) mod aggregate;
pub(crate) mod groups;
pub(crate) mod histogram;
pub(crate) mod histogram_2d;
pub(crate) mod stats;
