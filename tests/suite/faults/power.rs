//! Power cuts lose all unsynced data.
//!
//! `FATHOM_POWER_CUTS` sets their number (default 12), `FATHOM_SEED` their positions. `tests/chaos/power.c` records the
//! writes and syncs of the service and ends it at a seeded write; `tests/chaos/power_cut.py` then reverts unsynced
//! data.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use fathom_tests::{Dice, Service, audit, compile, digest_by_render, root};
use serde_json::{Value, json};

const FRAMES: u64 = 30;
/// Writes, renames and syncs of a service that starts and renders the jobs.
const STEPS: u64 = 420;

fn job() -> Value {
    json!({
        "dataset": "power", "count": FRAMES, "seed": 11,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 80},
        "water": {"optics": {"choice": ["jerlov-IB", "jerlov-5C"]}}, "artifacts": ["rgb", "range"]
    })
}

fn cut(log: &Path, seed: u64, folder: &Path) -> String {
    let output = Command::new("python3")
        .arg(root().join("tests/chaos/power_cut.py"))
        .arg(log)
        .arg(seed.to_string())
        .arg(folder)
        .output()
        .expect("python3 is there");
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    text
}

/// Failure: an accepted job or an acknowledged image is lost, a row lacks its bytes, bytes have another digest, a
/// database is damaged, the service does not start, or the digest differs from that of an undisturbed run.
#[test]
fn what_was_told_survives_a_power_cut() {
    let cuts: u64 = std::env::var("FATHOM_POWER_CUTS").map_or(12, |n| n.parse().expect("a number"));
    let seed: u64 = std::env::var("FATHOM_SEED").map_or(5, |n| n.parse().expect("a number"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (data, log) = (folder.path().join("data"), folder.path().join("power.log"));
    let library = compile("power.c", folder.path());
    let expected = digest_by_render(&job(), folder.path(), "2");
    let mut dice = Dice(seed);
    let (mut told, mut unsafe_at_cuts, mut in_life) = (Vec::<(String, u64)>::new(), 0, 0);
    for number in 0..cuts {
        let _ = std::fs::remove_file(&log);
        let position = (1 + dice.draw(STEPS)).to_string();
        let environment = [
            ("LD_PRELOAD", library.to_str().expect("text")),
            ("FATHOM_POWER_FOLDER", folder.path().to_str().expect("text")),
            ("FATHOM_POWER_LOG", log.to_str().expect("text")),
            ("FATHOM_POWER_CUT", &position),
        ];
        // A cut may happen during startup.
        if let Ok(mut service) = Service::launch(&data, &["--workers", "1", "--slots", "2"], &environment) {
            in_life += 1;
            let until = Instant::now() + Duration::from_secs(3);
            let key = format!("{seed}-{number}");
            told.extend(service.try_submit(&job(), &key).map(|id| (id, 0)));
            while service.is_alive() && Instant::now() < until {
                for (id, done) in &mut told {
                    let state = service.try_get(&format!("/v1/jobs/{id}"));
                    *done = (*done).max(state.map_or(0, |job| job["done"].as_u64().unwrap_or(0)));
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            service.kill();
        }
        let lost = cut(&log, seed + number, folder.path());
        unsafe_at_cuts += u64::from(!lost.starts_with("0 writes and 0 names"));
        let accepted: Vec<&str> = told.iter().map(|(id, _)| id.as_str()).collect();
        audit(
            &data,
            &accepted,
            &format!("cut {number} position step {position}: {lost}"),
        );
    }
    let service = Service::start(&data, &["--workers", "1", "--slots", "2"]);
    for (id, done) in &told {
        let job = service.get(&format!("/v1/jobs/{id}")).1;
        assert!(
            job["done"].as_u64() >= Some(*done),
            "{done} images were told of: {job}"
        );
        let job = service.finished(id);
        assert_eq!(job["digest"], expected, "{job}");
    }
    println!(
        "{cuts} power cuts, {unsafe_at_cuts} of them with something that was not safe, {in_life} while requests were answered; {} jobs \
         of {FRAMES} frames accepted: 0 lost",
        told.len()
    );
}
