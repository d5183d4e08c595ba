//! Comparison of two records of one frame.
//!
//! It serves every place that renders a frame again or receives a record: spot checks, the verification of images and
//! sets, repairs, and the parameters of a commit or an import.

use serde::{Deserialize, Serialize};
use serde_json::{Number, Value, json};
use utoipa::ToSchema;

use crate::record::FrameRecord;

/// Members of a record that may differ between two renderings of a frame: times, and the program and machine.
/// [`Provenance::inputs`](crate::Provenance::inputs) is compared.
pub const UNCOMPARED_MEMBERS: [&str; 4] = [
    "/timings_ms",
    "/provenance/code_version",
    "/provenance/cpu_features",
    "/provenance/onnx_runtime",
];
/// Further members that differ if numbers are rounded differently. Compare the bytes of the artifacts instead.
const BYTE_MEMBERS: [&str; 2] = ["/digest", "/bytes"];
/// Tolerance for numbers on another kind of machine, relative to the larger one: choices of the planner and counts of
/// pixels follow thresholds, so rounding can move them by more than the last bits.
const ROUNDING: f64 = 0.02;
/// Tolerance for numbers near 0.
const ROUNDING_NEAR_ZERO: f64 = 1e-6;
/// Tolerance for counts of pixels.
const ROUNDING_PIXELS: f64 = 8.0;
/// Maximum length of a value in a difference, bytes.
const SHOWN_BYTES: usize = 80;

/// How exactly two records must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// Every value is the same: one program on one kind of machine.
    Exact,
    /// Numbers agree within rounding, and artifacts by kind and type: one program on two kinds of machines.
    Rounded,
}

/// A place at which two records differ.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct RecordDifference {
    /// JSON pointer into the record.
    #[schema(example = "/measurements/rgb/uiqm")]
    pub pointer: String,
    /// The first record's value as JSON, shortened; null: it has none.
    #[schema(example = "0.51")]
    pub expected: Option<String>,
    /// The other record's value as JSON, shortened; null: it has none.
    #[schema(example = "1000000000.0")]
    pub found: Option<String>,
}

/// Returns all differences of two records of one frame, except those of [`UNCOMPARED_MEMBERS`].
#[must_use]
pub fn compare_records(
    expected: &FrameRecord,
    found: &FrameRecord,
    agreement: Agreement,
) -> Vec<RecordDifference> {
    compare_values("", &json!(expected), &json!(found), agreement)
}

/// The first difference between a stored record (`found`) and that of its frame rendered again (`expected`), and the number
/// of further ones; `None` without differences.
#[must_use]
pub fn describe_differences(differences: &[RecordDifference]) -> Option<String> {
    let RecordDifference {
        pointer,
        expected,
        found,
    } = differences.first()?;
    let [found, expected] = [found, expected].map(|value| value.as_deref().unwrap_or("missing"));
    let more = match differences.len() - 1 {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!("{pointer} is {found}, rendered again {expected}{more}"))
}

/// Returns all differences of two JSON values. Pointers begin with `base`.
#[must_use]
pub fn compare_values(
    base: &str,
    expected: &Value,
    found: &Value,
    agreement: Agreement,
) -> Vec<RecordDifference> {
    let mut comparison = Comparison {
        agreement,
        differences: Vec::new(),
    };
    comparison.compare(base, Some(expected), Some(found));
    comparison.differences
}

/// Members of a record's text that this version does not declare, as JSON pointers.
#[must_use]
pub fn find_unknown_members(text: &Value, record: &FrameRecord) -> Vec<String> {
    let differences = compare_values("", &json!(record), text, Agreement::Exact);
    let unknown = differences.into_iter().filter(|difference| {
        let found = difference.found.as_deref();
        difference.expected.is_none() && found != Some("null")
    });
    unknown.map(|difference| difference.pointer).collect()
}

struct Comparison {
    agreement: Agreement,
    differences: Vec<RecordDifference>,
}

