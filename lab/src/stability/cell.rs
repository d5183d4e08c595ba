//! Measurements at one level of one degradation.

use enhance::Method;
use imaging::random::Stream;
use imaging::{Plane, Raster, Rgb8};
use quality::{FrameFeatures, MetricId, Motion, match_features};

use super::degradation::{Degradation, LEVELS, Specimen};
use crate::statistics::{largest, mean};

/// The recorded metrics.
pub(super) const METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];
/// Number of comparisons with the clean picture: SSIM, and the share of features with a match at their place.
const JUDGES: usize = 2;
/// A smaller loss is not counted: finer differences of SSIM and of shares of features are invisible.
const WORSE: f64 = 1e-3;

/// One specimen at one level.
struct Sample {
    /// Comparisons of the degraded picture.
    before: [f64; JUDGES],
    /// Comparisons and [`METRICS`] of the result; `None` if the method failed.
    after: Option<Vec<f64>>,
    /// Mean change of the result over that of the picture.
    gain: Option<f64>,
    warned: bool,
}

/// All specimens at one level of one degradation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    /// The method, or `none` for the unchanged picture.
    pub(super) method: &'static str,
    pub(super) degradation: Degradation,
    pub(super) level: usize,
    /// Mean comparisons before the method.
    pub(super) before: [f64; 2],
    /// Mean comparisons after it.
    pub(super) after: [f64; 2],
    /// Share of specimens that the method made worse by each comparison.
    pub(super) worse: [f64; 2],
    /// Mean [`METRICS`] of the result.
    pub(super) values: Vec<f64>,
    /// Change of the result over change of the picture, for noise of one code: mean and largest.
    pub(super) gain: [f64; 2],
    /// Share of specimens for which the method returned a warning.
    pub(super) warned: f64,
    /// Failed runs and non-finite values.
    pub(super) failures: usize,
}

/// Runs a method over every degradation and level. Failures and non-finite values are counted rather than returned.
pub(super) fn run_method(method: &'static str, specimens: &[Specimen]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for index in 0..Degradation::ALL.len() * LEVELS {
        let (degradation, level) = (Degradation::ALL[index / LEVELS], index % LEVELS);
        let samples = (0u64..).zip(specimens).map(|(number, specimen)| {
            let (clean, before) = degradation.apply(specimen, level, number);
            measure_sample(method, &clean, &before, number)
        });
        let samples: Vec<Sample> = samples.collect();
        cells.push(Cell::new(method, degradation, level, &samples));
    }
    cells
}

fn measure_sample(method: &str, clean: &Rgb8, before: &Rgb8, number: u64) -> Sample {
    let shaken = nudge(before, number);
    let after = enhance_picture(method, before);
    let pair = after.as_ref().zip(enhance_picture(method, &shaken));
    let change = mean_difference(before, &shaken);
    Sample {
        before: judge(before, clean),
        gain: pair.map(|((a, _), (b, _))| mean_difference(a, &b) / change),
        warned: after.as_ref().is_some_and(|(_, warned)| *warned),
        after: after.map(|(picture, _)| {
            let judged = judge(&picture, clean).into_iter();
            judged.chain(measure_metrics(&picture, clean, &METRICS)).collect()
        }),
    }
}

fn enhance_picture(method: &str, picture: &Rgb8) -> Option<(Rgb8, bool)> {
    if method == "none" {
        return Some((picture.clone(), false));
    }
    let enhanced = enhance::run(&Method::parse(method)?, &Raster::from(picture.clone())).ok()?;
    Some((enhanced.picture.to_rgb8(), !enhanced.warnings.is_empty()))
}

/// SSIM, and the share of the clean picture's features with a match within 3 px of their place.
fn judge(picture: &Rgb8, clean: &Rgb8) -> [f64; JUDGES] {
    let ssim = measure_metrics(picture, clean, &["ssim"])[0];
    let [found, wanted] = [picture, clean].map(|picture| FrameFeatures::find(picture, None).adaptive);
    let unmoved = Motion {
        positions: Plane::from_fn(picture.width(), picture.height(), |x, y| {
            [x as f32 + 0.5, y as f32 + 0.5]
        }),
    };
    let matches = match_features(&found, &wanted);
    let correct = unmoved.correct_matches(&found, &wanted, &matches).len();
    [ssim, correct as f64 / wanted.count().max(1) as f64]
}

fn measure_metrics(picture: &Rgb8, clean: &Rgb8, names: &[&str]) -> Vec<f64> {
    let metrics: Vec<MetricId> = names.iter().filter_map(|name| MetricId::parse(name)).collect();
    let values = quality::measure(picture, Some(clean), &metrics).unwrap_or_default();
    let values = metrics.iter().map(|metric| {
        let found = values.iter().find(|(id, _)| id == metric);
        found.map_or(f64::NAN, |(_, value)| *value)
    });
    values.collect()
}

/// The picture with noise of one code: each sample up one, down one or unchanged.
fn nudge(picture: &Rgb8, number: u64) -> Rgb8 {
    let stream = Stream::stage(number, "stability/nudge");
    let data = picture.data().iter().enumerate().map(|(index, &code)| {
        let step = (3.0 * stream.unit(0, index as u64)) as i16 - 1;
        (i16::from(code) + step).clamp(0, 255) as u8
    });
    Rgb8::new(picture.width(), picture.height(), data.collect()).expect("as many samples as before")
}

fn mean_difference(a: &Rgb8, b: &Rgb8) -> f64 {
    let pairs = a.data().iter().zip(b.data());
    let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.data().len() as f64
}

fn finite(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values.filter(|v| v.is_finite()).collect()
}

impl Cell {
    fn new(method: &'static str, degradation: Degradation, level: usize, samples: &[Sample]) -> Self {
        let results = samples.iter().filter_map(|sample| sample.after.as_ref());
        let results: Vec<&Vec<f64>> = results.collect();
        let columns = (0..JUDGES + METRICS.len()).map(|column| finite(results.iter().map(|all| all[column])));
        let means: Vec<f64> = columns.map(|values| mean(&values)).collect();
        let gains = finite(samples.iter().filter_map(|sample| sample.gain));
        let not_finite = results
            .iter()
            .flat_map(|all| all.iter())
            .filter(|v| !v.is_finite());
        let count = samples.len().max(1) as f64;
        Self {
            method,
            degradation,
            level,
            before: [0, 1].map(|judge| mean(&finite(samples.iter().map(|sample| sample.before[judge])))),
            after: [means[0], means[1]],
            worse: [0, 1].map(|judge| {
                let worse = samples.iter().filter(|sample| sample.is_worse(judge));
                worse.count() as f64 / count
            }),
            values: means[JUDGES..].to_vec(),
            gain: [mean(&gains), largest(gains)],
            warned: samples.iter().filter(|sample| sample.warned).count() as f64 / count,
            failures: samples.len() - results.len() + not_finite.count(),
        }
    }
}

impl Sample {
    fn is_worse(&self, judge: usize) -> bool {
        let after = self.after.as_ref();
        after.is_some_and(|after| after[judge] < self.before[judge] - WORSE)
    }
}
