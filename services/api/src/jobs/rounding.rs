//! Artifacts of one frame from two kinds of machines, which may differ by rounding.

use imaging::Samples;
use imaging::codec::{NpyValues, decode_npy, decode_picture};
use serde_json::Value;
use spec::{Agreement, compare_values};

/// Maximum mean difference of two pictures, 8-bit codes, or of two ranges, mm: rounding of the last bit.
const MAX_MEAN_CODES: f64 = 1.0;
/// Maximum share of pixels with another label: silhouettes may move by rounding.
const MAX_OTHER_LABELS: f64 = 0.02;
/// Maximum mean difference of two linear layers, relative to their mean.
const MAX_RELATIVE: f64 = 0.02;
/// Kinds whose codes are labels.
const LABELS: [&str; 5] = ["instances", "semantics", "semantics.visible", "findings", "valid"];

/// Why two artifacts of a kind differ by more than rounding; `None` if they do not.
pub(super) fn artifact_differs(kind: &str, stored: &[u8], again: &[u8]) -> Option<String> {
    if stored == again {
        return None;
    }
    if let (Ok(stored), Ok(again)) = (
        serde_json::from_slice(stored),
        serde_json::from_slice::<Value>(again),
    ) {
        let differences = compare_values("", &again, &stored, Agreement::Rounded);
        return differences
            .first()
            .map(|first| format!("{} differs", first.pointer));
    }
    if let (Ok(stored), Ok(again)) = (decode_npy(stored), decode_npy(again)) {
        if stored.shape != again.shape {
            return Some("its shape differs".to_owned());
        }
        return layer_differs(&stored.values, &again.values);
    }
    let (Ok(stored), Ok(again)) = (decode_picture(stored), decode_picture(again)) else {
        return Some("it cannot be decoded".to_owned());
    };
    if (stored.width(), stored.height()) != (again.width(), again.height()) {
        return Some("its size differs".to_owned());
    }
    let is_label = LABELS.contains(&kind) || kind.ends_with(".mask");
    let codes = match (stored.samples(), again.samples()) {
        (Samples::U8(a), Samples::U8(b)) if a.len() == b.len() => {
            Difference::new(a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))))
        }
        (Samples::U16(a), Samples::U16(b)) if a.len() == b.len() => {
            // Deep pictures have 257 codes for one of 8 bits; millimeters and sensor codes count as they are.
            let unit = if ["range", "raw"].contains(&kind) {
                1.0
            } else {
                257.0
            };
            Difference::new(a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)) / unit))
        }
        _ => return Some("its samples differ".to_owned()),
    };
    let (value, limit, what) = match is_label {
        true => (codes.other_share, MAX_OTHER_LABELS, "share of other labels"),
        false => (codes.mean, MAX_MEAN_CODES, "mean difference in codes"),
    };
    (value > limit).then(|| format!("the {what} is {value:.3}; must be at most {limit}"))
}

fn layer_differs(stored: &NpyValues, again: &NpyValues) -> Option<String> {
    let (NpyValues::F32(stored), NpyValues::F32(again)) = (stored, again) else {
        return Some("its numbers are not float32".to_owned());
    };
    let difference = Difference::new(stored.iter().zip(again).map(|(a, b)| distance(*a, *b)));
    let present = again.iter().filter(|value| !value.is_nan());
    let scale = Difference::new(present.map(|value| f64::from(value.abs())));
    let limit = MAX_RELATIVE * scale.mean.max(f64::from(f32::EPSILON));
    (difference.mean.is_nan() || difference.mean > limit).then(|| {
        format!(
            "the mean difference is {:.3e}; must be at most {limit:.3e}",
            difference.mean
        )
    })
}

/// Pixels without a value agree.
fn distance(a: f32, b: f32) -> f64 {
    match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        _ => f64::from((a - b).abs()),
    }
}

/// Statistics of absolute differences.
struct Difference {
    mean: f64,
    other_share: f64,
}

impl Difference {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let (mut sum, mut others, mut count) = (0.0, 0_u64, 0_u64);
        for value in values {
            sum += value;
            others += u64::from(value != 0.0);
            count += 1;
        }
        let count = count.max(1) as f64;
        Self {
            mean: sum / count,
            other_share: others as f64 / count,
        }
    }
}

#[cfg(test)]
mod tests {
    use imaging::codec::{encode_npy_rgb, encode_png};
    use imaging::{Plane, Rgb, Rgb8};

    use super::*;

    fn range(offset: u16) -> Vec<u8> {
        let codes = Plane::from_fn(16, 12, |x, y| 1000 + (40 * x + 7 * y) as u16 + offset);
        encode_png(&codes.into()).unwrap()
    }

    fn light(factor: f32) -> Vec<u8> {
        let picture = Rgb::from_fn(16, 12, |x, _| [factor * x as f32 / 16.0, f32::NAN, 0.1]);
        encode_npy_rgb(&picture)
    }

    #[test]
    fn rounding_passes_and_flat_ranges_black_pictures_and_other_labels_do_not() {
        assert_eq!(artifact_differs("range", &range(1), &range(0)), None);
        let flat = encode_png(&Plane::filled(16, 12, 1000_u16).into()).unwrap();
        assert!(artifact_differs("range", &flat, &range(0)).is_some());
        let picture = Rgb8::from_fn(16, 12, |x, y| [x as u8, y as u8, 90]);
        let picture = encode_png(&picture.into()).unwrap();
        let black = encode_png(&Rgb8::from_fn(16, 12, |_, _| [0; 3]).into()).unwrap();
        assert!(artifact_differs("rgb", &black, &picture).is_some());
        let labels = [0, 1, 2].map(|moved| {
            let labels = Plane::from_fn(100, 10, |x, _| u8::from(x > 50 + 2 * moved));
            encode_png(&labels.into()).unwrap()
        });
        assert_eq!(artifact_differs("semantics", &labels[1], &labels[0]), None);
        assert!(artifact_differs("semantics", &labels[2], &labels[0]).is_some());
    }

    #[test]
    fn layers_and_json_are_compared_by_value() {
        assert_eq!(artifact_differs("direct", &light(1.001), &light(1.0)), None);
        assert!(artifact_differs("direct", &light(1.2), &light(1.0)).is_some());
        assert_eq!(
            artifact_differs("boxes", br#"{"x": 1.0001}"#, br#"{"x": 1}"#),
            None
        );
        assert!(artifact_differs("boxes", br#"{"x": 2}"#, br#"{"x": 1}"#).is_some());
        assert!(artifact_differs("boxes", b"", br#"{"x": 1}"#).is_some());
    }
}
