//! Rendering jobs into folders: any number of slots, interruption and resumption.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::Path;

use renderer::local::{LocalError, Summary, render_job};
use serde_json::json;
use spec::{FrameRecord, Job};
use tempfile::tempdir;

use crate::common::{Files, engine_without_runtime};

const FRAMES: u64 = 7;

fn job(files: &Files) -> Job {
    let water = json!({"optics": "jerlov-3C", "range_scale": {"uniform": [0.5, 3]}});
    files.job(&json!({"water": water, "count": FRAMES, "artifacts": ["rgb", "range"], "metrics": ["uciqe"]}))
}

fn run(job: &Job, out: &Path, slots: usize) -> Summary {
    render(job, out, 0..job.frames(), slots).unwrap()
}

fn render(job: &Job, out: &Path, frames: Range<u64>, slots: usize) -> Result<Summary, LocalError> {
    render_job(job, &engine_without_runtime(), out, frames, slots, |_| {})
}

/// Every file by its path, except the records, which contain times.
fn contents(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![out.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(out).unwrap().display().to_string();
            if path.is_dir() {
                folders.push(path);
            } else if name != "records.jsonl" {
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

fn records(out: &Path) -> Vec<FrameRecord> {
    let text = fs::read_to_string(out.join("records.jsonl")).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn one_slot_and_three_give_the_same_bytes_and_digest() {
    let (files, one, three) = (Files::new(), tempdir().unwrap(), tempdir().unwrap());
    let job = job(&files);
    let (first, second) = (run(&job, one.path(), 1), run(&job, three.path(), 3));
    assert_eq!((first.frames, first.failed, first.kept), (FRAMES, 0, 0));
    assert_eq!(first.digest, second.digest);
    assert_eq!(contents(one.path()), contents(three.path()));
    assert_eq!(contents(one.path()).len() as u64, 2 * FRAMES + 2);
    let frames: Vec<u64> = records(three.path()).iter().map(|record| record.frame).collect();
    assert_eq!(frames, (0..FRAMES).collect::<Vec<_>>());
}

#[test]
fn an_interrupted_job_goes_on_where_it_was_and_ends_the_same() {
    let (files, whole, broken) = (Files::new(), tempdir().unwrap(), tempdir().unwrap());
    let job = job(&files);
    let (expected, _) = (run(&job, whole.path(), 2), run(&job, broken.path(), 2));
    // The state after a kill: three whole lines, half of one, a frame without a line, a draft.
    let text = fs::read_to_string(broken.path().join("records.jsonl")).unwrap();
    let end = text.match_indices('\n').nth(2).unwrap().0 + 40;
    fs::write(broken.path().join("records.jsonl"), &text[..end]).unwrap();
    fs::create_dir(broken.path().join(".5.draft")).unwrap();
    fs::write(broken.path().join("4/rgb.png"), b"torn").unwrap();
    let mut reported = Vec::new();
    let again = render_job(
        &job,
        &engine_without_runtime(),
        broken.path(),
        0..job.frames(),
        2,
        |done| reported.push(done),
    )
    .unwrap();
    assert_eq!((again.kept, &again.digest), (3, &expected.digest));
    assert_eq!((reported.first(), reported.last()), (Some(&3), Some(&FRAMES)));
    assert_eq!(contents(whole.path()), contents(broken.path()));
}

#[test]
fn a_folder_with_something_else_in_it_is_refused() {
    let (files, out) = (Files::new(), tempdir().unwrap());
    let render = |job: &Job| render(job, out.path(), 0..job.frames(), 1);
    fs::write(out.path().join("notes.txt"), "mine").unwrap();
    assert!(matches!(render(&job(&files)), Err(LocalError::NotEmpty { .. })));
    fs::remove_file(out.path().join("notes.txt")).unwrap();
    run(&job(&files), out.path(), 1);
    let other = files.job(&json!({"artifacts": ["rgb"]}));
    let Err(LocalError::OtherJob { differences, .. }) = render(&other) else {
        panic!("another job");
    };
    assert!(
        differences.contains("`count` is 7 there and 1 here"),
        "{differences}"
    );
}

#[test]
fn a_description_cut_off_by_a_crash_is_completed_only_before_the_first_frame() {
    let (files, out) = (Files::new(), tempdir().unwrap());
    let (job, card) = (job(&files), out.path().join("job.json"));
    fs::write(&card, &job.canonical()[..40]).unwrap();
    run(&job, out.path(), 1);
    assert_eq!(fs::read_to_string(&card).unwrap(), job.canonical());
    fs::write(&card, &job.canonical()[..40]).unwrap();
    let again = render(&job, out.path(), 0..job.frames(), 1);
    assert!(matches!(again, Err(LocalError::OtherJob { .. })), "{again:?}");
}

#[test]
fn a_folder_in_which_another_process_renders_is_taken_and_free_afterwards() {
    let (files, out) = (Files::new(), tempdir().unwrap());
    let job = job(&files);
    let first = run(&job, out.path(), 1);
    let other = fs::File::open(out.path().join("job.json")).unwrap();
    other.lock().unwrap();
    let taken = render(&job, out.path(), 0..job.frames(), 1);
    assert!(matches!(taken, Err(LocalError::Taken { .. })), "{taken:?}");
    drop(other);
    assert_eq!(run(&job, out.path(), 1).digest, first.digest);
    assert_eq!(records(out.path()).len() as u64, FRAMES);
}

#[test]
fn frames_that_fail_are_listed_and_the_others_are_there() {
    let (files, out) = (Files::new(), tempdir().unwrap());
    let scenes = json!({"grid": [files.scene("range.npy"), {"kind": "files", "rgb": "/nowhere"}, files.scene("holes.npy")]});
    let job = files.job(&json!({"scene": scenes, "artifacts": ["rgb"]}));
    let summary = run(&job, out.path(), 2);
    assert_eq!((summary.frames, summary.failed), (3, 1));
    let errors = fs::read_to_string(out.path().join("errors.jsonl")).unwrap();
    assert!(
        errors.starts_with("{\"frame\":1,\"error\":\"cannot read /nowhere: "),
        "{errors}"
    );
    let frames: Vec<u64> = records(out.path()).iter().map(|record| record.frame).collect();
    assert_eq!(frames, [0, 2]);
    assert!(!out.path().join("1").exists());
}

#[test]
fn a_folder_holds_one_range_of_frames_that_grows_at_its_end() {
    let (files, out, whole) = (Files::new(), tempdir().unwrap(), tempdir().unwrap());
    let job = job(&files);
    let all = run(&job, whole.path(), 2);
    let part = render(&job, out.path(), 2..4, 2).unwrap();
    assert_eq!((part.frames, part.kept), (2, 0));
    for frame in 0..FRAMES {
        let is_there = out.path().join(frame.to_string()).exists();
        assert_eq!(is_there, (2..4).contains(&frame), "{frame}");
    }
    let picture = |folder: &Path| fs::read(folder.join("3/rgb.png")).unwrap();
    assert_eq!(picture(out.path()), picture(whole.path()));
    let earlier = render(&job, out.path(), 0..4, 1);
    assert!(
        matches!(
            earlier,
            Err(LocalError::OtherFrames {
                first: 2,
                next: 4,
                wanted: 0
            })
        ),
        "{earlier:?}"
    );
    let grown = render(&job, out.path(), 2..FRAMES, 2).unwrap();
    assert_eq!((grown.frames, grown.kept), (FRAMES - 2, 2));
    // Fewer frames than the folder holds change nothing, and the digest is that of the folder.
    let fewer = render(&job, out.path(), 2..3, 1).unwrap();
    assert_eq!((fewer.frames, &fewer.digest), (FRAMES - 2, &grown.digest));
    assert_ne!(grown.digest, all.digest);
}
