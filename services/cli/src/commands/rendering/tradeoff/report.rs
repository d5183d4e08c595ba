//! The result as text and as JSON.

use cli::table::{DASH, decimal, table};
use cli::terminal::text_width;
use cli::wrap::paragraph;
use optics::plan::StageId;
use serde_json::{Value, json};

use super::measure::Measured;
use super::point::{Point, mark_front};
use super::variant::Variant;

/// The measured choices of a job with their front.
pub(super) struct Report {
    pub(super) job: String,
    pub(super) measured: Measured,
}

impl Report {
    pub(super) fn new(job: &str, mut measured: Measured) -> Self {
        mark_front(&mut measured.points);
        Self {
            job: job.to_owned(),
            measured,
        }
    }

    /// The content of `tradeoff.json`: all choices, also those that others beat.
    pub(super) fn json(&self) -> Value {
        let measured = &self.measured;
        let truths = measured.truths.iter();
        json!({
            "job": self.job,
            "frames": measured.frames,
            "size": [measured.size.width, measured.size.height],
            "timed_size": [measured.timed_size.width, measured.timed_size.height],
            "paths": truths.clone().map(|truth| truth.paths).collect::<Vec<_>>(),
            "noise": truths.map(|truth| truth.noise).collect::<Vec<_>>(),
            "left_out": measured.left_out,
            "differences": measured.differences,
            "points": measured.points.iter().map(Point::json).collect::<Vec<_>>(),
        })
    }

    /// Tables for people: the front, and the gain of each effect.
    pub(super) fn text(&self) -> String {
        let mut parts = vec![self.describe(), self.front_table()];
        parts.extend(self.effect_table());
        parts.join("\n\n")
    }

    fn describe(&self) -> String {
        let measured = &self.measured;
        let frames: Vec<String> = measured.frames.iter().map(u64::to_string).collect();
        let noise = measured
            .truths
            .iter()
            .map(|truth| truth.noise)
            .fold(0.0, f64::max);
        let paths = measured.truths.iter().map(|truth| truth.paths).max().unwrap_or(0);
        let mut lines = vec![format!(
            "{}, frames {}: distance to the truth at {}x{}, up to {paths} paths per pixel, noise of its blocks at most {:.1} %",
            self.job,
            frames.join(", "),
            measured.size.width,
            measured.size.height,
            100.0 * noise
        )];
        let (width, height) = (measured.timed_size.width, measured.timed_size.height);
        lines.push(match measured.is_timed_small {
            false => format!("ms: median time of the whole frame at {width}x{height} on one core"),
            true => format!(
                "ms: median time of the whole frame at the small size {width}x{height}, since a frame of the job takes more than 10 s"
            ),
        });
        if !measured.left_out.is_empty() {
            lines.push(format!("not compared: {}", measured.left_out.join(", ")));
        }
        lines.extend(
            measured
                .differences
                .iter()
                .map(|text| format!("differs by itself: {text}")),
        );
        let lines = lines.iter().map(|line| paragraph(line, 2, text_width()));
        lines.collect::<Vec<_>>().join("\n")
    }

    /// The points of the front by time, and the default.
    fn front_table(&self) -> String {
        let points = self.measured.points.iter();
        let mut shown: Vec<&Point> = points
            .filter(|point| point.is_pareto || point.variant.is_described)
            .collect();
        shown.sort_by(|one, other| {
            one.ms
                .unwrap_or(f64::MAX)
                .total_cmp(&other.ms.unwrap_or(f64::MAX))
        });
        let rows = shown.iter().map(|point| {
            let mut row = vec![point.variant.name()];
            row.extend(cells(point));
            row.push(match (point.variant.is_described, point.is_pareto) {
                (true, true) => "this job".to_owned(),
                (true, false) => "this job, beaten".to_owned(),
                (false, _) => String::new(),
            });
            row
        });
        let header = [
            "write in the job",
            "ms",
            "planned ms",
            "bias %",
            "rms %",
            "codes",
            "",
        ];
        table(&header, &rows.collect::<Vec<_>>())
    }

    /// The job without each of its effects; `None` if it has none.
    fn effect_table(&self) -> Option<String> {
        let points = self.measured.points.iter();
        let rows = points.filter_map(|point| {
            let id = point.variant.without?;
            let mut row = vec![point.variant.name()];
            row.extend(cells(point));
            row.push(self.find_remedy(id).unwrap_or_else(|| DASH.to_owned()));
            Some(row)
        });
        let rows: Vec<Vec<String>> = rows.collect();
        let header = [
            "this job",
            "ms",
            "planned ms",
            "bias %",
            "rms %",
            "codes",
            "left out by",
        ];
        (!rows.is_empty()).then(|| table(&header, &rows))
    }

    /// The choice nearest to the truth whose plans have no such effect.
    fn find_remedy(&self, id: StageId) -> Option<String> {
        let points = self.measured.points.iter().filter(|point| {
            let has_effect = point.frames.iter().any(|frame| frame.effects.contains(&id));
            point.variant.without.is_none() && point.ms.is_some() && !has_effect
        });
        let nearest = points.min_by(|one, other| one.distance.rms.total_cmp(&other.distance.rms));
        nearest.map(|point| Variant::value(&point.variant).to_string().replace(':', ": "))
    }
}

/// The numbers of a point.
fn cells(point: &Point) -> [String; 5] {
    [
        describe_ms(point.ms),
        describe_ms(point.planned_ms),
        format!("{:+.1}", 100.0 * point.distance.bias),
        format!("{:.1}", 100.0 * point.distance.rms),
        format!("{:.2}", point.distance.codes),
    ]
}

/// Whole milliseconds of times above 10.
fn describe_ms(ms: Option<f64>) -> String {
    let Some(ms) = ms else { return DASH.to_owned() };
    let digit = if ms >= 10.0 { 1.0 } else { 10.0 };
    decimal((digit * ms).round() / digit)
}
