//! `fathom tradeoff`: the front of a small job, the parts without a truth, and errors.

use std::path::Path;
use std::process::Command;

use fathom_tests::{fathom, run};
use serde_json::{Value, json};

/// A job with parts that have no truth: snow, a style, haze and a sensor.
fn job() -> Value {
    json!({
        "count": 5,
        "seed": 4,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 9]}},
        "camera": {"width": 96, "height": 62, "vignette": {"v": 0.2, "v2": 0}},
        "water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 50}, "style": "muddy"},
        "lights": [
            {"kind": "spot", "position_m": [-0.4, -0.3, 0], "direction": [0.15, 0.05, 1], "intensity": [4, 4, 4], "cone_deg": 70},
            {"kind": "haze", "x": 0.5, "y": 0.5, "size": 0.4, "intensity": 0.2}
        ]
    })
}

fn write_job(folder: &Path, job: &Value) -> String {
    let path = folder.join("wall.json");
    std::fs::write(&path, job.to_string()).expect("a job file");
    path.to_str().expect("text").to_owned()
}

fn numbers(value: &Value, names: &[&str]) -> Vec<f64> {
    names.iter().filter_map(|name| value[name].as_f64()).collect()
}

/// Runs the command for two frames of 24x16 on some threads; returns its document.
fn measure(spec: &str, out: &Path, threads: &str) -> Value {
    let out = out.to_str().expect("text");
    let arguments = [
        "tradeoff", spec, "--frames", "2", "--size", "24x16", "--out", out, "--json",
    ];
    let output = Command::new(fathom())
        .args(arguments)
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .expect("the binary");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Failures: a point that another beats on the front, a distance that depends on threads, a part without truth that is silently dropped.
#[test]
fn the_front_of_a_job_is_measured_against_its_truth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = write_job(folder.path(), &job());
    let out = folder.path().join("out");
    let measured = measure(&spec, &out, "2");
    assert_eq!(
        (&measured["job"], &measured["frames"]),
        (&json!("wall"), &json!([0, 4]))
    );
    assert_eq!(
        (&measured["size"], &measured["timed_size"]),
        (&json!([24, 16]), &json!([96, 62]))
    );
    let left_out = ["water.snow", "water.style", "lights (haze)", "camera.vignette"];
    assert_eq!(measured["left_out"], json!(left_out));

    let points = measured["points"].as_array().expect("points");
    assert_eq!(
        (&points[0]["default"], &points[0]["write"]),
        (&json!(true), &json!({"fidelity": "picture"}))
    );
    let front: Vec<&Value> = points.iter().filter(|point| point["pareto"] == true).collect();
    assert!(!front.is_empty() && front.len() < points.len());
    for point in &front {
        let [ms, rms] = numbers(point, &["ms", "rms"])[..] else {
            panic!("{point} has no numbers");
        };
        assert!(
            ms > 0.0 && rms > 0.0 && point["write"]["fidelity"] != json!(null),
            "{point}"
        );
        let mut rivals = points.iter().filter(|other| other["write"] != json!(null));
        let is_beaten = rivals.any(|other| match numbers(other, &["ms", "rms"])[..] {
            [other_ms, other_rms] => other_ms < ms && other_rms < rms,
            _ => false,
        });
        assert!(!is_beaten, "{point}");
    }
    let without: Vec<&Value> = points
        .iter()
        .filter(|point| point["without"].is_string())
        .collect();
    let shadows = without
        .iter()
        .find(|point| point["without"] == "lamp_shadows")
        .expect("an effect");
    assert!(shadows["write"].is_null() && shadows["pareto"] == false);
    for frame in shadows["frames"].as_array().expect("frames") {
        assert!(!frame["effects"].to_string().contains("lamp_shadows"), "{frame}");
    }
    assert_ne!(shadows["rms"], points[0]["rms"], "shadows change the light");

    let stored = std::fs::read(out.join("tradeoff.json")).expect("a document");
    assert_eq!(serde_json::from_slice::<Value>(&stored).expect("JSON"), measured);
    let chart = std::fs::read_to_string(out.join("tradeoff.svg")).expect("a chart");
    assert!(chart.starts_with("<svg") && chart.contains("Pareto front") && chart.contains("96x62"));

    let again = measure(&spec, &out, "1");
    let distances = |measured: &Value| {
        let points = measured["points"].as_array().expect("points").iter();
        let known = points.filter(|point| point["kind"] != "budget_ms");
        known
            .map(|point| numbers(point, &["bias", "rms", "codes"]))
            .collect::<Vec<_>>()
    };
    assert_eq!(distances(&measured), distances(&again), "threads change a bit");
}

/// Failure: a table without the line to write, or without the parts left out of the comparison.
#[test]
fn the_text_names_the_line_to_write_and_the_parts_that_were_not_compared() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = write_job(folder.path(), &job());
    let set = [
        "--set",
        "water.style=null",
        "--set",
        "camera.width=48",
        "--set",
        "camera.height=32",
    ];
    let arguments = ["tradeoff", &spec, "--frames", "1", "--size", "16x16"];
    let output = run(&[&arguments[..], &set[..]].concat());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        text.contains("\"fidelity\": \"picture\"") && text.contains("this job"),
        "{text}"
    );
    assert!(
        text.contains("not compared: water.snow, lights (haze), camera.vignette"),
        "{text}"
    );
    assert!(
        text.contains("without lamp_shadows") && text.contains("at 48x32"),
        "{text}"
    );
}

/// Failures: only the first mistake is named, or a job without a truth ends without the reason.
#[test]
fn mistakes_are_named_together() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = write_job(folder.path(), &job());
    let errors = |arguments: &[&str]| {
        let output = run(&[&["tradeoff"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let text = errors(&[&spec, "--set", "count", "--set", "a..b=1"]);
    assert!(
        text.contains("--set count: must be FIELD=VALUE") && text.contains("--set a..b=1"),
        "{text}"
    );
    let text = errors(&[&spec, "--set", "alpha=7", "--set", "camera.width=0"]);
    assert!(
        text.contains("2 errors") && text.contains("/alpha") && text.contains("/camera/width"),
        "{text}"
    );
    assert!(errors(&[&spec, "--frames", "6"]).contains("--frames is 6, but the job has 5 frames"));
    assert!(errors(&[&spec, "--size", "8x8"]).contains("both sides must be 16 to 512 px"));
    assert!(errors(&["no-such-site"]).contains("name a file, or one of the sites harbour-wall"));
    let unknown = [
        "--frames",
        "1",
        "--set",
        "water.optics={\"beam_attenuation_per_m\": [0.4, 0.2, 0.2], \"veiling_light\": [0.1, 0.2, 0.2]}",
        "--set",
        "lights=[]",
    ];
    let text = errors(&[&[spec.as_str()], &unknown[..]].concat());
    assert!(
        text.contains("the scattering of the water is not known"),
        "{text}"
    );
}