impl Comparison {
    fn compare(&mut self, pointer: &str, expected: Option<&Value>, found: Option<&Value>) {
        if UNCOMPARED_MEMBERS.contains(&pointer) || self.is_of_bytes(pointer) {
            return;
        }
        match (expected, found) {
            (Some(Value::Object(a)), Some(Value::Object(b))) => {
                for (key, value) in a {
                    self.compare(&child(pointer, key), Some(value), b.get(key));
                }
                for (key, value) in b.iter().filter(|(key, _)| !a.contains_key(*key)) {
                    self.compare(&child(pointer, key), None, Some(value));
                }
            }
            (Some(Value::Array(a)), Some(Value::Array(b))) => {
                for index in 0..a.len().max(b.len()) {
                    self.compare(&child(pointer, &index.to_string()), a.get(index), b.get(index));
                }
            }
            (Some(Value::Number(a)), Some(Value::Number(b))) if self.agrees(pointer, a, b) => {}
            (Some(Value::String(_)), Some(Value::String(_))) if self.is_sentence(pointer) => {}
            (a, b) if a == b => {}
            (a, b) => self.differences.push(RecordDifference {
                pointer: pointer.to_owned(),
                expected: a.map(shorten),
                found: b.map(shorten),
            }),
        }
    }

    fn is_of_bytes(&self, pointer: &str) -> bool {
        self.agreement == Agreement::Rounded
            && pointer.starts_with("/artifacts/")
            && BYTE_MEMBERS.iter().any(|member| pointer.ends_with(member))
    }

    /// Whether a text contains numbers that may be rounded differently.
    fn is_sentence(&self, pointer: &str) -> bool {
        let is_text = ["/promise/text", "/promise/exceeds"].contains(&pointer)
            || pointer.starts_with("/warnings/")
            || (pointer.starts_with("/plan/") && pointer.ends_with("/note"));
        is_text && self.agreement == Agreement::Rounded
    }

    fn agrees(&self, pointer: &str, expected: &Number, found: &Number) -> bool {
        if is_same_number(expected, found) {
            return true;
        }
        let (Some(a), Some(b)) = (expected.as_f64(), found.as_f64()) else {
            return false;
        };
        // Parameters follow from the description alone.
        if self.agreement == Agreement::Exact || pointer.starts_with("/parameters") {
            return false;
        }
        let tolerance = match pointer.starts_with("/counts/") {
            true => ROUNDING_PIXELS,
            false => ROUNDING_NEAR_ZERO,
        };
        (a - b).abs() <= tolerance.max(ROUNDING * a.abs().max(b.abs()))
    }
}

/// A parser may round a number of a record by its last bit, so the expected number is parsed as well.
fn is_same_number(expected: &Number, found: &Number) -> bool {
    expected == found
        || serde_json::from_str::<Number>(&expected.to_string()).is_ok_and(|parsed| parsed == *found)
}

/// Pointer to a member, escaped as RFC 6901 requires.
fn child(pointer: &str, key: &str) -> String {
    format!("{pointer}/{}", key.replace('~', "~0").replace('/', "~1"))
}

