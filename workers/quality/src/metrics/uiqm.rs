//! UIQM: a weighted sum of UICM, UISM and UIConM of the same profile (Panetta, Gao and Agaian 2016, eq. 9).

/// The terms of the article, shared by the deep-learning program.
pub(crate) const PANETTA: [(&str, f64); 3] = [("uicm", 0.0282), ("uism", 0.2953), ("uiconm", 3.5753)];

/// The terms that reproduce the comparison table from its columns.
pub(crate) const TABLE1: [(&str, f64); 3] =
    [("uicm", 0.037_128_12), ("uism", 0.333_45), ("uiconm", -0.341_44)];
