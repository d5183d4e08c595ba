//! Damage anywhere in a data folder is never served as good, and scrub finds it.
//!
//! `FATHOM_DAMAGES` sets the number of damages (default 30); the test prints them.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use fathom_tests::{Dice, Service, root, run};
use serde_json::{Value, json};

/// Percentage of damages in the catalogue; the others are in packs.
const IN_CATALOGUE: u64 = 75;

/// Creates a folder with rows of every kind; returns the paths to request.
fn make(data: &Path) -> Vec<String> {
    let poison = [("FATHOM_FAULTS", "scene.nan=flag#3")];
    let service = Service::start_with(data, &["--workers", "1", "--slots", "2"], &poison);
    let id = service.submit(&json!({
        "dataset": "tour", "count": 8, "seed": 8, "labels": {"run": "a"},
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
        "camera": {"width": 40, "height": 26, "hfov_deg": 80}, "alpha": {"uniform": [0.2, 0.8]},
        "water": {"optics": "jerlov-3C", "style": "muddy"}, "enhance": ["hscm"], "metrics": ["entropy", "uciqe"],
        "artifacts": ["rgb", "range", "enhanced.hscm"]
    }));
    let done = service.finished(&id);
    assert_eq!(
        (done["done"].as_u64(), done["failed"].as_u64()),
        (Some(7), Some(1)),
        "{done}"
    );
    let (_, picture) = service.get_bytes(&format!("/v1/images/{id}/0/artifacts/rgb"));
    let (status, scene) = service.form(
        "/v1/scenes",
        &[("rgb", &picture), ("collection", b"dock"), ("name", b"one")],
    );
    assert!(matches!(status, 200 | 201), "{scene}");
    let (status, water) = service.post("/v1/waters", &water());
    assert!(matches!(status, 200 | 201), "{water}");
    let (status, version) = service.post("/v1/datasets/tour/versions", &json!({}));
    assert!(matches!(status, 200 | 201), "{version}");
    let mut paths: Vec<String> = [
        "/v1/jobs",
        "/v1/images?dataset=tour&limit=100",
        "/v1/images?dataset=tour&fields=alpha,uciqe,hscm.uciqe,artifacts.rgb,labels.run,camera.width,seed,warned&order_by=-uciqe",
        "/v1/images?dataset=tour&filter=alpha%20%3E%200.4%20and%20entropy%20%3E%200&fields=frame,digest,created_ms",
        "/v1/images?dataset=tour@1&limit=100",
        "/v1/datasets",
        "/v1/datasets/tour/versions",
        "/v1/datasets/tour/versions/1",
        "/v1/scenes",
        "/v1/collections/dock",
        "/v1/waters",
    ]
    .map(str::to_owned)
    .to_vec();
    paths.push(format!("/v1/scenes/{}", scene["id"].as_str().expect("an id")));
    paths.extend(["", "/errors", "/results"].map(|part| format!("/v1/jobs/{id}{part}")));
    for frame in (0..8).filter(|frame| *frame != 3) {
        let image = format!("/v1/images/{id}/{frame}");
        paths.extend(["rgb", "range", "enhanced.hscm"].map(|kind| format!("{image}/artifacts/{kind}")));
        paths.push(image);
    }
    paths
}

/// A user's water.
fn water() -> Value {
    json!({"name": "quay-7", "source": "our transmissometer", "licence": "CC-BY-4.0", "wavelength_nm": [650, 532, 450],
        "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
        "diffuse_attenuation_per_m": [0.6, 0.4, 0.8], "backscatter_fraction": 0.02})
}

/// Statuses and bodies; empty if the service does not start.
fn answers(data: &Path, paths: &[String]) -> Vec<(u16, Vec<u8>)> {
    let Ok(service) = Service::launch(data, &["--workers", "0"], &[]) else {
        return Vec::new();
    };
    let answers = paths.iter().map(|path| {
        let (status, body) = service.get_bytes(path);
        (status, without_times(body))
    });
    let answers = answers.collect();
    service.kill();
    answers
}

/// The lines of a JSON body without rendering times, which differ once a damaged image is rendered again; other bodies are unchanged.
fn without_times(body: Vec<u8>) -> Vec<u8> {
    let lines = body.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
    let documents: Result<Vec<Value>, _> = lines.map(serde_json::from_slice).collect();
    let Ok(mut documents) = documents else { return body };
    documents.iter_mut().for_each(remove_times);
    let lines: Vec<String> = documents.iter().map(Value::to_string).collect();
    lines.join("\n").into_bytes()
}

fn remove_times(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|name, _| {
                name != "timings_ms" && name != "total_ms" && !name.starts_with("timings.")
            });
            members.values_mut().for_each(remove_times);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_times),
        _ => {}
    }
}

/// A digest over all stored data by an independent reader; `None` if SQLite cannot read it.
fn facts(data: &Path) -> Option<Vec<u8>> {
    let output = Command::new("python3")
        .arg(root().join("tests/chaos/audit.py"))
        .arg("facts")
        .arg(data)
        .output()
        .expect("python3 is there");
    output.status.success().then_some(output.stdout)
}

