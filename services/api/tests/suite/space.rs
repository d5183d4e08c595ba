//! Space is reclaimed after a deletion; a full disk is reported and survived.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::bytes::{noise_png, png};
use crate::common::worker::{Fake, Real};
use crate::common::{Running, Setup, job, start, start_in_folder, start_on};
use api::Limits;
use serde_json::{Value, json};

#[path = "../../../../tests/src/small_disk.rs"]
mod small_disk;

/// Bytes of all files below a folder.
fn on_disk(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).unwrap().filter_map(Result::ok);
    entries
        .map(|entry| match entry.metadata() {
            Ok(file) if file.is_dir() => on_disk(&entry.path()),
            Ok(file) => file.len(),
            Err(_) => 0,
        })
        .sum()
}

/// Waits for a background effect.
fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{what} does not happen"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A camera with square images of this side.
fn square(side: usize) -> Value {
    json!({"width": side, "height": side, "hfov_deg": 80})
}

/// A job of one frame whose image has about this many bytes.
fn render(service: &Running, worker: &Fake, dataset: &str, seed: u64, side: usize) -> String {
    let mut one = job();
    one["count"] = json!(1);
    one["dataset"] = json!(dataset);
    one["seed"] = json!(seed);
    one["camera"] = square(side);
    let id = service.submit(&one);
    let lease = worker.lease(5000).expect("a frame");
    worker.finish_with(&lease, noise_png(side, seed)).unwrap();
    id
}

#[test]
fn the_space_of_deleted_images_is_reclaimed_and_shared_bytes_are_kept() {
    let service = start();
    let worker = Fake::register(&service);
    let kept = render(&service, &worker, "kept", 1, 64);
    let same = render(&service, &worker, "gone", 1, 64);
    for seed in 2..10 {
        render(&service, &worker, "gone", seed, 600);
    }
    let packs = service.folder().join("packs");
    let full = on_disk(&packs);
    assert!(full > 8 * 600 * 600 * 3, "{full}");
    let deleted = service.delete("/v1/datasets/gone");
    assert_eq!((deleted.status, &deleted.json()["images"]), (200, &json!(9)));
    eventually("the space", || on_disk(&packs) < full / 4);
    let picture = service.get(&format!("/v1/images/{kept}/0/artifacts/rgb"));
    assert_eq!((picture.status, picture.body), (200, noise_png(64, 1)));
    service
        .get(&format!("/v1/images/{same}/0/artifacts/rgb"))
        .problem(404, "not-found");
    // The same bytes are accepted again.
    render(&service, &worker, "again", 2, 600);
}

