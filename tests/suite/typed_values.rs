//! Every value of a description comes back as it was given: from rows, filters, orders, statistics, JSON lines and CSV.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use fathom_tests::{Service, root, run};
use serde_json::{Value, json};
use spec::Leaves;

fn encoded(text: &str) -> String {
    let bytes = text.bytes().map(|byte| format!("%{byte:02x}"));
    bytes.collect()
}

struct Rows<'a>(&'a Service);

impl Rows<'_> {
    fn query(&self, query: &[(&str, &str)]) -> Vec<Value> {
        let parts: Vec<String> = query
            .iter()
            .map(|(name, value)| format!("{name}={}", encoded(value)))
            .collect();
        let (status, page) = self.0.get(&format!("/v1/images?{}", parts.join("&")));
        assert_eq!(status, 200, "{query:?}: {page}");
        page["items"].as_array().unwrap().clone()
    }

    fn count(&self, dataset: &str, filter: &str) -> usize {
        self.query(&[
            ("dataset", dataset),
            ("filter", filter),
            ("fields", "frame"),
            ("limit", "100"),
        ])
        .len()
    }
}

/// A value as the filter language writes it.
fn literal(value: &Value) -> String {
    match value {
        Value::String(text) => format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"")),
        other => other.to_string(),
    }
}

#[test]
fn labels_keep_their_type_and_all_digits() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let scene = json!({"kind": "procedural", "family": "pipeline"});
    let job = |seed: u64, depth: Value| {
        json!({"dataset": "lo", "count": 6, "seed": seed, "scene": scene, "camera": {"width": 32, "height": 24}, "metrics": ["uiqm"],
               "labels": {"depth": depth, "uiqm": -3, "trip": {"int": [1, 20]}, "site": "dock", "night": {"choice": [true, false]}}})
    };
    assert_eq!(
        service.finished(&service.submit(&job(5, json!({"uniform": [1, 120]}))))["state"],
        "done"
    );
    let rows = Rows(&service);
    let all = rows.query(&[
        ("dataset", "lo"),
        ("fields", "labels.depth,labels.trip,labels.night,labels.site"),
        ("limit", "100"),
    ]);
    let depths: Vec<f64> = all
        .iter()
        .map(|row| row["labels.depth"].as_f64().unwrap())
        .collect();
    assert!(
        all.iter()
            .all(|row| row["labels.trip"].is_u64() && row["labels.night"].is_boolean())
    );
    let ordered = rows.query(&[
        ("dataset", "lo"),
        ("order_by", "labels.depth"),
        ("fields", "labels.depth"),
        ("limit", "4"),
    ]);
    let mut sorted = depths.clone();
    sorted.sort_by(f64::total_cmp);
    let ordered: Vec<f64> = ordered
        .iter()
        .map(|row| row["labels.depth"].as_f64().unwrap())
        .collect();
    assert_eq!(ordered, sorted[..4]);
    let deep = depths.iter().filter(|depth| **depth > 50.0).count();
    assert_eq!(rows.count("lo", "labels.depth > 50"), deep);
    for (row, depth) in all.iter().zip(&depths) {
        assert_eq!(
            rows.count("lo", &format!("labels.depth = {}", literal(&json!(depth)))),
            1
        );
        let same = all
            .iter()
            .filter(|other| other["labels.night"] == row["labels.night"])
            .count();
        assert_eq!(
            rows.count("lo", &format!("labels.night = {}", row["labels.night"])),
            same
        );
    }
    let nights = all.iter().filter(|row| row["labels.night"] == true).count();
    assert_eq!(
        (
            rows.count("lo", "labels.night"),
            rows.count("lo", "not labels.night")
        ),
        (nights, 6 - nights)
    );
    // A label may be called like a metric.
    assert_eq!(rows.count("lo", "labels.uiqm = -3"), 6);
    assert_eq!(rows.count("lo", "uiqm = -3"), 0);
    // A text in another job leaves numbers comparable.
    assert_eq!(
        service.finished(&service.submit(&job(6, json!("shallow"))))["state"],
        "done"
    );
    assert_eq!(rows.count("lo", "labels.depth > 50"), deep);
    assert_eq!(rows.count("lo", "labels.depth = \"shallow\""), 6);
    assert_eq!(rows.count("lo", "labels.depth is not null"), 12);
    let bins = run(&[
        "stats",
        "lo",
        "--by",
        "labels.depth:50",
        "--json",
        "--server",
        &service.url,
    ]);
    assert!(bins.status.success(), "{}", String::from_utf8_lossy(&bins.stderr));
    let groups = run(&[
        "stats",
        "lo",
        "--by",
        "labels.night",
        "--json",
        "--server",
        &service.url,
    ]);
    let groups = String::from_utf8_lossy(&groups.stdout).into_owned();
    assert!(
        groups.contains("true") && groups.contains("false") && !groups.contains("\"true\""),
        "{groups}"
    );
    let (_, dataset) = service.get("/v1/datasets/lo");
    let kinds: BTreeMap<&str, &str> = dataset["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|column| (column["name"].as_str().unwrap(), column["kind"].as_str().unwrap()))
        .collect();
    assert_eq!(
        (
            kinds["labels.depth"],
            kinds["labels.trip"],
            kinds["labels.night"],
            kinds["labels.site"]
        ),
        ("mixed", "number", "bool", "text")
    );
}

