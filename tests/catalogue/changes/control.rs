//! Pausing, resuming, trying again.

use catalogue::{CatalogueError, InsertImage, InsertJob, JobState, SceneRow, UnixMs};
use spec::{Classes, Intrinsics, RangeFile, RangeKind, SceneCategory, SceneFiles, Segment};

use crate::fixture::{Fixture, failure};

#[tokio::test]
async fn a_job_goes_on_as_what_it_was_before_the_pause() {
    let db = Fixture::new().await;
    db.job("job_new", "bay", 3, 0).await;
    db.job("job_begun", "bay", 3, 1).await;
    for (id, state) in [("job_new", JobState::Queued), ("job_begun", JobState::Running)] {
        let before = db.catalogue.job(id).await.unwrap().unwrap();
        assert_eq!(before.state, state);
        let paused = db.catalogue.set_state(id, JobState::Paused).await.unwrap();
        assert_eq!(paused.state, JobState::Paused);
        assert!(paused.version > before.version);
        assert_eq!(
            db.catalogue.set_state(id, JobState::Paused).await.unwrap(),
            paused
        );
        let resumed = db.catalogue.set_state(id, JobState::Queued).await.unwrap();
        assert_eq!(resumed.state, state);
        assert_eq!(
            db.catalogue.set_state(id, JobState::Running).await.unwrap(),
            resumed
        );
    }
}

#[tokio::test]
async fn a_paused_job_takes_what_was_under_way_and_ends_if_that_was_all() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 2, 0).await;
    db.catalogue.set_state("job_a", JobState::Paused).await.unwrap();
    let open = db.open_job("job_a").await;
    assert_eq!((open.row.state, open.done), (JobState::Paused, vec![]));
    synthetic::fill(&db.catalogue, "job_a", 0..1, 0).await.unwrap();
    assert_eq!(
        db.catalogue.job("job_a").await.unwrap().unwrap().state,
        JobState::Paused
    );
    synthetic::fill(&db.catalogue, "job_a", 1..2, 0).await.unwrap();
    let done = db.catalogue.job("job_a").await.unwrap().unwrap();
    assert_eq!((done.state, done.digest.is_some()), (JobState::Done, true));
    assert_eq!(
        db.catalogue
            .set_state("job_a", JobState::Cancelled)
            .await
            .unwrap(),
        done
    );
    for state in [JobState::Paused, JobState::Queued] {
        let refused = db.catalogue.set_state("job_a", state).await;
        assert!(
            matches!(refused, Err(CatalogueError::Transition { .. })),
            "{state}"
        );
    }
}

#[tokio::test]
async fn failed_frames_can_be_tried_again_and_the_job_ends_as_if_none_had_failed() {
    let (db, other) = (Fixture::new().await, Fixture::new().await);
    db.job("job_a", "bay", 4, 2).await;
    db.catalogue
        .record_strike("job_a", failure(2, 1, "first", false))
        .await
        .unwrap();
    db.give_up("job_a", 2).await;
    db.give_up("job_a", 3).await;
    let ended = db.catalogue.job("job_a").await.unwrap().unwrap();
    assert_eq!(
        (ended.state, ended.done, ended.failed),
        (JobState::DoneWithFailures, 2, 2)
    );
    let again = db.catalogue.retry_failed("job_a").await.unwrap();
    assert_eq!(again.frames, [2, 3]);
    assert_eq!((again.job.state, again.job.failed), (JobState::Running, 0));
    assert_eq!(
        (again.job.finished_at, db.all_failures("job_a").await),
        (None, vec![])
    );
    let open = db.open_job("job_a").await;
    assert_eq!(
        (open.done, open.failed),
        (std::iter::once(0..2).collect(), vec![])
    );
    db.is_sound().await;
    synthetic::fill(&db.catalogue, "job_a", 2..4, 9).await.unwrap();
    other.job("job_a", "bay", 4, 4).await;
    let (mine, undisturbed) = (
        db.catalogue.job("job_a").await.unwrap().unwrap(),
        other.catalogue.job("job_a").await.unwrap().unwrap(),
    );
    assert_eq!(mine.state, JobState::Done);
    assert_eq!(mine.digest, undisturbed.digest);
    assert!(mine.digest.is_some());
}

#[tokio::test]
async fn what_is_cancelled_or_done_or_unknown_is_not_tried_again() {
    let db = Fixture::new().await;
    db.job("job_done", "bay", 1, 1).await;
    db.job("job_cancelled", "bay", 2, 1).await;
    db.catalogue
        .set_state("job_cancelled", JobState::Cancelled)
        .await
        .unwrap();
    for id in ["job_done", "job_cancelled"] {
        let refused = db.catalogue.retry_failed(id).await;
        assert!(matches!(refused, Err(CatalogueError::Transition { .. })), "{id}");
    }
    let unknown = db.catalogue.retry_failed("job_x").await;
    assert!(matches!(unknown, Err(CatalogueError::NotFound { .. })));
}

