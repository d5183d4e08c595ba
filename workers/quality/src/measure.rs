//! Measures a picture by any number of metrics.

use std::collections::BTreeMap;

use imaging::{Rgb8, cancel};

use crate::error::QualityError;
use crate::registry::{MetricFormula, MetricId};
use crate::work::MetricInput;

/// Measures a picture and returns the values in the order of the request. Pixels are 8-bit sRGB codes.
///
/// # Errors
/// [`QualityError`] if the picture has no pixels, if a metric needs `clean` and it is `None`, or if `clean` has another
/// size.
pub fn measure(
    picture: &Rgb8,
    clean: Option<&Rgb8>,
    metrics: &[MetricId],
) -> Result<Vec<(MetricId, f64)>, QualityError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(QualityError::Empty { width, height });
    }
    if let Some(metric) = metrics.iter().find(|metric| metric.info().needs_reference) {
        let Some(clean) = clean else {
            return Err(QualityError::NoReference {
                metric: metric.to_string(),
            });
        };
        let (clean_width, clean_height) = (clean.width(), clean.height());
        if (clean_width, clean_height) != (width, height) {
            return Err(QualityError::Size {
                width,
                height,
                clean_width,
                clean_height,
            });
        }
    }
    let work = MetricInput::new(picture, clean);
    let mut known = BTreeMap::new();
    let measured = metrics
        .iter()
        .map(|&metric| (metric, value(&work, metric, &mut known)));
    Ok(measured.collect())
}

/// A metric's value, computed once: sums need it, too.
fn value(work: &MetricInput, metric: MetricId, known: &mut BTreeMap<MetricId, f64>) -> f64 {
    if let Some(value) = known.get(&metric) {
        return *value;
    }
    cancel::check();
    let computed = match metric.info().compute {
        MetricFormula::Direct(compute) => compute(work),
        MetricFormula::Sum(terms) => terms
            .iter()
            .map(|(name, weight)| weight * value(work, metric.sibling(name), known))
            .sum(),
    };
    // Adding 0 turns -0 into +0 and nothing else.
    known.insert(metric, computed + 0.0);
    computed + 0.0
}