/// A description with values of every kind, near the limits of doubles and of 64 bits.
fn rich_job() -> Value {
    json!({
        "dataset": "rich", "count": 2, "seed": 18_446_744_073_709_551_615u64,
        "scene": {"kind": "procedural", "family": "structure", "seed": 9_007_199_254_740_992u64},
        "camera": {"width": 32, "height": 24, "hfov_deg": 60},
        "water": {"optics": "jerlov-3C", "range_scale": 0.1, "snow": {"density_per_m3": 33.3}, "turbidity": {"contrast": 0.3}},
        "lights": [{"kind": "point", "position_m": [0.1, 0.2, -0.3], "intensity": [1.7, 0.1, 30]}],
        "metrics": ["uiqm"],
        "labels": {"exact": 41.222_423_306_604_49, "whole": 9_007_199_254_740_993u64, "tiny": 5e-324, "yes": true, "text": "a \"b\", c"},
    })
}

/// The generated round trip: each leaf of each record, and each label.
#[test]
fn every_leaf_comes_back_equal_from_every_interface() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&rich_job());
    assert_eq!(service.finished(&id)["state"], "done");
    let rows = Rows(&service);
    let (_, jsonl) = service.get_bytes("/v1/datasets/rich/metadata.jsonl");
    let lines: Vec<Value> = String::from_utf8(jsonl)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let (_, csv) = service.get_bytes("/v1/datasets/rich/metadata.csv");
    let csv = String::from_utf8(csv).unwrap();
    let mut checked = 0;
    for frame in 0..2u64 {
        let (_, record) = service.get(&format!("/v1/images/{id}/{frame}"));
        let line = lines.iter().find(|line| line["frame"] == frame).unwrap();
        let mut values: BTreeMap<String, Value> = BTreeMap::new();
        for leaf in Leaves::of_records().scalars {
            if let Some(value) = leaf
                .find(&record)
                .filter(|value| value.is_number() || value.is_string())
            {
                values.insert(leaf.name, value.clone());
            }
        }
        for (name, value) in record["parameters"]["labels"].as_object().unwrap() {
            values.insert(format!("labels.{name}"), value.clone());
        }
        for (name, value) in &values {
            let fields = format!("frame,{name}");
            let filter = format!("frame = {frame} and {name} = {}", literal(value));
            let found = rows.query(&[("dataset", "rich"), ("filter", &filter), ("fields", &fields)]);
            assert_eq!(found.len(), 1, "{filter}");
            assert!(
                is_equal(&found[0][name], value),
                "{name}: {} is not {value}",
                found[0][name]
            );
            assert!(
                is_equal(&line[name], value),
                "{name}: {} is not {value} in JSON lines",
                line[name]
            );
            if let Value::Number(number) = value {
                let shown = [number.to_string(), found[0][name].to_string()];
                assert!(
                    shown.iter().any(|text| csv.contains(text.as_str())),
                    "{name}: {number} is not in the CSV"
                );
            }
            checked += 1;
        }
        assert_eq!(record["parameters"]["camera"]["hfov_deg"].as_f64(), Some(60.0));
        assert!(values.len() > 60, "{}", values.len());
    }
    assert!(checked > 120, "{checked}");
}

/// Equal as JSON; whole doubles are shown without a point.
fn is_equal(one: &Value, other: &Value) -> bool {
    one == other
        || (one.as_f64().is_some() && one.as_f64() == other.as_f64() && (!one.is_u64() || !other.is_u64()))
}

#[test]
fn degrees_of_an_uploaded_scene_are_those_that_were_given() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let picture = root().join("workers/enhance/tests/vectors/enhancement/hazed_160x120.input.png");
    let picture = picture.to_str().unwrap();
    for degrees in ["60", "80", "90", "45.5"] {
        let output = run(&["upload", picture, "--hfov-deg", degrees, "--server", &service.url]);
        let id = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        let job = json!({"dataset": "degrees", "scene": {"kind": "uploaded", "id": id}, "metrics": ["uiqm"], "artifacts": ["rgb"]});
        assert_eq!(service.finished(&service.submit(&job))["state"], "done");
        assert_eq!(
            Rows(&service).count("degrees", &format!("camera.hfov_deg = {degrees}")),
            1,
            "{degrees}"
        );
    }
    let output = run(&["upload", picture, "--server", &service.url]);
    let id = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let job = json!({"dataset": "default", "scene": {"kind": "uploaded", "id": id}, "metrics": ["uiqm"], "artifacts": ["rgb"]});
    assert_eq!(service.finished(&service.submit(&job))["state"], "done");
    assert_eq!(Rows(&service).count("default", "camera.hfov_deg = 80"), 1);
}