fn copy(from: &Path, to: &Path) {
    if to.exists() {
        std::fs::remove_dir_all(to).expect("a copy can go");
    }
    let copied = Command::new("cp").arg("-r").args([from, to]).status();
    assert!(copied.is_ok_and(|status| status.success()));
}

/// A damage with its description.
struct Damage {
    file: &'static str,
    at: usize,
    byte: u8,
    is_bit: bool,
}

impl Damage {
    fn new(original: &Path, dice: &mut Dice) -> Self {
        let file = match dice.draw(100) < IN_CATALOGUE {
            true => "catalogue.sqlite",
            false => "packs/pack-000001.sqlite",
        };
        let bytes = std::fs::read(original.join(file)).expect("a file");
        let position = dice.draw(bytes.len() as u64) as usize;
        let is_bit = dice.draw(2) == 0;
        let byte = match is_bit {
            true => bytes[position] ^ (1 << dice.draw(8)),
            // Another printable character.
            false => (b'0'..=b'z').nth(dice.draw(75) as usize).expect("75 characters"),
        };
        // The same character is not a damage.
        let byte = if byte == bytes[position] { byte ^ 1 } else { byte };
        Self {
            file,
            at: position,
            byte,
            is_bit,
        }
    }

    fn apply(&self, data: &Path) {
        let path = data.join(self.file);
        let mut bytes = std::fs::read(&path).expect("a file");
        bytes[self.at] = self.byte;
        std::fs::write(path, bytes).expect("a file");
    }
}

/// Whether a response differs only by missing items of a list or missing lines.
fn is_hidden(told: &(u16, Vec<u8>), right: &(u16, Vec<u8>)) -> bool {
    if told.0 == 404 {
        return true;
    }
    let items = |body: &[u8]| -> Option<Vec<Value>> {
        let body: Value = serde_json::from_slice(body).ok()?;
        body["items"].as_array().cloned()
    };
    match (items(&told.1), items(&right.1)) {
        (Some(told), Some(right)) => told.iter().all(|item| right.contains(item)),
        _ => told.0 == 200 && lines(&told.1).is_subset(&lines(&right.1)),
    }
}

fn lines(body: &[u8]) -> BTreeSet<&[u8]> {
    body.split(|byte| *byte == b'\n').collect()
}

/// Failure: a response with a value or bytes other than the stored ones; a changed fact not found by scrub; a row
/// hidden by a damaged index and not found by scrub.
#[test]
fn single_bits_and_characters_anywhere_are_never_served_and_always_found() {
    let damages: u64 = std::env::var("FATHOM_DAMAGES").map_or(30, |n| n.parse().expect("a number"));
    let seed: u64 = std::env::var("FATHOM_SEED").map_or(17, |n| n.parse().expect("a number"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (original, data) = (folder.path().join("original"), folder.path().join("data"));
    let paths = make(&original);
    // The first start writes before anything is damaged.
    let right = answers(&original, &paths);
    assert!(right.iter().all(|(status, _)| *status == 200), "{right:?}");
    assert!(
        run(&["scrub", "--data", original.to_str().expect("text")])
            .status
            .success()
    );
    let stored = facts(&original);
    assert!(stored.is_some());
    let mut dice = Dice(seed);
    let (mut of_facts, mut found, mut refused, mut hidden, mut harmless) = (0, 0, 0, 0, 0);
    for number in 0..damages {
        let damage = Damage::new(&original, &mut dice);
        let named = format!(
            "damage {number}: {} of {} became {} ({})",
            damage.at,
            damage.file,
            damage.byte,
            if damage.is_bit { "one bit" } else { "a character" }
        );
        copy(&original, &data);
        damage.apply(&data);
        let differs = facts(&data) != stored;
        let scrub = run(&["scrub", "--data", data.to_str().expect("text")]);
        let is_found = !scrub.status.success();
        copy(&original, &data);
        damage.apply(&data);
        let told = answers(&data, &paths);
        let mut is_hiding = false;
        for ((told, right), path) in told.iter().zip(&right).zip(&paths) {
            let is_refused = told.0 >= 500;
            refused += u64::from(is_refused);
            if told != right && !is_refused {
                let text = String::from_utf8_lossy(&told.1);
                assert!(
                    is_hidden(told, right),
                    "{named}: {path} responds {} {text}",
                    told.0
                );
                is_hiding = true;
            }
        }
        let text = String::from_utf8_lossy(&scrub.stdout);
        assert!(is_found || !differs, "{named}: scrub does not find it: {text}");
        assert!(
            is_found || !is_hiding,
            "{named}: scrub does not find what is hidden: {text}"
        );
        of_facts += u64::from(differs);
        found += u64::from(is_found);
        hidden += u64::from(is_hiding);
        harmless += u64::from(!is_found);
    }
    println!(
        "{damages} damages, {of_facts} of facts, {found} found by scrub, {harmless} changed nothing that is stored; 0 served, {refused} \
         responses refused, {hidden} hid a row until scrub"
    );
    assert!(of_facts > 0 && found >= of_facts);
}
