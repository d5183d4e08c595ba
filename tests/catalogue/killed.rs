//! A process that writes and is killed, at random times and at the worst ones.
//!
//! Failure is: an image whose storing was acknowledged and that is not there; counters that are not the number of their
//! rows; a file that is damaged. The process is this very test program, which runs [`child`] alone.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use catalogue::{Catalogue, InsertImage};

use crate::fixture::Fixture;

/// Says to [`child`] where the catalogue is.
const PLACE: &str = "CATALOGUE_OF_THE_CHILD";
const FRAMES: u64 = 1_000_000;

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
#[ignore = "run by the tests below, which kill it"]
async fn child() {
    let path = std::env::var(PLACE).expect("started by the tests below");
    let catalogue = Arc::new(
        Catalogue::open(path.as_ref(), &synthetic::metrics())
            .await
            .unwrap(),
    );
    // A second job is deleted all the while.
    let gone = format!("job_gone_{}", std::process::id());
    catalogue
        .insert_job(synthetic::job(&gone, "bay", 100_000, 0))
        .await
        .unwrap();
    synthetic::fill(&catalogue, &gone, 0..300, 0).await.unwrap();
    catalogue.delete_job(&gone).await.unwrap();
    let mirrored = Arc::clone(&catalogue);
    tokio::spawn(async move {
        loop {
            mirrored.replicate_some(64).await.unwrap();
        }
    });
    let start = catalogue.job("job_a").await.unwrap().unwrap().done;
    let mut tasks = tokio::task::JoinSet::new();
    for first in start..start + 16 {
        let catalogue = Arc::clone(&catalogue);
        tasks.spawn(async move {
            for frame in (first..FRAMES).step_by(16) {
                let record = synthetic::record("job_a", frame);
                let answer = catalogue.insert_image("job_a", &record, frame).await.unwrap();
                if answer == InsertImage::Inserted {
                    writeln!(std::io::stdout(), "acknowledged {frame}").unwrap();
                }
                if frame % 32 == 0 {
                    catalogue.sweep().await.unwrap();
                }
            }
        });
    }
    tasks.join_all().await;
}

/// Starts the child and kills it after so many acknowledgements, or lets a fault do it. Returns what was acknowledged.
fn run_and_kill(path: &std::path::Path, faults: Option<&str>, most: usize) -> Vec<u64> {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args([
            "killed::child",
            "--exact",
            "--ignored",
            "--nocapture",
            "--test-threads=1",
        ])
        .env(PLACE, path)
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    if let Some(faults) = faults {
        command.env("FATHOM_FAULTS", faults);
    }
    let mut child = command.spawn().unwrap();
    let mut acknowledged = Vec::new();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    for line in lines.by_ref() {
        let line = line.unwrap();
        acknowledged.extend(
            line.strip_prefix("acknowledged ")
                .and_then(|frame| frame.parse::<u64>().ok()),
        );
        if acknowledged.len() >= most {
            break;
        }
    }
    child.kill().unwrap();
    // What it had written into the pipe before counts as well.
    for line in lines.map_while(Result::ok) {
        acknowledged.extend(
            line.strip_prefix("acknowledged ")
                .and_then(|frame| frame.parse::<u64>().ok()),
        );
    }
    assert!(!child.wait().unwrap().success());
    acknowledged
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_acknowledged_is_there_after_every_kill() {
    let mut db = Fixture::new().await;
    db.catalogue
        .insert_job(synthetic::job("job_a", "bay", FRAMES, 0))
        .await
        .unwrap();
    let path = db.folder.path().join("catalogue.sqlite");
    let mut acknowledged = BTreeSet::new();
    let faults = [
        None,
        Some("catalogue.written=abort@9"),
        Some("catalogue.committed=abort@9"),
        Some("mirror.written=abort@2"),
        None,
        Some("catalogue.written=abort@30"),
        Some("catalogue.committed=abort@31"),
        None,
        None,
    ];
    for (round, faults) in faults.into_iter().enumerate() {
        db.catalogue.close().await;
        let most = if faults.is_some() {
            usize::MAX
        } else {
            40 + 170 * round
        };
        acknowledged.extend(run_and_kill(&path, faults, most));
        db = db.reopen().await;
        db.is_sound().await;
        assert_eq!(
            db.catalogue.check_replica().await.unwrap(),
            [""; 0],
            "round {round}"
        );
        let open = db.open_job("job_a").await;
        let there = |frame: &u64| open.done.iter().any(|range| range.contains(frame));
        let lost: Vec<_> = acknowledged.iter().filter(|frame| !there(frame)).collect();
        assert!(lost.is_empty(), "round {round}: {lost:?}");
        assert_eq!(
            db.catalogue.jobs(None, None, 5, None).await.unwrap().items.len(),
            1
        );
    }
    assert!(acknowledged.len() > 500, "{}", acknowledged.len());
    // What the kills left half deleted goes with the next sweeps.
    tokio::time::timeout(Duration::from_secs(60), async {
        while db.catalogue.sweep().await.unwrap() {}
    })
    .await
    .unwrap();
    let left = db.counts().await;
    assert_eq!([left["jobs"], left["deletions"]], [1, 0]);
    assert_eq!(
        left["images"],
        db.catalogue.job("job_a").await.unwrap().unwrap().done
    );
    db.is_sound().await;
}
