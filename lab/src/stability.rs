//! Failure regions of enhancements and metrics: pictures degraded step by step, the results of each method, and the sensitivity of
//! the result to small changes.

mod cell;
mod degrade;
mod report;

use enhance::Method;
use imaging::{Raster, Rgb8, codec};
use quality::MetricId;

pub use cell::{Cell, Summary};
pub use degrade::{Degradation, LEVELS};
pub use report::{csv, gain_map, markdown, metric_map, ssim_map};

use cell::Sample;

/// The recorded metrics.
pub const METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];

/// A scene to degrade.
#[derive(Debug, Clone)]
pub struct Specimen {
    /// The picture in clear air, which a perfect restoration would return.
    pub clean: Rgb8,
    /// The same under water, before any degradation.
    pub wet: Rgb8,
}

/// Encodes and decodes a picture as JPEG of a quality. Provided by the caller.
pub type Jpeg<'a> = dyn Fn(&Rgb8, u8) -> Rgb8 + Sync + 'a;

/// Runs a method, or `None` for the unchanged picture, over every degradation and level of a specimen.
///
/// Failures of a method and non-finite metrics are counted rather than returned as errors.
pub fn run(method: Option<&'static str>, specimens: &[Specimen], jpeg: &Jpeg<'_>) -> Vec<Cell> {
    let metrics: Vec<MetricId> = METRICS.iter().filter_map(|name| MetricId::parse(name)).collect();
    let judge: Vec<MetricId> = ["ssim", "corner_repeatability"]
        .iter()
        .filter_map(|name| MetricId::parse(name))
        .collect();
    let mut cells = Vec::new();
    for degradation in Degradation::ALL {
        for level in 0..LEVELS {
            let samples = specimens.iter().enumerate().map(|(number, specimen)| {
                let (clean, before) = degradation.apply(specimen, level, number as u64, jpeg);
                let shaken = nudged(&before, number as u64);
                let after = enhanced(method, &before);
                Sample {
                    before: measured(&before, &clean, &judge),
                    after: after
                        .as_ref()
                        .map(|(picture, _)| measured(picture, &clean, &judge)),
                    values: after
                        .as_ref()
                        .map(|(picture, _)| measured(picture, &clean, &metrics)),
                    gain: after
                        .as_ref()
                        .zip(enhanced(method, &shaken))
                        .map(|((a, _), (b, _))| mean_difference(a, &b) / mean_difference(&before, &shaken)),
                    warned: after.as_ref().is_some_and(|(_, warned)| *warned),
                }
            });
            cells.push(Cell::new(
                method,
                degradation,
                level,
                &samples.collect::<Vec<_>>(),
            ));
        }
    }
    cells
}

fn enhanced(method: Option<&'static str>, picture: &Rgb8) -> Option<(Rgb8, bool)> {
    let Some(name) = method else {
        return Some((picture.clone(), false));
    };
    let enhanced = enhance::run(&Method::parse(name)?, &Raster::from(picture.clone())).ok()?;
    Some((enhanced.unmasked.to_rgb8(), !enhanced.warnings.is_empty()))
}

fn measured(picture: &Rgb8, clean: &Rgb8, metrics: &[MetricId]) -> Vec<f64> {
    let values = quality::measure(picture, Some(clean), metrics).unwrap_or_default();
    let value = |metric: &MetricId| {
        values
            .iter()
            .find(|(id, _)| id == metric)
            .map_or(f64::NAN, |(_, v)| *v)
    };
    metrics.iter().map(value).collect()
}

/// The picture with noise of one code: each sample up one, down one or unchanged.
fn nudged(picture: &Rgb8, number: u64) -> Rgb8 {
    let stream = imaging::random::Stream::stage(number, "stability/nudge");
    let data = picture.data().iter().enumerate().map(|(index, &code)| {
        let step = (3.0 * stream.unit(0, index as u64)) as i16 - 1;
        (i16::from(code) + step).clamp(0, 255) as u8
    });
    Rgb8::new(picture.width(), picture.height(), data.collect()).expect("as many samples as before")
}

fn mean_difference(a: &Rgb8, b: &Rgb8) -> f64 {
    let sum: u64 = a
        .data()
        .iter()
        .zip(b.data())
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.data().len() as f64
}

/// Reduces a picture so that its longer side is at most this.
fn reduced(picture: &Rgb8, side: usize) -> Rgb8 {
    codec::downscale(picture, side)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn specimens() -> Vec<Specimen> {
        let clean = Rgb8::from_fn(72, 48, |x, y| {
            let square = if (x / 9 + y / 9) % 2 == 0 { 70 } else { 180 };
            [square, square - (y / 2) as u8, square / 2 + x as u8]
        });
        let wet = Rgb8::from_fn(72, 48, |x, y| clean.pixel(x, y).map(|v| 40 + v / 2));
        vec![Specimen { clean, wet }]
    }

    #[test]
    fn every_method_ends_at_every_level_and_the_maps_show_it() {
        let jpeg = |picture: &Rgb8, quality: u8| {
            let bytes = codec::encode_jpeg(picture, quality).unwrap();
            codec::decode_picture(&bytes).unwrap().to_rgb8()
        };
        for method in [None, Some("hscm"), Some("rghs"), Some("ibla")] {
            let cells = run(method, &specimens(), &jpeg);
            assert_eq!(cells.len(), Degradation::ALL.len() * LEVELS);
            assert_eq!(
                cells.iter().map(|cell| cell.failures).sum::<usize>(),
                0,
                "{method:?}"
            );
            let text = csv(&cells);
            assert_eq!(text.lines().count(), cells.len() + 1);
            assert!(!text.contains("NaN"), "{text}");
            for map in [ssim_map(&cells), gain_map(&cells), metric_map(&cells, 0)] {
                assert!(crate::plot::svg(&map).unwrap().contains("</svg>"));
            }
        }
    }

    #[test]
    fn the_picture_as_it_is_passes_noise_and_loses_nothing() {
        let cells = run(None, &specimens(), &|picture, _| picture.clone());
        assert!(
            cells
                .iter()
                .all(|cell| cell.gain.mean == 1.0 && cell.worse_ssim == 0.0)
        );
        let ssim = |degradation, level| {
            let cell = cells
                .iter()
                .find(|c| c.degradation == degradation && c.level == level);
            cell.unwrap().ssim.0.mean
        };
        // The degradations lower the SSIM.
        for degradation in [
            Degradation::Noise,
            Degradation::Turbidity,
            Degradation::Darkness,
            Degradation::Lamp,
        ] {
            assert!(
                ssim(degradation, LEVELS - 1) < ssim(degradation, 0) - 0.2,
                "{degradation:?}"
            );
        }
    }
}