fn shorten(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().find(|(at, _)| *at >= SHOWN_BYTES) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{ArtifactEntry, Counts, Provenance};

    fn record() -> FrameRecord {
        FrameRecord {
            frame: 3,
            parameters: json!({"alpha": 0.5, "water": {"optics": "jerlov-3C"}}),
            plan: json!([{"stage": "attenuation", "bound": 1e-4, "note": "about 3 ms"}]),
            measurements: [("rgb".to_owned(), [("uiqm".to_owned(), 0.51)].into())].into(),
            artifacts: vec![ArtifactEntry {
                kind: "rgb".to_owned(),
                digest: "ab".repeat(32),
                bytes: 9,
                media_type: "image/png".to_owned(),
            }],
            timings_ms: [("water".to_owned(), 3.0)].into(),
            provenance: Provenance {
                code_version: "1".to_owned(),
                inputs: [("style.muddy".to_owned(), "cd".to_owned())].into(),
                ..Provenance::default()
            },
            ..FrameRecord::default()
        }
    }

    /// A change of a record, and the pointer of the difference.
    type Change = (&'static str, fn(&mut FrameRecord));

    fn pointers(change: fn(&mut FrameRecord), agreement: Agreement) -> Vec<String> {
        let mut changed = record();
        change(&mut changed);
        let differences = compare_records(&record(), &changed, agreement);
        differences
            .into_iter()
            .map(|difference| difference.pointer)
            .collect()
    }

    #[test]
    fn every_fact_of_a_record_is_compared_and_times_and_machines_are_not() {
        let changes: [Change; 9] = [
            ("/measurements/rgb/uiqm", |record| {
                *record
                    .measurements
                    .get_mut("rgb")
                    .unwrap()
                    .get_mut("uiqm")
                    .unwrap() = 1e9;
            }),
            ("/plan/0", |record| record.plan = json!([])),
            ("/parameters/alpha", |record| {
                record.parameters["alpha"] = json!(0.6)
            }),
            ("/artifacts/0/digest", |record| {
                record.artifacts[0].digest = "cd".repeat(32);
            }),
            ("/counts/holes", |record| {
                record.counts = Counts {
                    holes: 9,
                    ..Counts::default()
                }
            }),
            ("/warnings/0", |record| record.warnings.push("dark".to_owned())),
            ("/optics/derived", |record| {
                record.optics.insert("derived".to_owned(), json!(true));
            }),
            ("/provenance/inputs/style.muddy", |record| {
                record.provenance.inputs.clear()
            }),
            ("/frame", |record| record.frame = 4),
        ];
        for (pointer, change) in changes {
            assert_eq!(pointers(change, Agreement::Exact), [pointer]);
        }
        let unchanged: fn(&mut FrameRecord) = |record| {
            record.timings_ms.clear();
            record.provenance.code_version = "2".to_owned();
            record.provenance.cpu_features = "avx2".to_owned();
        };
        assert_eq!(pointers(unchanged, Agreement::Exact), [""; 0]);
    }

    #[test]
    fn all_differences_are_returned_with_both_values() {
        let mut changed = record();
        changed.parameters = json!({"alpha": 0.6, "more/~": 1});
        let found = compare_records(&record(), &changed, Agreement::Exact);
        let shown: Vec<_> = found
            .iter()
            .map(|one| {
                (
                    one.pointer.as_str(),
                    one.expected.as_deref(),
                    one.found.as_deref(),
                )
            })
            .collect();
        assert_eq!(
            shown,
            [
                ("/parameters/alpha", Some("0.5"), Some("0.6")),
                ("/parameters/water", Some(r#"{"optics":"jerlov-3C"}"#), None),
                ("/parameters/more~1~0", None, Some("1")),
            ]
        );
    }

    #[test]
    fn a_description_names_the_first_difference_and_the_number_of_others() {
        let mut changed = record();
        assert_eq!(describe_differences(&[]), None);
        changed.plan = json!([]);
        changed.warnings.push("dark".to_owned());
        let found = compare_records(&record(), &changed, Agreement::Exact);
        let described = describe_differences(&found).unwrap();
        assert!(
            described.starts_with("/plan/0 is missing, rendered again {")
                && described.ends_with(" and 1 more"),
            "{described}"
        );
    }

    #[test]
    fn another_kind_of_machine_may_round_but_not_invent() {
        let rounded: fn(&mut FrameRecord) = |record| {
            record.artifacts[0].digest = "cd".repeat(32);
            *record
                .measurements
                .get_mut("rgb")
                .unwrap()
                .get_mut("uiqm")
                .unwrap() = 0.512;
            record.plan[0]["note"] = json!("about 4 ms");
        };
        assert_eq!(pointers(rounded, Agreement::Rounded), [""; 0]);
        let invented: [Change; 3] = [
            ("/measurements/rgb/uiqm", |record| {
                *record
                    .measurements
                    .get_mut("rgb")
                    .unwrap()
                    .get_mut("uiqm")
                    .unwrap() = 0.6;
            }),
            ("/parameters/alpha", |record| {
                record.parameters["alpha"] = json!(0.5001)
            }),
            ("/artifacts/0/kind", |record| {
                record.artifacts[0].kind = "range".to_owned()
            }),
        ];
        for (pointer, change) in invented {
            assert_eq!(pointers(change, Agreement::Rounded), [pointer]);
        }
    }

    #[test]
    fn members_that_no_record_has_are_found_at_any_depth() {
        let record = record();
        let mut text = json!(record);
        text["promise"] = Value::Null;
        assert_eq!(find_unknown_members(&text, &record), [""; 0]);
        text["note"] = json!("hello");
        text["counts"]["more"] = json!(1);
        text["artifacts"][0]["path"] = json!("/etc");
        assert_eq!(
            find_unknown_members(&text, &record),
            ["/artifacts/0/path", "/counts/more", "/note"]
        );
    }
}
