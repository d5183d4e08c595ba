//! Time and error of a variant in a case.

use std::time::Instant;

use imaging::{Rgb, transfer};
use quality::MetricId;
use serde_json::json;

use crate::row;
use crate::table::Table;
use cli::plot::{Axis, Form, Lines, Mark, Series};

/// Time and error of one variant in one case.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// The stage or group.
    pub stage: &'static str,
    /// The method.
    pub variant: String,
    /// Number of kernels, layers or nodes, if applicable.
    pub terms: Option<usize>,
    /// The scene or job.
    pub case: String,
    /// Columns and rows.
    pub size: (usize, usize),
    /// Milliseconds.
    pub times: Times,
    /// Differences to the reference; `None` if only time was measured.
    pub difference: Option<Difference>,
    /// The variant of a job without settings.
    pub is_default: bool,
    /// No other variant in this case is both faster and more exact.
    pub is_pareto: bool,
}

/// Milliseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Median run.
    pub median: f64,
    /// The fastest run.
    pub min: f64,
    /// The slowest.
    pub max: f64,
}

/// Slower work is run only a few times.
const SLOW_MS: f64 = 400.0;
const SLOW_RUNS: usize = 3;

/// Measures the run time of `work`, ms.
pub fn time_once<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}

/// Runs `work` once to warm up and then `runs` times; slow work is not warmed up. Returns the result of the last run.
pub fn time<R>(runs: usize, mut work: impl FnMut() -> R) -> (Times, R) {
    let start = Instant::now();
    let mut result = work();
    let first = start.elapsed().as_secs_f64() * 1e3;
    let is_slow = first > SLOW_MS;
    let mut all = if is_slow { vec![first] } else { Vec::new() };
    let runs = if is_slow { runs.min(SLOW_RUNS) } else { runs.max(1) };
    for _ in all.len()..runs {
        all.push(time_once(|| result = work()));
    }
    all.sort_by(f64::total_cmp);
    let times = Times {
        median: all[all.len() / 2],
        min: all[0],
        max: all[all.len() - 1],
    };
    (times, result)
}

/// Differences to a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Largest, in linear light.
    pub max: f64,
    /// Root of the mean square, in linear light.
    pub rmse: f64,
    /// Largest, in 8-bit codes of the encoded picture.
    pub codes: u8,
    /// Mean color difference of the encoded pictures, CIEDE2000.
    pub delta_e: f64,
}

/// Compares two linear pictures of one size.
#[must_use]
pub fn difference(picture: &Rgb<f32>, reference: &Rgb<f32>) -> Difference {
    let planes = picture.planes().iter().zip(reference.planes());
    let pairs = planes.flat_map(|(a, b)| a.data().iter().zip(b.data()));
    let errors = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
    let errors: Vec<f64> = errors.collect();
    let squares: f64 = errors.iter().map(|e| e * e).sum();
    let codes = [picture, reference].map(|light| transfer::encode_rgb8(light).0);
    let pairs = codes[0].data().iter().zip(codes[1].data());
    let metric: Vec<MetricId> = MetricId::parse("ciede2000").into_iter().collect();
    let measured = quality::measure(&codes[0], Some(&codes[1]), &metric).unwrap_or_default();
    Difference {
        max: errors.iter().copied().fold(0.0, f64::max),
        rmse: (squares / errors.len().max(1) as f64).sqrt(),
        codes: pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0),
        delta_e: measured.first().map_or(f64::NAN, |(_, value)| *value),
    }
}

/// Marks the measurements of one stage and case that no other beats in both its fastest run and its largest error.
pub fn mark_pareto(all: &mut [Measurement]) {
    let beaten = all.iter().map(|one| all.iter().any(|other| other.beats(one)));
    let beaten: Vec<bool> = beaten.collect();
    for (one, is_beaten) in all.iter_mut().zip(beaten) {
        one.is_pareto = one.difference.is_some() && !is_beaten;
    }
}

impl Measurement {
    fn beats(&self, other: &Self) -> bool {
        let (Some(one), Some(two)) = (self.difference, other.difference) else {
            return false;
        };
        let is_rival = (self.stage, &self.case) == (other.stage, &other.case);
        let (ms, error) = (self.times.min, one.max);
        is_rival && ms <= other.times.min && error <= two.max && (ms < other.times.min || error < two.max)
    }
}

