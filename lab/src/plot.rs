//! Charts as SVG: lines, bars and heat maps.

mod axis;
mod bars;
mod colors;
mod heat;
mod lines;
mod svg;

pub use axis::Axis;
pub use bars::{Bar, Bars};
pub use colors::PALETTE;
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
