//! Measurements at one level of one degradation.

use enhance::Method;
use imaging::random::Stream;
use imaging::{Raster, Rgb8};
use quality::MetricId;

use super::degradation::{Degradation, Specimen};
use crate::statistics::largest;

/// The recorded metrics.
pub(super) const METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];
/// Metrics against the clean picture, in which more is better.
const JUDGES: [&str; 2] = ["ssim", "corner_repeatability"];
/// A smaller loss is not counted: finer differences of SSIM and of shares of corners are invisible.
const WORSE: f64 = 1e-3;

/// One specimen at one level.
struct Sample {
    /// [`JUDGES`] of the degraded picture.
    before: Vec<f64>,
    /// [`JUDGES`] and [`METRICS`] of the result; `None` if the method failed.
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
    /// Mean [`JUDGES`] before the method.
    pub(super) before: [f64; 2],
    /// Mean [`JUDGES`] after it.
    pub(super) after: [f64; 2],
    /// Share of specimens that the method made worse by each of [`JUDGES`].
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
    let levels = Degradation::ALL
        .into_iter()
        .flat_map(|degradation| (0..degradation.levels().len()).map(move |level| (degradation, level)));
    let cells = levels.map(|(degradation, level)| {
        let samples = specimens.iter().enumerate();
        let samples: Vec<Sample> = samples
            .map(|(number, specimen)| {
                let (clean, before) = degradation.apply(specimen, level, number as u64);
                measure_sample(method, &clean, &before, number as u64)
            })
            .collect();
        Cell::new(method, degradation, level, &samples)
    });
    cells.collect()
}

fn measure_sample(method: &str, clean: &Rgb8, before: &Rgb8, number: u64) -> Sample {
    let shaken = nudge(before, number);
    let after = enhance_picture(method, before);
    let all: Vec<&str> = JUDGES.into_iter().chain(METRICS).collect();
    let gain = after
        .as_ref()
        .zip(enhance_picture(method, &shaken))
        .map(|((a, _), (b, _))| mean_difference(a, &b) / mean_difference(before, &shaken));
    Sample {
        before: measure_metrics(before, clean, &JUDGES),
        gain,
        warned: after.as_ref().is_some_and(|(_, warned)| *warned),
        after: after.map(|(picture, _)| measure_metrics(&picture, clean, &all)),
    }
}

fn enhance_picture(method: &str, picture: &Rgb8) -> Option<(Rgb8, bool)> {
    if method == "none" {
        return Some((picture.clone(), false));
    }
    let enhanced = enhance::run(&Method::parse(method)?, &Raster::from(picture.clone())).ok()?;
    Some((enhanced.unmasked.to_rgb8(), !enhanced.warnings.is_empty()))
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

/// The mean of finite values; NaN without any.
fn finite_mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    crate::statistics::mean(&values)
}

impl Cell {
    fn new(method: &'static str, degradation: Degradation, level: usize, samples: &[Sample]) -> Self {
        let share = |count: usize| count as f64 / samples.len().max(1) as f64;
        let results = || samples.iter().filter_map(|sample| sample.after.as_ref());
        let after = |index: usize| finite_mean(results().map(|values| values[index]));
        let gains = || {
            samples
                .iter()
                .filter_map(|sample| sample.gain)
                .filter(|gain| gain.is_finite())
        };
        let not_finite: usize = results()
            .map(|values| values.iter().filter(|v| !v.is_finite()).count())
            .sum();
        Self {
            method,
            degradation,
            level,
            before: [0, 1].map(|judge| finite_mean(samples.iter().map(|sample| sample.before[judge]))),
            after: [0, 1].map(after),
            worse: [0, 1].map(|judge| {
                let worse = samples.iter().filter(|sample| {
                    let after = sample.after.as_ref();
                    after.is_some_and(|after| after[judge] < sample.before[judge] - WORSE)
                });
                share(worse.count())
            }),
            values: (0..METRICS.len())
                .map(|metric| after(JUDGES.len() + metric))
                .collect(),
            gain: [finite_mean(gains()), largest(gains())],
            warned: share(samples.iter().filter(|sample| sample.warned).count()),
            failures: samples.len() - results().count() + not_finite,
        }
    }
}
