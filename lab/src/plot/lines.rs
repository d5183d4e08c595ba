//! Points and lines over two axes, each linear or logarithmic.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform};
use plotters_backend::DrawingBackend;

use super::{FAINT, Figure, INK, PALETTE, ink};

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity, with its unit.
    pub title: String,
    /// Whether the axis is logarithmic; values must then be positive.
    pub logarithmic: bool,
}

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

pub(super) const SIZE: (i32, i32) = (900, 560);
const LEFT: i32 = 100;
const RIGHT: i32 = 210;
const TOP: i32 = 48;
const BOTTOM: i32 = 64;

/// Number of points above which dots are small.
const CROWD: usize = 500;

/// Maps values to pixels.
struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    from: i32,
    to: i32,
}

impl Scale {
    fn new(axis: &Axis, values: impl Iterator<Item = f64>, from: i32, to: i32) -> Self {
        let logarithmic = axis.logarithmic;
        let usable = values.filter(|v| v.is_finite() && (!logarithmic || *v > 0.0));
        let (low, high) = usable
            .map(|v| if logarithmic { v.log10() } else { v })
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let room = if high > low { 0.06 * (high - low) } else { 0.5 };
        Self {
            low: low - room,
            high: high + room,
            logarithmic,
            from,
            to,
        }
    }

    fn pixel(&self, value: f64) -> Option<i32> {
        let v = if self.logarithmic { value.log10() } else { value };
        let share = (v - self.low) / (self.high - self.low);
        share
            .is_finite()
            .then(|| self.from + (share * f64::from(self.to - self.from)).round() as i32)
    }

    /// Positions and labels of grid lines.
    fn ticks(&self) -> Vec<(f64, String)> {
        if self.logarithmic {
            let decades = self.low.floor() as i32..=self.high.ceil() as i32;
            let mut ticks = Vec::new();
            // Powers of ten, or finer steps on short axes.
            for multiples in [&[1.0][..], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0]] {
                let all = decades
                    .clone()
                    .flat_map(|decade| multiples.iter().map(move |&m| (m, decade)));
                let values = all.map(|(m, decade)| (m * 10_f64.powi(decade), power_times(m, decade)));
                ticks = values
                    .filter(|(v, _)| (self.low..=self.high).contains(&v.log10()))
                    .collect();
                if ticks.len() > 2 {
                    break;
                }
            }
            return ticks;
        }
        let rough = (self.high - self.low) / 6.0;
        let unit = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * unit)
            .into_iter()
            .find(|&s| s >= rough)
            .unwrap_or(rough);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last)
            .map(|n| n as f64 * step)
            .map(|v| (v, format!("{v:.digits$}")))
            .collect()
    }
}

fn power_times(m: f64, decade: i32) -> String {
    match decade {
        -3..=4 => {
            let digits = decade.min(0).unsigned_abs() as usize;
            let digits = digits + usize::from(m.fract() != 0.0 && decade < 1);
            format!("{:.digits$}", m * 10_f64.powi(decade))
        }
        _ => format!("{m}e{decade}"),
    }
}

impl Figure for Lines {
    fn size(&self) -> (u32, u32) {
        (SIZE.0 as u32, SIZE.1 as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let marks = || self.series.iter().flat_map(|series| &series.marks);
        let (right, bottom) = (SIZE.0 - RIGHT, SIZE.1 - BOTTOM);
        let across = marks().flat_map(|mark| [Some(mark.x), mark.reach]).flatten();
        let x = Scale::new(&self.x, across, LEFT, right);
        let y = Scale::new(&self.y, marks().map(|mark| mark.y), bottom, TOP);
        area.draw(&Text::new(self.title.clone(), (12, 12), ink()))?;
        for (value, text) in x.ticks() {
            let Some(at) = x.pixel(value) else { continue };
            area.draw(&PathElement::new(vec![(at, TOP), (at, bottom)], FAINT))?;
            let style = ink().pos(Pos::new(HPos::Center, VPos::Top));
            area.draw(&Text::new(text, (at, bottom + 8), style))?;
        }
        for (value, text) in y.ticks() {
            let Some(at) = y.pixel(value) else { continue };
            area.draw(&PathElement::new(vec![(LEFT, at), (right, at)], FAINT))?;
            let style = ink().pos(Pos::new(HPos::Right, VPos::Center));
            area.draw(&Text::new(text, (LEFT - 8, at), style))?;
        }
        area.draw(&PathElement::new(
            vec![(LEFT, TOP), (LEFT, bottom), (right, bottom)],
            INK,
        ))?;
        let under = ink().pos(Pos::new(HPos::Center, VPos::Top));
        area.draw(&Text::new(
            self.x.title.clone(),
            ((LEFT + right) / 2, bottom + 32),
            under,
        ))?;
        let beside = ink()
            .pos(Pos::new(HPos::Center, VPos::Top))
            .transform(FontTransform::Rotate270);
        area.draw(&Text::new(self.y.title.clone(), (10, (TOP + bottom) / 2), beside))?;
        let radius = if marks().count() > CROWD { 2 } else { 4 };
        for (index, series) in self.series.iter().enumerate() {
            let row = TOP + 8 + 22 * index as i32;
            let color = match series.form {
                Form::Line => INK,
                _ => PALETTE[index % PALETTE.len()],
            };
            let points = series
                .marks
                .iter()
                .filter_map(|mark| Some(((x.pixel(mark.x)?, y.pixel(mark.y)?), mark)));
            let points: Vec<_> = points.collect();
            if series.form != Form::Dots {
                let path: Vec<_> = points.iter().map(|(at, _)| *at).collect();
                let stroke = color.stroke_width(if series.form == Form::Line { 1 } else { 2 });
                area.draw(&PathElement::new(path, stroke))?;
            }
            area.draw(&Text::new(series.name.clone(), (right + 34, row), ink()))?;
            if series.form == Form::Line {
                let sample = vec![(right + 12, row + 8), (right + 28, row + 8)];
                area.draw(&PathElement::new(sample, INK))?;
                continue;
            }
            area.draw(&Circle::new((right + 20, row + 8), 5, color.filled()))?;
            for (at, mark) in &points {
                if let Some(end) = mark.reach.and_then(|reach| x.pixel(reach)) {
                    area.draw(&PathElement::new(vec![*at, (end, at.1)], color))?;
                }
                area.draw(&Circle::new(*at, radius, color.filled()))?;
                if mark.ringed {
                    area.draw(&Circle::new(*at, 9, INK.stroke_width(2)))?;
                }
                if !mark.label.is_empty() {
                    area.draw(&Text::new(mark.label.clone(), (at.0 + 8, at.1 - 18), ink()))?;
                }
            }
        }
        Ok(())
    }
}
