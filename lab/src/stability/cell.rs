//! Measurements at one level of one degradation.

use super::Degradation;

/// One specimen at one level.
pub(super) struct Sample {
    /// SSIM and corner repeatability of the degraded picture.
    pub(super) before: Vec<f64>,
    /// The same for the result; `None` if the method failed.
    pub(super) after: Option<Vec<f64>>,
    /// The metrics of the result.
    pub(super) values: Option<Vec<f64>>,
    /// Mean change of the result over that of the picture.
    pub(super) gain: Option<f64>,
    pub(super) warned: bool,
}

/// All specimens at one level of one degradation.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// The method; `None` for the unchanged picture.
    pub method: Option<&'static str>,
    /// The degradation of the picture.
    pub degradation: Degradation,
    /// The level of the degradation.
    pub level: usize,
    /// SSIM to the clean picture before and after the method.
    pub ssim: (Summary, Summary),
    /// Corner repeatability before and after.
    pub repeatability: (Summary, Summary),
    /// The metrics of the result.
    pub values: Vec<Summary>,
    /// Change of the result over change of the picture, for noise of one code.
    pub gain: Summary,
    /// Share of specimens with a lower SSIM after the method than before.
    pub worse_ssim: f64,
    /// Share with a lower corner repeatability.
    pub worse_repeatability: f64,
    /// Share of specimens for which the method returned a warning.
    pub warned: f64,
    /// Failed runs and non-finite values.
    pub failures: usize,
}

/// Mean and extremes over the specimens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

impl Summary {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        if values.is_empty() {
            return Self {
                mean: f64::NAN,
                min: f64::NAN,
                max: f64::NAN,
            };
        }
        Self {
            mean: values.iter().sum::<f64>() / values.len() as f64,
            min: values.iter().copied().fold(f64::INFINITY, f64::min),
            max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

impl Cell {
    pub(super) fn new(
        method: Option<&'static str>,
        degradation: Degradation,
        level: usize,
        samples: &[Sample],
    ) -> Self {
        let before = |which: usize| Summary::new(samples.iter().map(|sample| sample.before[which]));
        let after = |which: usize| {
            Summary::new(
                samples
                    .iter()
                    .filter_map(|sample| Some(sample.after.as_ref()?[which])),
            )
        };
        let share = |n: usize| n as f64 / samples.len().max(1) as f64;
        let worse = |which: usize| {
            let lower = |sample: &&Sample| {
                sample
                    .after
                    .as_ref()
                    .is_some_and(|after| after[which] < sample.before[which] - WORSE)
            };
            share(samples.iter().filter(lower).count())
        };
        let metrics = samples
            .iter()
            .find_map(|sample| sample.values.as_ref())
            .map_or(0, Vec::len);
        let values = (0..metrics).map(|metric| {
            Summary::new(
                samples
                    .iter()
                    .filter_map(|sample| Some(sample.values.as_ref()?[metric])),
            )
        });
        let lost = samples.iter().filter(|sample| sample.after.is_none()).count();
        let finite = |values: &Option<Vec<f64>>| values.iter().flatten().filter(|v| !v.is_finite()).count();
        let not_finite: usize = samples
            .iter()
            .map(|sample| finite(&sample.values) + finite(&sample.after))
            .sum();
        Self {
            method,
            degradation,
            level,
            ssim: (before(0), after(0)),
            repeatability: (before(1), after(1)),
            values: values.collect(),
            gain: Summary::new(samples.iter().filter_map(|sample| sample.gain)),
            worse_ssim: worse(0),
            worse_repeatability: worse(1),
            warned: share(samples.iter().filter(|sample| sample.warned).count()),
            failures: lost + not_finite,
        }
    }
}

/// A smaller loss is not counted: finer differences of SSIM and of shares of corners are invisible.
const WORSE: f64 = 1e-3;
