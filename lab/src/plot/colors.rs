//! Colors of charts.

/// Colors that are distinguishable with color vision deficiency (Okabe and Ito 2008).
pub const PALETTE: [&str; 8] = [
    "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#787828", "#3c3c3c",
];

pub(super) const INK: &str = "#1e2226";

pub(super) const FAINT: &str = "#d6dade";