#[tokio::test]
async fn a_late_image_of_a_frame_that_was_given_up_counts_once_and_a_late_strike_not_at_all() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 1).await;
    db.give_up("job_a", 1).await;
    let late = synthetic::record("job_a", 1);
    for expected in [InsertImage::Inserted, InsertImage::AlreadyThere] {
        assert_eq!(
            db.catalogue.insert_image("job_a", &late, 0).await.unwrap(),
            expected
        );
    }
    db.give_up("job_a", 0).await;
    let job = db.catalogue.job("job_a").await.unwrap().unwrap();
    assert_eq!((job.done, job.failed, job.state), (2, 0, JobState::Running));
    db.is_sound().await;
}

#[tokio::test]
async fn results_and_failures_come_in_frame_order_page_by_page() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 10, 5).await;
    for frame in [9, 7, 8] {
        db.give_up("job_a", frame).await;
    }
    let mut frames = Vec::new();
    let mut after = None;
    loop {
        let page = db.catalogue.results("job_a", after, 2).await.unwrap().rows;
        let Some(last) = page.last() else { break };
        after = last["frame"].as_u64();
        frames.extend(page.iter().map(|image| image["frame"].as_u64().unwrap()));
    }
    assert_eq!(frames, [0, 1, 2, 3, 4]);
    let failed = db.catalogue.failures("job_a", Some(7), 5).await.unwrap();
    assert_eq!(failed.iter().map(|f| f.frame).collect::<Vec<_>>(), [8, 9]);
    assert_eq!(
        db.catalogue.failures("job_a", Some(u64::MAX), 5).await.unwrap(),
        []
    );
}

