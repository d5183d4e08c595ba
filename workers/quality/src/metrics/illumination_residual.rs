//! Share of the true illumination left in the picture, see [`Illumination`](crate::illumination::Illumination).

use crate::work::MetricInput;

/// The residual, if it is defined.
pub(crate) fn residual(work: &MetricInput) -> Option<f64> {
    work.subject().illumination?.residual(work.picture())
}
