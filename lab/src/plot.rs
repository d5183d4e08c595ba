//! Charts as SVG: lines, bars and heat maps.

mod axis;
mod bars;
mod heat;
mod lines;
mod svg;

pub use axis::Axis;
pub use bars::{Bar, Bars};
pub use heat::HeatMap;
pub use lines::{Form, Lines, Mark, Panels, Series};

/// A chart of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Chart {
    /// Points and lines over two axes.
    Lines(Lines),
    /// Small plots over the same axes.
    Panels(Panels),
    /// Bars with error bars.
    Bars(Bars),
    /// Numbers as colors.
    Heat(HeatMap),
}

impl Chart {
    /// The chart as SVG text.
    #[must_use]
    pub fn svg(&self) -> String {
        match self {
            Self::Lines(lines) => lines.svg(),
            Self::Panels(panels) => panels.svg(),
            Self::Bars(bars) => bars.svg(),
            Self::Heat(map) => map.svg(),
        }
    }
}

/// Colors that are distinguishable with color vision deficiency (Okabe and Ito 2008).
pub const PALETTE: [&str; 8] = [
    "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#787828", "#3c3c3c",
];
const INK: &str = "#1e2226";
const FAINT: &str = "#d6dade";
