//! The measurements of a record: only metrics that the frame requests, and of those all that are always defined.

use std::collections::BTreeMap;

use quality::{MetricId, Needs};
use spec::{Frame, FrameRecord};

/// Returns all faults of the measurements.
pub(super) fn find_faults(frame: &Frame, record: &FrameRecord) -> Vec<String> {
    let mut faults = Vec::new();
    let enhanced = frame.enhance.iter().map(|enhancement| enhancement.name.as_str());
    let subjects: Vec<&str> = std::iter::once("rgb").chain(enhanced).collect();
    for (subject, values) in &record.measurements {
        if !subjects.contains(&subject.as_str()) {
            faults.push(format!("/measurements/{subject}: the frame has no such picture"));
        }
        let others = values.keys().filter(|metric| !frame.metrics.contains(metric));
        faults.extend(others.map(|metric| format!("/measurements/{subject}/{metric} was not requested")));
    }
    for subject in subjects {
        let values = record.measurements.get(subject);
        let missing = frame.metrics.iter().filter(|metric| is_missing(metric, values));
        faults.extend(missing.map(|metric| format!("/measurements/{subject}/{metric} is missing")));
    }
    faults
}

/// Whether a metric has no value although every picture has one: comparisons with other frames and with the true light
/// may be undefined.
fn is_missing(metric: &str, values: Option<&BTreeMap<String, f64>>) -> bool {
    let needs = MetricId::parse(metric).map(|metric| metric.info().needs);
    let is_always_defined = matches!(needs, Some(Needs::Nothing | Needs::PictureInAir));
    is_always_defined && !values.is_some_and(|values| values.contains_key(metric))
}