/// Every change returns the row that it leaves, so nobody has to read it again.
#[tokio::test]
async fn a_change_returns_its_row_without_a_read() {
    let db = Fixture::new().await;
    let new = synthetic::job("job_a", "bay", 3, 1000);
    let InsertJob::Created(stored) = db.catalogue.insert_job(new).await.unwrap() else {
        panic!("it is new");
    };
    let scene = SceneRow {
        id: "scn_a".to_owned(),
        content_digest: "c".repeat(64),
        files: SceneFiles {
            rgb: "a".repeat(64),
            range: Some(RangeFile {
                file: "b".repeat(64),
                kind: RangeKind::ZDepth,
                unit_m: Some(0.001),
                invalid_code: Some(65_535),
            }),
            instances: None,
            intrinsics: Some(Intrinsics {
                focal_px: 2.5,
                cx: 2.0,
                cy: 1.5,
            }),
            classes: Some(Classes {
                categories: vec![SceneCategory {
                    id: 2,
                    name: "pile".to_owned(),
                }],
                segments_info: vec![Segment {
                    id: 300,
                    category_id: 2,
                }],
            }),
            world_from_camera: Some([
                [1.0, 0.0, 0.0, 7.5],
                [0.0, 0.0, 1.0, 0.1],
                [0.0, -1.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ]),
            hfov_deg: Some(60.0),
            scale: Some(0.5),
        },
        width: 4,
        height: 3,
        created_at: UnixMs(7),
    };
    let kept = db.catalogue.insert_scene(scene.clone()).await.unwrap();
    let other = SceneRow {
        id: "scn_b".to_owned(),
        ..scene.clone()
    };
    let again = db.catalogue.insert_scene(other).await.unwrap();
    let paused = db.catalogue.set_state("job_a", JobState::Paused).await.unwrap();
    assert_eq!(db.catalogue.reads(), 0);
    assert_eq!(db.catalogue.job("job_a").await.unwrap(), Some(paused.clone()));
    assert_eq!((stored.state, paused.state), (JobState::Queued, JobState::Paused));
    assert_eq!((&kept, &again), (&(scene.clone(), true), &(scene.clone(), false)));
    assert_eq!(db.catalogue.scene("scn_a").await.unwrap(), Some(scene));
    let reads = db.catalogue.reads();
    db.give_up("job_a", 1).await;
    let retried = db.catalogue.retry_failed("job_a").await.unwrap();
    let cancelled = db
        .catalogue
        .set_state("job_a", JobState::Cancelled)
        .await
        .unwrap();
    let unchanged = db
        .catalogue
        .set_state("job_a", JobState::Cancelled)
        .await
        .unwrap();
    assert_eq!(db.catalogue.reads(), reads);
    assert_eq!((retried.frames, &unchanged), (vec![1], &cancelled));
    assert_eq!(db.catalogue.job("job_a").await.unwrap(), Some(cancelled));
}

#[tokio::test]
async fn a_description_whose_images_are_there_is_not_stored_again() {
    let db = Fixture::new().await;
    let job = |id: &str, dataset: &str| catalogue::NewJob {
        spec_digest: "the same".to_owned(),
        ..synthetic::job(id, dataset, 2, 0)
    };
    let insert = async |job| db.catalogue.insert_job(job).await.unwrap();
    assert!(matches!(insert(job("job_a", "bay")).await, InsertJob::Created(row) if row.warnings.is_empty()));
    let InsertJob::Created(twin) = insert(job("job_b", "bay")).await else {
        panic!("the first has no image yet");
    };
    assert!(twin.warnings[0].starts_with("job_a in dataset `bay` has the same description and is queued"));
    synthetic::fill(&db.catalogue, "job_a", 0..2, 0).await.unwrap();
    let keyed = || catalogue::NewJob {
        idempotency: Some(catalogue::Idempotency {
            owner: "me".to_owned(),
            key: "k".to_owned(),
            body_digest: "the same".to_owned(),
        }),
        ..job("job_c", "bay")
    };
    let InsertJob::Complete(row) = insert(keyed()).await else {
        panic!("every image is there");
    };
    assert_eq!(row.id, "job_a");
    assert!(row.warnings[0].contains("has every image of this description already, from job_a"));
    assert!(matches!(insert(keyed()).await, InsertJob::Replayed(row) if row.id == "job_a"));
    assert!(
        matches!(insert(job("job_d", "cove")).await, InsertJob::Created(_)),
        "another dataset"
    );
    let again = catalogue::NewJob {
        again: true,
        ..job("job_e", "bay")
    };
    assert!(matches!(insert(again).await, InsertJob::Created(row) if row.warnings.is_empty()));
    db.catalogue.delete_job("job_a").await.unwrap();
    assert!(
        matches!(insert(job("job_f", "bay")).await, InsertJob::Created(_)),
        "its images are gone"
    );
}

/// Failure: a kill during a restart leaves a job that workers continue, with images of its earlier run.
#[tokio::test]
async fn an_interrupted_restart_continues_until_no_image_remains() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 1500, 0).await;
    db.catalogue.mix_machines("job_a", true).await.unwrap();
    synthetic::fill(&db.catalogue, "job_a", 0..1499, 2000)
        .await
        .unwrap();
    db.give_up("job_a", 1499).await;
    db.catalogue.begin_restart("job_a").await.unwrap();
    let mut db = db.reopen().await;
    for left in [1499, 499] {
        let row = db.catalogue.job("job_a").await.unwrap().unwrap();
        assert_eq!((row.state, row.done, row.failed), (JobState::Running, left, 0));
        assert_eq!(db.catalogue.restarting_jobs().await.unwrap(), ["job_a"]);
        assert!(db.catalogue.open_jobs().await.unwrap().is_empty());
        assert_eq!(db.catalogue.continue_restart("job_a").await.unwrap(), None);
        db = db.reopen().await;
    }
    let row = db.catalogue.continue_restart("job_a").await.unwrap().unwrap();
    assert_eq!(
        (row.state, row.done, row.failed, row.bytes, row.mixed),
        (JobState::Queued, 0, 0, 0, false)
    );
    let db = db.reopen().await;
    assert!(db.catalogue.restarting_jobs().await.unwrap().is_empty());
    let open = db.catalogue.open_jobs().await.unwrap();
    assert!(open.len() == 1 && open[0].done.is_empty() && open[0].failed.is_empty());
    assert_eq!(
        (db.all_failures("job_a").await, db.datasets().await[0].images),
        (vec![], 0)
    );
    db.is_sound().await;
    synthetic::fill(&db.catalogue, "job_a", 0..1500, 3000)
        .await
        .unwrap();
    assert_eq!(
        db.catalogue.job("job_a").await.unwrap().unwrap().state,
        JobState::Done
    );
}

#[tokio::test]
async fn a_cancelled_job_does_not_start_again_and_ends_a_restart() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 2).await;
    db.catalogue.begin_restart("job_a").await.unwrap();
    db.catalogue
        .set_state("job_a", JobState::Cancelled)
        .await
        .unwrap();
    let row = db.catalogue.continue_restart("job_a").await.unwrap().unwrap();
    assert_eq!((row.state, row.done), (JobState::Cancelled, 2));
    assert!(db.catalogue.restarting_jobs().await.unwrap().is_empty());
    let refused = db.catalogue.begin_restart("job_a").await;
    assert!(
        matches!(refused, Err(CatalogueError::Transition { .. })),
        "{refused:?}"
    );
}
