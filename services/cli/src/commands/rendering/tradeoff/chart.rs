//! The result as a chart.

use cli::plot::{Axis, Form, Lines, Mark, Series};

use super::point::Point;
use super::report::Report;
use super::variant::Kind;

impl Report {
    /// Distance over time, with the front and a ring around the job's choice.
    pub(super) fn chart(&self) -> Lines {
        let points = &self.measured.points;
        let mut series = Vec::new();
        for kind in Kind::ALL {
            let marks = points.iter().filter(|point| point.variant.kind() == kind);
            let marks: Vec<Mark> = marks.filter_map(mark).collect();
            if !marks.is_empty() {
                let (name, form) = (kind.name().to_owned(), Form::Dots);
                series.push(Series { name, marks, form });
            }
        }
        let front = points.iter().filter(|point| point.is_pareto);
        let mut front: Vec<Mark> = front.filter_map(mark).collect();
        front.sort_by(|one, other| one.x.total_cmp(&other.x));
        let front = front.into_iter().map(|mark| (mark.x, mark.y));
        series.push(Series::new("Pareto front", front, Form::Line));
        let size = &self.measured.timed_size;
        Lines {
            title: format!("{}: distance to the truth over time  (ring: this job)", self.job),
            x: Axis::logarithmic(&format!("ms of a frame at {}x{}", size.width, size.height)),
            y: Axis::from_zero("rms of block means, % of the light"),
            series,
        }
    }
}

/// The point of the chart; `None` without a time.
fn mark(point: &Point) -> Option<Mark> {
    Some(Mark {
        x: point.ms?,
        y: 100.0 * point.distance.rms,
        reach: None,
        label: point.variant.label(),
        ringed: point.variant.is_described,
    })
}
