//! UIQM: a weighted sum of UICM, UISM and UIConM of the same profile (Panetta, Gao and Agaian 2016, eq. 9).
//!
//! The weights of `table1` are those that reproduce the comparison table from its own columns.

use crate::registry::MetricId;
use crate::work::Work;

/// UIQM of the article.
pub(crate) fn panetta(work: &Work) -> f64 {
    weighted(work, "panetta", [0.0282, 0.2953, 3.5753])
}

/// UIQM of the deep-learning program.
pub(crate) fn funie(work: &Work) -> f64 {
    weighted(work, "funie", [0.0282, 0.2953, 3.5753])
}

/// UIQM of the comparison table.
pub(crate) fn table1(work: &Work) -> f64 {
    weighted(work, "table1", [0.037_128_12, 0.333_45, -0.341_44])
}

fn weighted(work: &Work, profile: &str, weights: [f64; 3]) -> f64 {
    let part = |name: &str| {
        let metric =
            MetricId::parse(&format!("{name}@{profile}")).expect("the parts of UIQM are in the registry");
        work.value(metric)
    };
    let [color, sharpness, contrast] = weights;
    color * part("uicm") + sharpness * part("uism") + contrast * part("uiconm")
}
