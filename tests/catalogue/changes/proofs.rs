//! Proofs of frames from workers that the service does not trust.

use catalogue::{Delivery, DueCheck, JobRow, JobState};

use crate::fixture::Fixture;

async fn deliver(db: &Fixture, worker: &str, frame: u64, is_due: bool) {
    let delivery = Delivery {
        worker: worker.to_owned(),
        place: 100 + frame,
        is_due,
    };
    let record = synthetic::record("job_a", frame);
    let inserted = db
        .catalogue
        .insert_delivered("job_a", &record, 3000, Some(delivery));
    inserted.await.unwrap();
}

async fn row(db: &Fixture) -> JobRow {
    db.catalogue.job("job_a").await.unwrap().unwrap()
}

fn check(worker: &str, frame: u64) -> DueCheck {
    DueCheck {
        job: "job_a".to_owned(),
        frame,
        worker: worker.to_owned(),
    }
}

#[tokio::test]
async fn a_job_ends_only_after_a_good_check_of_each_worker_after_its_last_frame() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 6, 0).await;
    for frame in 0..4 {
        deliver(&db, "wrk_1", frame, frame == 1).await;
    }
    db.catalogue.record_good_check(check("wrk_1", 1)).await.unwrap();
    assert_eq!(
        row(&db).await.unproven,
        2,
        "a check proves the frames up to its own"
    );
    deliver(&db, "wrk_2", 4, false).await;
    synthetic::fill(&db.catalogue, "job_a", 5..6, 4000).await.unwrap();
    let db = db.reopen().await;
    let open = row(&db).await;
    assert_eq!((open.state, open.done, open.unproven), (JobState::Running, 6, 3));

    let settled = db.catalogue.settle("job_a", false, 5000).await.unwrap();
    assert!(!settled.has_ended);
    let workers: Vec<&str> = settled.checks.iter().map(|check| check.worker.as_str()).collect();
    assert_eq!(workers, ["wrk_1", "wrk_2"]);
    assert!([2, 3].contains(&settled.checks[0].frame));
    // The draw is durable, and no other one is made meanwhile.
    let db = db.reopen().await;
    assert_eq!(db.catalogue.due_checks().await.unwrap(), settled.checks);
    let waiting = db.catalogue.settle("job_a", false, 5000).await.unwrap();
    assert_eq!((waiting.checks.len(), waiting.has_ended), (0, false));
    for check in settled.checks {
        db.catalogue.record_good_check(check).await.unwrap();
    }
    assert!(db.catalogue.settle("job_a", false, 5000).await.unwrap().has_ended);
    let done = row(&db).await;
    assert_eq!((done.state, done.unproven), (JobState::Done, 0));
    assert!(done.digest.is_some());
    assert!(!db.catalogue.forget_deliveries("job_a").await.unwrap());
    assert_eq!(db.counts().await["deliveries"], 0);
    db.is_sound().await;
}

#[tokio::test]
async fn frames_that_cannot_be_checked_stay_unproven_in_an_ended_job() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 1).await;
    deliver(&db, "wrk_1", 1, true).await;
    deliver(&db, "wrk_1", 2, true).await;
    db.catalogue.record_open_check(check("wrk_1", 1)).await.unwrap();
    db.catalogue.record_open_check(check("wrk_1", 2)).await.unwrap();
    assert!(db.catalogue.settle("job_a", true, 5000).await.unwrap().has_ended);
    let done = row(&db).await;
    assert_eq!((done.state, done.unproven), (JobState::Done, 2));
    let again = db.catalogue.settle("job_a", false, 6000).await.unwrap();
    assert_eq!((again.checks.len(), again.has_ended), (0, true));
    let db = db.reopen().await;
    assert_eq!(row(&db).await.unproven, 2);
}

#[tokio::test]
async fn a_distrusted_job_needs_a_check_of_every_frame() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 6, 0).await;
    for frame in 0..3 {
        deliver(&db, "liar", frame, frame == 2).await;
    }
    for frame in 3..5 {
        deliver(&db, "other", frame, frame == 4).await;
    }
    db.catalogue.record_good_check(check("other", 4)).await.unwrap();
    let unchecked = db.catalogue.unchecked_frames("liar").await.unwrap();
    assert_eq!(unchecked, [0, 1, 2].map(|frame| ("job_a".to_owned(), frame)));
    db.catalogue.reopen("job_a", vec![0, 1, 2]).await.unwrap();
    assert_eq!(row(&db).await.unproven, 0);
    let checks = db.catalogue.distrust("job_a").await.unwrap();
    assert_eq!(checks, [check("other", 3)], "frame 4 was checked itself");
    deliver(&db, "third", 0, false).await;
    deliver(&db, "third", 1, true).await;
    db.catalogue.record_good_check(check("third", 1)).await.unwrap();
    let open = row(&db).await;
    assert_eq!((open.unproven, open.distrusted), (2, true));
}

#[tokio::test]
async fn a_check_of_a_frame_that_was_delivered_again_has_no_effect() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 2, 0).await;
    deliver(&db, "wrk_1", 0, true).await;
    db.catalogue.reopen("job_a", vec![0]).await.unwrap();
    deliver(&db, "wrk_2", 0, true).await;
    db.catalogue.record_good_check(check("wrk_1", 0)).await.unwrap();
    assert_eq!(row(&db).await.unproven, 1);
    db.catalogue.delete_job("job_a").await.unwrap();
    while db.catalogue.sweep().await.unwrap() {}
    assert_eq!(db.counts().await["deliveries"], 0);
}
