//! Plots, as SVG text and as a picture of the same figure.

mod bars;
mod canvas;
mod cards;
mod grid;
mod heat;
mod lines;
mod panels;

use std::convert::Infallible;

use imaging::Rgb8;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::{RGBColor, TextStyle, WHITE};
use plotters_backend::DrawingBackend;
use plotters_svg::SVGBackend;

pub use bars::{Bar, Bars};
pub use cards::{Card, Cards};
pub use grid::Grid;
pub use heat::HeatMap;
pub use lines::{Axis, Form, Lines, Mark, Series};
pub use panels::{Panel, Panels};

use canvas::Canvas;

/// A figure that can be drawn on a sheet.
pub trait Figure {
    /// Columns and rows of the sheet.
    fn size(&self) -> (u32, u32);

    /// Draws on a sheet of that size.
    ///
    /// # Errors
    /// The error of the drawing backend.
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>>;
}

/// A figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw: {0}")]
pub struct PlotError(String);

/// The figure as SVG text.
///
/// # Errors
/// [`PlotError`].
pub fn svg(figure: &impl Figure) -> Result<String, PlotError> {
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, figure.size()).into_drawing_area();
    paint(figure, &area)?;
    drop(area);
    Ok(text)
}

/// The figure as a picture.
///
/// # Errors
/// [`PlotError`].
pub fn picture(figure: &impl Figure) -> Result<Rgb8, PlotError> {
    let (width, height) = figure.size();
    let (width, height) = (width as usize, height as usize);
    let mut data = vec![0; 3 * width * height];
    paint(figure, &Canvas::new(width, height, &mut data).into_drawing_area())?;
    Rgb8::new(width, height, data).map_err(|error| PlotError(error.to_string()))
}

fn paint<B: DrawingBackend>(figure: &impl Figure, area: &DrawingArea<B, Shift>) -> Result<(), PlotError> {
    let draw = || {
        area.fill(&WHITE)?;
        figure.draw(area)?;
        area.present()
    };
    draw().map_err(|error| PlotError(error.to_string()))
}

/// Colors that are distinguishable with color vision deficiency (Okabe and Ito 2008).
pub const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(120, 120, 40),
    RGBColor(60, 60, 60),
];
const INK: RGBColor = RGBColor(30, 34, 38);
const FAINT: RGBColor = RGBColor(214, 218, 222);
/// Height of text; the bitmap font's widths depend on it.
const TEXT_PX: u32 = 16;

fn ink() -> TextStyle<'static> {
    TextStyle::from(("monospace", TEXT_PX)).color(&INK)
}

/// Error type of a canvas, which never fails.
type Never = Infallible;
