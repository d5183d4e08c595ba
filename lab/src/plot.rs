//! Charts as SVG: lines, bars and heat maps.

mod bars;
mod heat;
mod lines;
mod scale;
mod svg;

pub use bars::{Bar, Bars};
pub use heat::HeatMap;
pub use lines::{Form, Lines, Mark, Series};
pub use scale::Axis;
