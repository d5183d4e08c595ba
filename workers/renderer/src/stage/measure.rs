//! Image quality of the result and of each enhancement, the latter measured before its mask is applied.

use imaging::{Rgb8, transfer};
use quality::MetricId;
use spec::FrameRecord;

use super::enhance::Enhancements;
use crate::context::FrameContext;
use crate::error::RenderError;

/// Measures `rgb` and every enhancement.
pub(crate) fn run(
    context: &FrameContext<'_>,
    rgb: &Rgb8,
    enhancements: &Enhancements,
    record: &mut FrameRecord,
) -> Result<(), RenderError> {
    let metric = |name: &String| {
        MetricId::parse(name).ok_or_else(|| RenderError::Unknown {
            kind: "metric",
            name: name.clone(),
        })
    };
    let metrics = context.frame.metrics.iter().map(metric);
    let metrics = metrics.collect::<Result<Vec<_>, _>>()?;
    if metrics.is_empty() {
        return Ok(());
    }
    // Some metrics need the picture in air as reference.
    let compares = metrics.iter().any(|metric| metric.info().needs_reference);
    let clean = compares.then(|| transfer::encode_rgb8(&context.view(&context.prepared.scene.radiance)).0);
    let mut measure = |subject: &str, picture: &Rgb8| {
        let values = quality::measure(picture, clean.as_ref(), &metrics)?;
        let values = values
            .into_iter()
            .map(|(metric, value)| (metric.to_string(), value));
        record.measurements.insert(subject.to_owned(), values.collect());
        Ok(())
    };
    measure("rgb", rgb)?;
    enhancements
        .iter()
        .try_for_each(|(method, enhanced)| measure(method, &enhanced.unmasked.to_rgb8()))
}
