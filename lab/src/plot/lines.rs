//! Points and lines over two axes.

use super::axis::{Axis, Scale};
use super::colors::{FAINT, INK, PALETTE};
use super::svg::{Anchor, Svg};

/// A labeled point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mark {
    /// Horizontal coordinate.
    pub x: f64,
    /// Vertical coordinate.
    pub y: f64,
    /// End of a thin horizontal line from the point.
    pub reach: Option<f64>,
    /// Text next to the point; may be empty.
    pub label: String,
    /// Whether the point has a ring.
    pub ringed: bool,
}

impl Mark {
    /// A plain point.
    #[must_use]
    pub fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            ..Self::default()
        }
    }
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// The points.
    pub marks: Vec<Mark>,
    /// How they are drawn.
    pub form: Form,
}

impl Series {
    /// Plain points.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, form: Form) -> Self {
        Self {
            name: name.into(),
            marks: points.into_iter().map(|(x, y)| Mark::new(x, y)).collect(),
            form,
        }
    }
}

/// How points of one kind are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Separate points.
    Dots,
    /// Points joined by a line.
    Joined,
    /// Only the line, in the color of text.
    Line,
    /// Only the line, in this color.
    Curve(&'static str),
}

/// Points and lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// Title of the chart.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves and dots, in the order of the legend.
    pub series: Vec<Series>,
}

/// Small plots in rows, without legends.
#[derive(Debug, Clone, PartialEq)]
pub struct Panels {
    /// Title of the sheet.
    pub title: String,
    /// The plots.
    pub panels: Vec<Lines>,
    /// Plots per row.
    pub columns: usize,
}

/// A rectangle of the sheet, in pixels.
#[derive(Debug, Clone, Copy)]
struct Area {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

const SIZE: (f64, f64) = (900.0, 560.0);
const PANEL: (f64, f64) = (262.0, 186.0);
const LEGEND_PX: f64 = 210.0;
/// Number of points above which dots are small.
const CROWD: usize = 500;

impl Panels {
    pub(super) fn svg(&self) -> String {
        let rows = self.panels.len().div_ceil(self.columns);
        let mut svg = Svg::new(self.columns as f64 * PANEL.0 + 12.0, 44.0 + rows as f64 * PANEL.1);
        svg.text((12.0, 24.0), &self.title, Anchor::Start);
        for (index, panel) in self.panels.iter().enumerate() {
            let left = (index % self.columns) as f64 * PANEL.0;
            let top = 44.0 + (index / self.columns) as f64 * PANEL.1;
            svg.text((left + 48.0, top + 16.0), &panel.title, Anchor::Start);
            let area = Area {
                left: left + 48.0,
                top: top + 24.0,
                right: left + 244.0,
                bottom: top + 144.0,
            };
            panel.draw(&mut svg, area);
        }
        svg.finish()
    }
}

impl Lines {
    pub(super) fn svg(&self) -> String {
        let mut svg = Svg::new(SIZE.0, SIZE.1);
        svg.text((12.0, 24.0), &self.title, Anchor::Start);
        let area = Area {
            left: 100.0,
            top: 48.0,
            right: SIZE.0 - LEGEND_PX,
            bottom: SIZE.1 - 64.0,
        };
        svg.text_upwards((22.0, (area.top + area.bottom) / 2.0), &self.y.title);
        self.draw(&mut svg, area);
        self.draw_legend(&mut svg, area);
        svg.finish()
    }

    fn draw_legend(&self, svg: &mut Svg, area: Area) {
        for (index, series) in self.series.iter().enumerate() {
            let y = area.top + 16.0 + 22.0 * index as f64;
            let color = series.form.color(index);
            match series.form {
                Form::Line | Form::Curve(_) => {
                    svg.line(&[(area.right + 12.0, y), (area.right + 28.0, y)], color, 1.0);
                }
                Form::Dots | Form::Joined => svg.dot((area.right + 20.0, y), 5.0, color),
            }
            svg.text((area.right + 34.0, y + 4.0), &series.name, Anchor::Start);
        }
    }

    /// Draws grid, curves and points.
    fn draw(&self, svg: &mut Svg, area: Area) {
        let marks = || self.series.iter().flat_map(|series| &series.marks);
        let across = marks().flat_map(|mark| [Some(mark.x), mark.reach]).flatten();
        let x = Scale::new(&self.x, across, (area.left, area.right));
        let y = Scale::new(&self.y, marks().map(|mark| mark.y), (area.bottom, area.top));
        for (at, label) in x.ticks() {
            svg.line(&[(at, area.top), (at, area.bottom)], FAINT, 1.0);
            svg.text((at, area.bottom + 18.0), &label, Anchor::Middle);
        }
        for (at, label) in y.ticks() {
            svg.line(&[(area.left, at), (area.right, at)], FAINT, 1.0);
            svg.text((area.left - 6.0, at + 4.0), &label, Anchor::End);
        }
        let corner = (area.left, area.bottom);
        svg.line(
            &[(area.left, area.top), corner, (area.right, area.bottom)],
            INK,
            1.0,
        );
        let middle = (area.left + area.right) / 2.0;
        svg.text((middle, area.bottom + 36.0), &self.x.title, Anchor::Middle);
        let radius = if marks().count() > CROWD { 2.0 } else { 4.0 };
        for (index, series) in self.series.iter().enumerate() {
            series.draw(svg, (&x, &y), series.form.color(index), radius);
        }
    }
}

impl Form {
    fn color(self, index: usize) -> &'static str {
        match self {
            Self::Line => INK,
            Self::Curve(color) => color,
            Self::Dots | Self::Joined => PALETTE[index % PALETTE.len()],
        }
    }
}

impl Series {
    fn draw(&self, svg: &mut Svg, (x, y): (&Scale, &Scale), color: &str, radius: f64) {
        let points = self.marks.iter();
        let points: Vec<((f64, f64), &Mark)> = points
            .filter_map(|mark| Some(((x.pixel(mark.x)?, y.pixel(mark.y)?), mark)))
            .collect();
        if self.form != Form::Dots {
            let path: Vec<(f64, f64)> = points.iter().map(|(at, _)| *at).collect();
            svg.line(&path, color, if self.form == Form::Line { 1.0 } else { 2.0 });
        }
        if matches!(self.form, Form::Line | Form::Curve(_)) {
            return;
        }
        for (at, mark) in points {
            if let Some(end) = mark.reach.and_then(|reach| x.pixel(reach)) {
                svg.line(&[at, (end, at.1)], color, 1.0);
            }
            svg.dot(at, radius, color);
            if mark.ringed {
                svg.ring(at, 9.0);
            }
            if !mark.label.is_empty() {
                svg.text((at.0 + 8.0, at.1 - 6.0), &mark.label, Anchor::Start);
            }
        }
    }
}
