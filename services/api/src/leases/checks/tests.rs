use std::collections::BTreeMap;

use imaging::codec::encode_png;
use imaging::{Plane, Rgb8};
use serde_json::json;
use spec::{ArtifactEntry, Job, Promise, Provenance, Vocabulary};

use super::*;

pub(in crate::leases) fn frame() -> Frame {
    let description = json!({
        "count": 2, "seed": u64::MAX,
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 32, "height": 24, "hfov_deg": 80.1},
        "water": {"optics": "jerlov-3C", "range_scale": {"uniform": [0.1, 0.9]}},
        "enhance": ["hscm"],
        "metrics": ["uiqm", "uciqe"],
        "artifacts": ["rgb", "range", "enhanced.hscm"]
    });
    let vocabulary: Vocabulary = renderer::vocabulary(&style::Library::embedded().unwrap(), false);
    let job = Job::parse(description.to_string().as_bytes(), &vocabulary).unwrap();
    job.resolve(1).unwrap()
}

fn worker() -> RegisterRequest {
    RegisterRequest {
        name: "far".to_owned(),
        slots: 1,
        code_version: "1".to_owned(),
        cpu_features: "avx2".to_owned(),
        ..RegisterRequest::default()
    }
}

fn stored_file(kind: &str, sides: (usize, usize)) -> PendingArtifact {
    PendingArtifact {
        entry: ArtifactEntry {
            kind: kind.to_owned(),
            digest: "ab".repeat(32),
            bytes: 9,
            media_type: "image/png".to_owned(),
        },
        sides: Some(sides),
    }
}

/// A change of an honest record.
type Lie = fn(&mut FrameRecord);

/// The record of an honest worker.
fn record(frame: &Frame, pending: &[PendingArtifact]) -> FrameRecord {
    let text = frame.parameters.to_string();
    let values = [("uiqm".to_owned(), 0.5), ("uciqe".to_owned(), 0.4)];
    let values: BTreeMap<String, f64> = values.into();
    FrameRecord {
        frame: 1,
        parameters: serde_json::from_str(&text).unwrap(),
        measurements: [("rgb".to_owned(), values.clone()), ("hscm".to_owned(), values)].into(),
        plan: json!([{"stage": "attenuation", "variant": "fast"}]),
        artifacts: pending.iter().map(|put| put.entry.clone()).collect(),
        timings_ms: [("water".to_owned(), 3.0)].into(),
        provenance: Provenance {
            code_version: "1".to_owned(),
            cpu_features: "avx2".to_owned(),
            ..Provenance::default()
        },
        ..FrameRecord::default()
    }
}

fn promise(bound: f64, text: &str) -> Promise {
    Promise {
        bound,
        relative: 0.0,
        tolerance: 3e-4,
        relative_tolerance: 0.0,
        unbounded: Vec::new(),
        exceeds: None,
        text: text.to_owned(),
    }
}

#[test]
fn an_honest_record_has_no_fault_and_each_false_one_is_named() {
    let (frame, worker) = (frame(), worker());
    let pending = [stored_file("rgb", (32, 24)), stored_file("range", (32, 24))];
    let honest = record(&frame, &pending);
    let faults = |pending: &[PendingArtifact], record: &FrameRecord| {
        let evidence = Evidence {
            frame: &frame,
            pending,
            worker: &worker,
            record,
            received: None,
        };
        evidence.faults()
    };
    assert!(
        faults(&pending, &honest).is_empty(),
        "{:?}",
        faults(&pending, &honest)
    );
    let changes: [(&str, Lie); 22] = [
        ("/parameters/alpha", |record| {
            record.parameters["alpha"] = json!(0.5)
        }),
        ("/parameters/water", |record| {
            record.parameters["water"] = json!({})
        }),
        ("/parameters/more", |record| record.parameters["more"] = json!(1)),
        ("/parameters", |record| record.parameters = Value::Null),
        ("`rgb` is missing", |record| record.artifacts.clear()),
        ("`rgb` is named twice", |record| {
            record.artifacts.push(record.artifacts[0].clone());
        }),
        ("was not stored", |record| {
            record.artifacts[0].bytes = u64::MAX >> 1
        }),
        ("was not stored", |record| {
            record.artifacts[0].media_type = "text/html".to_owned()
        }),
        ("/measurements/clahe", |record| {
            record
                .measurements
                .insert("clahe".to_owned(), [("uiqm".to_owned(), 1.0)].into());
        }),
        ("/measurements/rgb/psnr", |record| {
            let rgb = record.measurements.get_mut("rgb").unwrap();
            rgb.insert("psnr".to_owned(), 99.0);
        }),
        ("/measurements/hscm/uciqe is missing", |record| {
            record.measurements.remove("hscm");
        }),
        ("/measurements/rgb/uiqm is missing", |record| {
            record.measurements.get_mut("rgb").unwrap().remove("uiqm");
        }),
        ("/plan has 10000 stages", |record| {
            record.plan = Value::Array(vec![json!({"stage": "water"}); 10_000]);
        }),
        ("/plan/0 is not an object", |record| {
            record.plan = json!(["water"])
        }),
        ("/optics has", |record| {
            record.optics.insert("more".to_owned(), json!("x".repeat(20_000)));
        }),
        ("must be null, because the frame has no style", |record| {
            record.provenance.onnx_runtime = Some("1.20".to_owned());
        }),
        ("/counts/holes", |record| record.counts.holes = u64::MAX >> 1),
        ("/timings_ms", |record| {
            record.timings_ms.insert("plan".to_owned(), -1.0);
        }),
        ("/warnings", |record| record.warnings = vec!["x".repeat(5000)]),
        ("/promise has a bound", |record| {
            record.promise = Some(promise(-1.0, "within"));
        }),
        ("/promise names", |record| {
            record.promise = Some(promise(1e-4, &"x".repeat(5000)));
        }),
        ("/provenance/code_version", |record| {
            record.provenance.code_version = "2".to_owned()
        }),
    ];
    for (said, change) in changes {
        let mut lie = honest.clone();
        change(&mut lie);
        let found = faults(&pending, &lie);
        assert!(
            found.iter().any(|fault| fault.contains(said)),
            "{said}: {found:?}"
        );
    }
    let small = [stored_file("rgb", (32, 24)), stored_file("range", (31, 24))];
    assert_eq!(faults(&small, &honest), ["`range` is 31×24, the frame 32×24"]);
}