/// A row for each measurement.
#[must_use]
pub fn table(name: &str, all: &[Measurement]) -> Table {
    let columns = "stage,variant,terms,scene,width,height,ms_median,ms_min,ms_max,error_max,error_rmse,codes_max,delta_e,default,pareto";
    let mut table = Table::new(name, columns.split(','));
    for m in all {
        let mut row = row![m.stage, m.variant, m.terms, m.case, m.size.0, m.size.1];
        row.extend([m.times.median, m.times.min, m.times.max].map(|ms| json!(ms)));
        let d = m.difference;
        row.extend([d.map(|d| d.max), d.map(|d| d.rmse)].map(|error| json!(error)));
        row.extend(row![d.map(|d| d.codes), d.map(|d| d.delta_e)]);
        row.extend(row![m.is_default, m.is_pareto]);
        table.push(row);
    }
    table
}

/// Smaller errors are drawn at this value, since a logarithmic axis has no 0.
const FLOOR: f64 = 1e-8;

/// Largest error against time for one stage and case, with the Pareto front and the default variant.
#[must_use]
pub fn error_chart(title: &str, all: &[Measurement]) -> Lines {
    let mut series: Vec<Series> = Vec::new();
    for measured in all {
        let name = measured.variant.split(" (").next().unwrap_or_default();
        let known = series.iter().position(|series| series.name == name);
        let index = known.unwrap_or_else(|| {
            series.push(Series::new(name, [], Form::Dots));
            series.len() - 1
        });
        series[index].marks.extend(measured.mark());
    }
    let front = all.iter().filter(|m| m.is_pareto).filter_map(Measurement::mark);
    let mut front: Vec<Mark> = front.collect();
    front.sort_by(|a, b| a.x.total_cmp(&b.x));
    let front = front.into_iter().map(|mark| (mark.x, mark.y));
    series.push(Series::new("Pareto front", front, Form::Line));
    Lines {
        title: format!("{title}  (ring: default)"),
        x: Axis::logarithmic("ms: fastest run, line to the median"),
        y: Axis::logarithmic("largest error, linear light"),
        series,
    }
}

impl Measurement {
    /// A point with the number of terms or the suffix in brackets. Other programs on the machine can only add time, so the fastest
    /// run is the least disturbed.
    fn mark(&self) -> Option<Mark> {
        let suffix = self.variant.split_once(" (");
        let suffix = suffix.map(|(_, suffix)| suffix.trim_end_matches(')'));
        let terms = self.terms.map(|terms| terms.to_string());
        Some(Mark {
            x: self.times.min,
            y: self.difference?.max.max(FLOOR),
            reach: Some(self.times.median),
            label: terms.or_else(|| suffix.map(str::to_owned)).unwrap_or_default(),
            ringed: self.is_default,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(ms: f64, error: f64) -> Measurement {
        Measurement {
            stage: "haze",
            variant: "a (1)".to_owned(),
            terms: None,
            case: "wall".to_owned(),
            size: (1, 1),
            times: Times {
                median: ms,
                min: ms,
                max: ms,
            },
            difference: Some(Difference {
                max: error,
                rmse: error,
                codes: 0,
                delta_e: 0.0,
            }),
            is_default: false,
            is_pareto: false,
        }
    }

    #[test]
    fn the_front_holds_the_unbeaten() {
        let points = [(1.0, 0.1), (2.0, 0.2), (2.0, 0.01), (3.0, 0.01)];
        let mut all = points.map(|(ms, error)| measured(ms, error));
        mark_pareto(&mut all);
        assert_eq!(all.each_ref().map(|m| m.is_pareto), [true, false, true, false]);
        assert!(error_chart("haze", &all).svg().contains("Pareto front"));
        assert!(
            table("chart", &all)
                .csv()
                .contains("haze,a (1),,wall,1,1,1.0,1.0,1.0,0.1,0.1,0,0.0,false,true")
        );
    }

    #[test]
    fn equal_pictures_do_not_differ_and_others_by_their_distance() {
        let grey = |v: f32| Rgb::from_fn(4, 3, |_, _| [v; 3]);
        let same = difference(&grey(0.3), &grey(0.3));
        assert_eq!(
            (same.max, same.rmse, same.codes, same.delta_e),
            (0.0, 0.0, 0, 0.0)
        );
        let d = difference(&grey(0.5), &grey(0.25));
        assert!((d.max - 0.25).abs() < 1e-7 && (d.rmse - 0.25).abs() < 1e-7);
        assert!(d.codes == 51 && d.delta_e > 10.0, "{d:?}");
    }
}
