//! Many callers at once.
//!
//! Failure is: a frame with two images or none; a counter that is not the number of its rows; a caller that hears
//! something else than what became of its own change.

use std::collections::BTreeMap;
use std::sync::Arc;

use catalogue::{CatalogueError, InsertImage, JobState};
use tokio::task::JoinSet;

use crate::fixture::{Fixture, failure};

const FRAMES: u64 = 300;

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn the_same_frames_from_many_callers_become_one_image_each() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", FRAMES, 0).await;
    db.job("job_b", "bay", 50, 0).await;
    let mut tasks = JoinSet::new();
    for caller in 0..12u64 {
        let catalogue = Arc::clone(&db.catalogue);
        tasks.spawn(async move {
            let mut inserted = Vec::new();
            for step in 0..FRAMES {
                // Each caller in an order of its own; 7 and the number of frames have no common divisor.
                let frame = (step * 7 + caller * 31) % FRAMES;
                let record = synthetic::record("job_a", frame);
                if catalogue.insert_image("job_a", &record, step).await.unwrap() == InsertImage::Inserted {
                    inserted.push(frame);
                }
                // Neighbors in the same transaction that fail must not touch the others.
                if step % 10 == caller % 10 {
                    let nowhere = catalogue.insert_image("job_x", &record, step).await;
                    assert!(matches!(nowhere, Err(CatalogueError::NotFound { .. })));
                }
                if caller == 0 && step % 6 == 0 {
                    catalogue
                        .record_strike("job_b", failure(step / 6, 1, "x", step % 12 == 0))
                        .await
                        .unwrap();
                }
            }
            inserted
        });
    }
    let mut times: BTreeMap<u64, u32> = BTreeMap::new();
    while let Some(inserted) = tasks.join_next().await {
        for frame in inserted.unwrap() {
            *times.entry(frame).or_default() += 1;
        }
    }
    assert!(times.len() as u64 == FRAMES && times.values().all(|&count| count == 1));
    let (a, b) = (
        db.catalogue.job("job_a").await.unwrap().unwrap(),
        db.catalogue.job("job_b").await.unwrap().unwrap(),
    );
    assert_eq!((a.state, a.done, a.failed), (JobState::Done, FRAMES, 0));
    assert_eq!((b.state, b.done, b.failed), (JobState::Running, 0, 25));
    db.is_sound().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn the_digest_of_a_job_does_not_depend_on_the_order_of_its_images() {
    let mut digests = Vec::new();
    for stride in [1, 7, 143] {
        let db = Fixture::new().await;
        db.job("job_a", "bay", 200, 0).await;
        for step in 0..200 {
            let record = synthetic::record("job_a", step * stride % 200);
            db.catalogue.insert_image("job_a", &record, 0).await.unwrap();
        }
        let job = db.catalogue.job("job_a").await.unwrap().unwrap();
        digests.push(job.digest.unwrap());
    }
    let frames: Vec<String> = (0..200)
        .map(|frame| synthetic::record("job_a", frame).digest())
        .collect();
    let expected = spec::job_digest(frames.iter().map(String::as_str));
    assert!(digests.iter().all(|digest| *digest == expected));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn deleting_while_images_arrive_leaves_nothing_behind() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 5000, 0).await;
    let catalogue = Arc::clone(&db.catalogue);
    let arriving = tokio::spawn(async move { synthetic::fill(&catalogue, "job_a", 0..5000, 0).await });
    while db.catalogue.job("job_a").await.unwrap().unwrap().done < 500 {
        tokio::task::yield_now().await;
    }
    db.catalogue.delete_job("job_a").await.unwrap();
    while db.catalogue.sweep().await.unwrap() {}
    assert!(matches!(
        arriving.await.unwrap(),
        Err(CatalogueError::NotFound { .. })
    ));
    let left = db.counts().await;
    assert_eq!(
        [
            left["jobs"],
            left["images"],
            left["artifacts"],
            left["measurements"]
        ],
        [0; 4]
    );
    assert!(db.datasets().await.is_empty());
    db.is_sound().await;
}
