//! Every metric of reference pictures, before and after enhancement, against reference values.

#[path = "../../enhance/tests/cases/mod.rs"]
mod cases;

use cases::Case;
use imaging::Rgb8;
use quality::{MetricId, measure};
use serde_json::Value;

/// Relative to values above 1: f64 with sums in another order.
const TOLERANCE: f64 = 1e-9;

#[test]
fn golden_metrics_of_the_input() {
    for case in cases::all() {
        assert_metrics(&case, &case.picture("input").to_rgb8(), "metrics");
    }
}

#[test]
fn golden_metrics_after_enhancement() {
    for case in cases::all() {
        assert_metrics(
            &case,
            &case.picture("color").to_rgb8(),
            "metrics_after_hscm_color",
        );
    }
}

fn assert_metrics(case: &Case, picture: &Rgb8, part: &str) {
    let expected = named_values(case, &case.expected[part]);
    assert!(!expected.is_empty(), "{}: {part} is empty", case.name);
    let ids: Vec<MetricId> = expected
        .iter()
        .map(|(name, _)| MetricId::parse(name).unwrap_or_else(|| panic!("{}: no metric {name}", case.name)))
        .collect();
    let measured = measure(picture, None, &ids).expect("the picture has pixels and no metric compares");
    for ((name, expected), (_, actual)) in expected.iter().zip(measured) {
        let difference = (actual - expected).abs();
        let allowed = TOLERANCE * expected.abs().max(1.0);
        assert!(
            difference <= allowed,
            "{} {part}.{name}: {actual} for {expected}",
            case.name
        );
    }
}

/// The numbers of an entry's part by registry name.
fn named_values(case: &Case, part: &Value) -> Vec<(String, f64)> {
    let number = |value: &Value| {
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{}: {value} is no number", case.name))
    };
    let mut named = Vec::new();
    for (key, value) in case.members(part) {
        match key {
            "entropy_gray" => named.push(("entropy".to_owned(), number(value))),
            "entropy_joint_rgb" | "entropy_2d" | "uciqe" => named.push((key.to_owned(), number(value))),
            "entropy_rgb" => {
                let channels = value
                    .as_array()
                    .unwrap_or_else(|| panic!("{}: {value} is no list", case.name));
                assert_eq!(channels.len(), 3, "{}", case.name);
                let names = ["r", "g", "b"].map(|channel| format!("entropy_rgb_{channel}"));
                named.extend(names.into_iter().zip(channels.iter().map(number)));
            }
            "uciqe_terms" => {
                named.extend(
                    case.members(value)
                        .map(|(term, value)| (format!("uciqe_{term}"), number(value))),
                );
            }
            "panetta" | "funie" | "table1" => {
                named.extend(
                    case.members(value)
                        .map(|(name, value)| (format!("{name}@{key}"), number(value))),
                );
            }
            other => panic!("{}: unknown key {other}", case.name),
        }
    }
    named
}
