//! Image quality of the result and of what each enhancement made of it.

use std::collections::BTreeMap;

use enhance::Enhanced;
use imaging::Rgb8;
use quality::MetricId;
use spec::Frame;

use crate::error::RenderError;

/// Metric values by subject: `rgb`, and each enhancement by its name, taken from the picture before its mask.
pub(crate) type Measurements = BTreeMap<String, BTreeMap<String, f64>>;

/// Measures the subjects of a frame.
pub(crate) fn run(
    frame: &Frame,
    rgb: &Rgb8,
    clean: Option<&Rgb8>,
    enhanced: &[(String, Enhanced)],
) -> Result<Measurements, RenderError> {
    let metrics = metrics(frame)?;
    if metrics.is_empty() {
        return Ok(Measurements::new());
    }
    let mut measurements = Measurements::new();
    measurements.insert("rgb".to_owned(), measure(rgb, clean, &metrics)?);
    for (method, enhanced) in enhanced {
        measurements.insert(
            method.clone(),
            measure(&enhanced.unmasked.to_rgb8(), clean, &metrics)?,
        );
    }
    Ok(measurements)
}

/// Whether a metric of the frame compares with the picture in air.
pub(crate) fn needs_clean(frame: &Frame) -> Result<bool, RenderError> {
    Ok(metrics(frame)?.iter().any(|metric| metric.info().needs_reference))
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
