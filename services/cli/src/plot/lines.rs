//! Points and lines over two axes.

use super::labels::Labels;
use super::scale::{Axis, Scale};
use super::svg::{FAINT, INK, Svg, color};

/// A labeled point.
#[derive(Debug, Clone, PartialEq)]
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
        let (name, mut marks) = (name.into(), Vec::new());
        for (x, y) in points {
            let (reach, label, ringed) = (None, String::new(), false);
            marks.push(Mark {
                x,
                y,
                reach,
                label,
                ringed,
            });
        }
        Self { name, marks, form }
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

impl Lines {
    /// The chart as SVG text, with a legend.
    #[must_use]
    pub fn svg(&self) -> String {
        let (right, top, bottom) = (690.0, 48.0, 496.0);
        let mut svg = Svg::new(900.0, 560.0, &self.title);
        let turned = format!("fill=\"{INK}\" transform=\"rotate(-90 22 272)\"");
        svg.styled_text((22.0, 272.0), &self.y.title, "middle", &turned);
        self.draw(&mut svg, (100.0, right), (bottom, top));
        for (index, series) in self.series.iter().enumerate() {
            let y = top + 16.0 + 22.0 * index as f64;
            match series.form {
                Form::Line => svg.line(&[(right + 12.0, y), (right + 28.0, y)], INK, 1.0),
                _ => svg.circle((right + 20.0, y), 5.0, &format!("fill=\"{}\"", color(index))),
            }
            svg.text((right + 34.0, y + 4.0), &series.name, "start");
        }
        svg.finish()
    }

    /// Draws grid, curves and points between two columns and two rows of pixels.
    fn draw(&self, svg: &mut Svg, (left, right): (f64, f64), (bottom, top): (f64, f64)) {
        let marks = self.series.iter().flat_map(|series| &series.marks);
        let across = marks
            .clone()
            .flat_map(|mark| [Some(mark.x), mark.reach])
            .flatten();
        let x = Scale::new(&self.x, across, (left, right));
        let y = Scale::new(&self.y, marks.clone().map(|mark| mark.y), (bottom, top));
        let points = marks.filter_map(|mark| Some((x.pixel(mark.x)?, y.pixel(mark.y)?)));
        let mut labels = Labels::new(points, (bottom, top));
        for (column, label) in x.ticks() {
            svg.line(&[(column, top), (column, bottom)], FAINT, 1.0);
            svg.text((column, bottom + 18.0), &label, "middle");
        }
        for (row, label) in y.ticks() {
            svg.line(&[(left, row), (right, row)], FAINT, 1.0);
            svg.text((left - 6.0, row + 4.0), &label, "end");
        }
        svg.line(&[(left, top), (left, bottom), (right, bottom)], INK, 1.0);
        svg.text(((left + right) / 2.0, bottom + 36.0), &self.x.title, "middle");
        for (index, series) in self.series.iter().enumerate() {
            series.draw(svg, (&x, &y), color(index), &mut labels);
        }
    }
}

impl Series {
    fn draw(&self, svg: &mut Svg, (x, y): (&Scale, &Scale), color: &str, labels: &mut Labels) {
        let marks = self.marks.iter();
        let points = marks.filter_map(|mark| Some(((x.pixel(mark.x)?, y.pixel(mark.y)?), mark)));
        let points: Vec<((f64, f64), &Mark)> = points.collect();
        let path: Vec<(f64, f64)> = points.iter().map(|(position, _)| *position).collect();
        match self.form {
            Form::Line => return svg.line(&path, INK, 1.0),
            Form::Joined => svg.line(&path, color, 2.0),
            Form::Dots => {}
        }
        for (position, mark) in points {
            if let Some(end) = mark.reach.and_then(|reach| x.pixel(reach)) {
                svg.line(&[position, (end, position.1)], color, 1.0);
            }
            svg.circle(position, 3.0, &format!("fill=\"{color}\""));
            if mark.ringed {
                svg.circle(position, 9.0, &format!("fill=\"none\" stroke=\"{INK}\""));
            }
            if !mark.label.is_empty() {
                svg.text(labels.place(position, &mark.label), &mark.label, "start");
            }
        }
    }
}