#[test]
fn the_space_of_a_deleted_scene_is_reclaimed_and_others_keep_their_bytes() {
    let service = start();
    let upload = |fields: &[(&str, &[u8])]| {
        let answer = service.upload(fields);
        assert_eq!(answer.status, 201, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    };
    let (shared, mask) = (noise_png(64, 1), crate::frames::scenes::mask(64, 64));
    let kept = upload(&[("rgb", &shared), ("instances", &mask)]);
    let mut gone = vec![upload(&[("rgb", &shared)])];
    gone.extend((2..6).map(|seed| upload(&[("rgb", &noise_png(600, seed))])));
    let packs = service.folder().join("packs");
    let full = on_disk(&packs);
    for scene in gone {
        assert_eq!(service.delete(&format!("/v1/scenes/{scene}")).status, 204);
    }
    eventually("the space", || on_disk(&packs) < full / 2);
    // The remaining scene can still be rendered: its image, common to another scene, is kept.
    let job = json!({"dataset": "own", "scene": {"kind": "uploaded", "id": kept}, "artifacts": ["rgb", "instances"], "metrics": []});
    let id = service.submit(&job);
    let _worker = Real::start(&service);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
}

/// The folder of the small disk.
fn small_disk() -> PathBuf {
    let folder = std::env::var_os(small_disk::FOLDER);
    PathBuf::from(folder.expect("started by the test above"))
}

#[test]
fn a_full_disk_is_reported_reads_work_and_writes_resume_with_space() {
    small_disk::run("space::writing_on_a_full_disk", "size=24m");
}

#[test]
#[ignore = "run by the test above, on a small disk"]
fn writing_on_a_full_disk() {
    let folder = small_disk();
    let service = start_in_folder(&folder, Setup::default());
    let worker = Fake::register(&service);
    let before = render(&service, &worker, "tests", 1, 300);
    let ballast = folder.join("ballast");
    std::fs::write(&ballast, vec![7; 12 << 20]).unwrap();

    // A frame that does not fit: its worker must wait, and no part of it is visible.
    let mut one = job();
    one["count"] = json!(1);
    one["camera"] = square(2200);
    let waiting = service.submit(&one);
    let lease = worker.lease(5000).expect("a frame");
    let large = noise_png(2200, 2);
    let refused = worker.finish_with(&lease, large.clone()).unwrap_err().to_string();
    assert!(refused.contains("507"), "{refused}");
    service.get("/readyz").problem(507, "storage-full");
    assert_eq!(service.get("/livez").status, 200);
    service
        .get(&format!("/v1/images/{waiting}/0"))
        .problem(404, "not-found");
    let picture = service.get(&format!("/v1/images/{before}/0/artifacts/rgb"));
    assert_eq!(picture.status, 200, "reading goes on");
    let upload = service.upload(&[("rgb", &large)]);
    upload.problem(507, "storage-full");

    std::fs::remove_file(&ballast).unwrap();
    assert_eq!(service.get("/readyz").status, 200, "no restart is needed");
    worker.finish_with(&lease, large).unwrap();
    assert_eq!(
        service.get(&format!("/v1/jobs/{waiting}")).json()["state"],
        "done"
    );
    assert_eq!(service.upload(&[("rgb", &png(8, 6))]).status, 201);
    drop(service.stop());
}

#[test]
fn a_service_that_starts_on_a_full_disk_is_not_ready_until_there_is_space() {
    small_disk::run("space::starting_on_a_full_disk", "size=24m");
}

#[test]
#[ignore = "run by the test above, on a small disk"]
fn starting_on_a_full_disk() {
    let folder = small_disk();
    let limits = Limits {
        reserve_bytes: 4 << 20,
        ..Limits::default()
    };
    let setup = || Setup {
        limits,
        ..Setup::default()
    };
    drop(start_in_folder(&folder, setup()).stop());
    // Some kilobytes remain for opening the catalogue.
    let ballast = folder.join("ballast");
    let small = folder.join("small");
    std::fs::write(&small, vec![7; 512 << 10]).unwrap();
    fill_up(&ballast);
    std::fs::remove_file(&small).unwrap();
    let service = start_in_folder(&folder, setup());
    service.get("/readyz").problem(507, "storage-full");
    assert_eq!(service.get("/v1/jobs").status, 200);
    std::fs::remove_file(&ballast).unwrap();
    assert_eq!(service.get("/readyz").status, 200, "no restart is needed");
    drop(service.stop());
}

#[test]
fn bytes_of_which_the_commit_never_came_go_after_a_while() {
    let service = start();
    let worker = Fake::register(&service);
    let kept = render(&service, &worker, "kept", 1, 64);
    let mut lost = job();
    lost["count"] = json!(1);
    lost["seed"] = json!(2);
    let id = service.submit(&lost);
    let lease = worker.lease(5000).expect("a frame");
    worker.put(&lease, noise_png(64, 2)).unwrap();
    let data = service.stop();
    let limits = Limits {
        reserve_bytes: 0,
        unnamed: Duration::from_millis(100),
        ..Limits::default()
    };
    let service = start_on(
        data,
        Setup {
            limits,
            ..Setup::default()
        },
    );
    assert_eq!(service.delete(&format!("/v1/jobs/{id}")).status, 200);
    let blobs = |count: u64| {
        let sent = service.get("/metrics").text();
        sent.contains(&format!("fathom_store_blobs {count}\n"))
    };
    eventually("the end of bytes without a name", || blobs(1));
    let picture = service.get(&format!("/v1/images/{kept}/0/artifacts/rgb"));
    assert_eq!(picture.status, 200);
}

/// Fills the disk completely.
fn fill_up(ballast: &Path) {
    let mut file = std::fs::File::create(ballast).unwrap();
    for size in [1 << 20, 4096, 1] {
        while file.write_all(&vec![7; size]).is_ok() {}
    }
}

#[test]
fn a_job_can_be_deleted_on_a_disk_without_a_free_byte_and_its_space_is_used_again() {
    small_disk::run("space::deleting_on_a_full_disk", "size=32m");
}

#[test]
#[ignore = "run by the test above, on a small disk"]
fn deleting_on_a_full_disk() {
    let folder = small_disk();
    let limits = Limits {
        reserve_bytes: 4 << 20,
        ..Limits::default()
    };
    let service = start_in_folder(
        &folder,
        Setup {
            limits,
            ..Setup::default()
        },
    );
    let worker = Fake::register(&service);
    let jobs: Vec<String> = (0..6)
        .map(|seed| render(&service, &worker, "gone", seed, 1000))
        .collect();
    fill_up(&folder.join("ballast"));
    service
        .upload(&[("rgb", &noise_png(300, 99))])
        .problem(507, "storage-full");

    for job in &jobs {
        let deleted = service.delete(&format!("/v1/jobs/{job}"));
        assert_eq!(deleted.status, 200, "{}", deleted.text());
    }
    eventually("readiness", || service.get("/readyz").status == 200);
    assert_eq!(service.upload(&[("rgb", &noise_png(300, 99))]).status, 201);
    let kept = std::fs::metadata(folder.join("space.reserve")).unwrap().len();
    assert_eq!(kept, limits.reserve_bytes, "laid aside for the next time");
    drop(service.stop());
}
