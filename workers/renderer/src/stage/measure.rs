//! Image quality of the result and of what each enhancement made of it.

use std::collections::BTreeMap;

use enhance::Enhanced;
use imaging::{Rgb, Rgb8, transfer};
use quality::MetricId;
use spec::Frame;

use crate::error::RenderError;
use crate::stopwatch::Stopwatch;

/// Metric values by subject: `rgb`, and each enhancement by its name, taken from the picture before its mask.
pub(crate) type Measurements = BTreeMap<String, BTreeMap<String, f64>>;

/// Measures the subjects of a frame.
pub(crate) fn run(
    frame: &Frame,
    rgb: &Rgb8,
    in_air: &Rgb<f32>,
    enhanced: &[(String, Enhanced)],
    watch: &mut Stopwatch,
) -> Result<Measurements, RenderError> {
    let metrics = metrics(frame)?;
    // Some metrics compare with the picture in air.
    let compares = metrics.iter().any(|metric| metric.info().needs_reference);
    let clean = compares.then(|| watch.time("encode", || transfer::encode_rgb8(in_air).0));
    watch.time("metrics", || of_subjects(&metrics, rgb, clean.as_ref(), enhanced))
}

fn of_subjects(
    metrics: &[MetricId],
    rgb: &Rgb8,
    clean: Option<&Rgb8>,
    enhanced: &[(String, Enhanced)],
) -> Result<Measurements, RenderError> {
    if metrics.is_empty() {
        return Ok(Measurements::new());
    }
    let mut measurements = Measurements::new();
    measurements.insert("rgb".to_owned(), measure(rgb, clean, metrics)?);
    for (method, enhanced) in enhanced {
        measurements.insert(
            method.clone(),
            measure(&enhanced.unmasked.to_rgb8(), clean, metrics)?,
        );
    }
    Ok(measurements)
}

fn metrics(frame: &Frame) -> Result<Vec<MetricId>, RenderError> {
    let one = |name: &String| {
        MetricId::parse(name).ok_or_else(|| RenderError::Unknown {
            kind: "metric",
            name: name.clone(),
        })
    };
    frame.metrics.iter().map(one).collect()
}

fn measure(
    picture: &Rgb8,
    clean: Option<&Rgb8>,
    metrics: &[MetricId],
) -> Result<BTreeMap<String, f64>, RenderError> {
    let values = quality::measure(picture, clean, metrics)?;
    Ok(values
        .into_iter()
        .map(|(metric, value)| (metric.to_string(), value))
        .collect())
}
