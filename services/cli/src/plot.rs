//! Charts as SVG: lines, bars and heat maps.

mod bars;
mod heat;
mod labels;
mod lines;
mod number;
mod scale;
mod svg;

pub use bars::{Bar, Bars};
pub use heat::HeatMap;
pub use lines::{Form, Lines, Mark, Series};
pub use number::format_number;
pub use scale::Axis;