#[test]
fn a_file_has_a_requested_kind_and_matches_its_media_type() {
    let frame = frame();
    let picture = encode_png(&Rgb8::from_fn(32, 24, |_, _| [9; 3]).into()).unwrap();
    let file = |kind: &str, media_type: &str, data: &[u8]| {
        let file = Artifact {
            kind: kind.to_owned(),
            media_type: media_type.to_owned(),
            data: data.to_vec(),
            digest: String::new(),
        };
        check_file(&frame, &file).join("; ")
    };
    assert_eq!(file("rgb", "image/png", &picture), "");
    assert_eq!(
        file("direct", "application/x-npy", &picture),
        "`direct` was not requested, but rgb, range, enhanced.hscm"
    );
    assert_eq!(
        file("range", "text/html", b"<script>"),
        "`range` is image/png, not text/html; the bytes of `range` are not image/png as workers write it: it is neither \
         PNG, JPEG, WebP nor NPY"
    );
}

#[test]
fn truncated_extended_and_other_samples_are_rejected() {
    let frame = frame();
    let picture = encode_png(&Rgb8::from_fn(32, 24, |x, y| [x as u8, y as u8, 9]).into()).unwrap();
    let behind: Vec<u8> = picture.iter().copied().chain(vec![0; 3 << 20]).collect();
    let gray = encode_png(&Plane::filled(32, 24, 9_u8).into()).unwrap();
    let deep = encode_png(&Plane::filled(32, 24, 9_u16).into()).unwrap();
    let files: [(&str, &[u8], &str); 6] = [
        ("rgb", &picture[..60], "truncated"),
        ("rgb", &behind, "3145728 bytes follow its end"),
        ("rgb", &gray, "1 channels of 8 bits; must be 3 channels of 8 bits"),
        (
            "range",
            &gray,
            "1 channels of 8 bits; must be 1 channels of 16 bits",
        ),
        ("rgb", &deep, "1 channels of 16 bits"),
        ("range", &deep, ""),
    ];
    for (kind, data, wrong) in files {
        let file = Artifact {
            kind: kind.to_owned(),
            media_type: "image/png".to_owned(),
            data: data.to_vec(),
            digest: String::new(),
        };
        let found = check_file(&frame, &file).join("; ");
        assert!(
            found.contains(wrong) && found.is_empty() == wrong.is_empty(),
            "{kind}: {found}"
        );
    }
}

#[test]
fn members_of_no_version_are_rejected() {
    let (frame, worker) = (frame(), worker());
    let pending = [stored_file("rgb", (32, 24)), stored_file("range", (32, 24))];
    let honest = record(&frame, &pending);
    let mut received = json!(honest);
    received["counts"]["more"] = json!(1);
    let evidence = Evidence {
        frame: &frame,
        pending: &pending,
        worker: &worker,
        record: &honest,
        received: Some(&received),
    };
    assert_eq!(evidence.faults(), ["/counts/more is unknown"]);
}

/// A seeded random stream.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % sides
    }
}

/// Failure: a panic, or a record that differs in a checked fact and has no fault.
#[test]
fn records_that_were_changed_at_random_never_panic_and_none_passes_with_other_facts() {
    const ROUNDS: usize = 20_000;
    let (frame, worker) = (frame(), worker());
    let pending = [stored_file("rgb", (32, 24)), stored_file("range", (32, 24))];
    let honest = record(&frame, &pending);
    let text = serde_json::to_vec(&honest).unwrap();
    let mut dice = Dice(7);
    let (mut parsed, mut passed) = (0, 0);
    for _ in 0..ROUNDS {
        let mut bytes = text.clone();
        for _ in 0..=dice.roll(3) {
            let (at, other) = (dice.roll(bytes.len()), dice.roll(bytes.len()));
            match dice.roll(4) {
                0 => bytes[at] ^= 1 << dice.roll(8),
                1 => bytes[at] = b"0123456789-+.eE\"{}[]:,"[dice.roll(22)],
                2 => bytes.swap(at, other),
                _ => drop(bytes.remove(at)),
            }
        }
        let Ok(changed) = serde_json::from_slice::<FrameRecord>(&bytes) else {
            continue;
        };
        parsed += 1;
        let evidence = Evidence {
            frame: &frame,
            pending: &pending,
            worker: &worker,
            record: &changed,
            received: None,
        };
        if evidence.faults().is_empty() {
            passed += 1;
            assert_eq!(changed.parameters, honest.parameters);
            assert_eq!(changed.provenance.code_version, honest.provenance.code_version);
            assert!(
                changed
                    .artifacts
                    .iter()
                    .all(|entry: &ArtifactEntry| pending.iter().any(|put| put.entry == *entry))
            );
        }
    }
    assert!(
        parsed > ROUNDS / 50 && passed > 0,
        "{parsed} parsed, {passed} passed"
    );
}
