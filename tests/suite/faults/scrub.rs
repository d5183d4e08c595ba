//! Damage in stored bytes is found, never served, and repaired by rendering again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use fathom_tests::{Service, run};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

const DAMAGES: usize = 1000;
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
const END: &[u8] = b"IEND";

fn scrub(data: &Path, more: &[&str]) -> (bool, Value) {
    let output = run(&[&["scrub", "--json", "--data", data.to_str().expect("text")], more].concat());
    let findings = serde_json::from_slice(&output.stdout);
    let complaint = String::from_utf8_lossy(&output.stderr);
    (
        output.status.success(),
        findings.unwrap_or_else(|error| panic!("{error}: {complaint}")),
    )
}

/// Offsets of the pictures with these digests in a pack. SQLite leaves copies of rows moved to other pages: pictures
/// that occur twice are omitted.
fn pictures(pack: &[u8], digests: &BTreeSet<String>) -> Vec<usize> {
    let mut places: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let starts = pack
        .windows(SIGNATURE.len())
        .enumerate()
        .filter(|(_, window)| *window == SIGNATURE);
    for (at, _) in starts {
        let end = pack[at..]
            .windows(END.len())
            .position(|window| window == END)
            .expect("an end");
        let digest = sha256(&pack[at..at + end + END.len() + 4]);
        if digests.contains(&digest) {
            places.entry(digest).or_default().push(at);
        }
    }
    places
        .into_values()
        .filter(|places| places.len() == 1)
        .flatten()
        .collect()
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Damages a thousand pictures: a flipped bit, bytes lost as by a torn write, or the bytes of the neighbor in their
/// place. Every picture has at least 57 bytes after its signature: a header and the end mark.
fn damage(pack: &mut [u8], pictures: &[usize]) {
    for (number, &at) in pictures.iter().take(DAMAGES).enumerate() {
        let before = pack[at + 8..at + 57].to_vec();
        match number % 3 {
            0 => pack[at + 8 + number % 49] ^= 1 << (number % 8),
            1 => pack[at + 30..at + 57].fill(0),
            _ => {
                let other = pictures[(number + 1) % pictures.len()];
                pack.copy_within(other + 16..other + 57, at + 16);
            }
        }
        if pack[at + 8..at + 57] == before[..] {
            // The neighbor is identical here.
            pack[at + 40] ^= 0x10;
        }
    }
}

/// Failure: scrub misses a damage or reports a false one, a response has bytes of another digest, an artifact is not
/// restored, or the digest of the job changes.
#[test]
fn a_thousand_damaged_pictures_are_found_never_served_and_rendered_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let data = folder.path().join("data");
    let (id, digest, stored) = {
        let service = Service::start(&data, &["--workers", "1", "--slots", "3"]);
        let id = service.submit(&json!({
            "dataset": "damaged", "count": 300, "seed": 8,
            "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
            "camera": {"width": 40, "height": 26, "hfov_deg": 80},
            "water": {"optics": "jerlov-3C"}, "enhance": ["hscm"], "metrics": ["entropy"],
            "artifacts": ["rgb", "range", "clean", "enhanced.hscm"]
        }));
        let done = service.finished(&id);
        assert_eq!(done["done"].as_u64(), Some(300), "{done}");
        let artifacts = |frame: u64| service.get(&format!("/v1/images/{id}/{frame}")).1["artifacts"].clone();
        let stored: BTreeSet<String> = (0..300)
            .flat_map(|frame| artifacts(frame).as_array().cloned().unwrap_or_default())
            .filter_map(|artifact| artifact["digest"].as_str().map(str::to_owned))
            .collect();
        (id, done["digest"].clone(), stored)
    };
    let (well, findings) = scrub(&data, &[]);
    assert!(
        well && findings["blobs"].as_u64() > Some(DAMAGES as u64),
        "{findings}"
    );

    let pack: PathBuf = data.join("packs/pack-000001.sqlite");
    let mut bytes = std::fs::read(&pack).expect("the pack");
    let pictures = pictures(&bytes, &stored);
    assert!(pictures.len() >= DAMAGES, "only {} pictures", pictures.len());
    damage(&mut bytes, &pictures);
    std::fs::write(&pack, &bytes).expect("the pack");

    let (well, findings) = scrub(&data, &[]);
    let damaged = findings["damaged"].as_array().expect("a list");
    assert!(
        !well && damaged.len() == DAMAGES,
        "{} of {DAMAGES} were found, {} pictures, {} blobs",
        damaged.len(),
        pictures.len(),
        findings["blobs"]
    );
    let broken: BTreeSet<String> = damaged.iter().map(|d| d["digest"].to_string()).collect();
    assert_eq!(broken.len(), DAMAGES);
    {
        let service = Service::start(&data, &["--workers", "0"]);
        let mut refused = 0;
        for frame in 0..300 {
            let (_, record) = service.get(&format!("/v1/images/{id}/{frame}"));
            for artifact in record["artifacts"].as_array().expect("a list") {
                let kind = artifact["kind"].as_str().expect("a kind");
                let (status, bytes) = service.get_bytes(&format!("/v1/images/{id}/{frame}/artifacts/{kind}"));
                let found = sha256(&bytes);
                let intact = !broken.contains(&artifact["digest"].to_string());
                // The running service restores some of them meanwhile.
                assert!(status == 200 || !intact, "{kind} of frame {frame}: {status}");
                assert!(
                    status != 200 || artifact["digest"] == found,
                    "{kind} of frame {frame} is not what it was"
                );
                refused += usize::from(status == 500);
            }
        }
        assert!(refused >= DAMAGES / 2, "{refused}");
    }
    let (well, findings) = scrub(&data, &["--repair"]);
    assert!(well, "{findings}");
    let repaired = findings["damaged"].as_array().map(Vec::len);
    assert!(
        repaired > Some(DAMAGES / 2) && repaired <= Some(DAMAGES),
        "{repaired:?}"
    );
    let (well, findings) = scrub(&data, &[]);
    assert!(well && findings["damaged"] == json!([]), "{findings}");
    let service = Service::start(&data, &["--workers", "0"]);
    assert_eq!(service.get(&format!("/v1/jobs/{id}")).1["digest"], digest);
    assert_eq!(
        service.get_bytes(&format!("/v1/images/{id}/0/artifacts/rgb")).0,
        200
    );
}
