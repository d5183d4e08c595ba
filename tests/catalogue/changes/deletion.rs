//! Deleting: at once out of sight, bit by bit off the disk, whatever happens in between.

use std::collections::BTreeSet;

use catalogue::{CatalogueError, Deleted, Idempotency, ImageQuery, InsertJob, JobState};

use crate::fixture::Fixture;

fn all() -> ImageQuery {
    ImageQuery {
        limit: 1000,
        fields: vec!["job".to_owned()],
        ..ImageQuery::default()
    }
}

async fn sweep_to_the_end(db: &Fixture) -> u32 {
    let mut steps = 0;
    while db.catalogue.sweep().await.unwrap() {
        steps += 1;
    }
    steps
}

/// What the job with this id names.
fn named(job: &str, frames: u64) -> BTreeSet<String> {
    let records = (0..frames).map(|frame| synthetic::record(job, frame));
    records
        .flat_map(|record| record.artifacts)
        .map(|artifact| artifact.digest)
        .collect()
}

#[tokio::test]
async fn a_deleted_job_is_out_of_sight_at_once_and_its_dataset_counts_without_it() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 5, 3).await;
    db.job("job_b", "bay", 5, 2).await;
    db.give_up("job_a", 4).await;
    let before = db.datasets().await;
    let gone = db.catalogue.delete_job("job_a").await.unwrap();
    assert_eq!((gone.jobs, gone.images), (1, 3));
    let after = db.datasets().await;
    assert_eq!((after[0].jobs, after[0].images), (1, 2));
    assert_eq!(after[0].bytes + gone.bytes, before[0].bytes);
    assert_eq!(db.catalogue.job("job_a").await.unwrap(), None);
    assert_eq!(db.catalogue.image("job_a", 0).await.unwrap(), None);
    assert_eq!(db.catalogue.artifact("job_a", 0, "rgb").await.unwrap(), None);
    assert!(
        db.catalogue
            .results("job_a", None, 9)
            .await
            .unwrap()
            .rows
            .is_empty()
    );
    assert_eq!(db.all_failures("job_a").await, []);
    assert!(
        db.catalogue
            .open_jobs()
            .await
            .unwrap()
            .iter()
            .all(|job| job.row.id == "job_b")
    );
    assert_eq!(
        db.catalogue.jobs(None, None, 9, None).await.unwrap().items.len(),
        1
    );
    let page = db.catalogue.images(all()).await.unwrap();
    assert!(page.items.len() == 2 && page.items.iter().all(|row| row["job"] == "job_b"));
    let stats = db
        .catalogue
        .stats("bay", &["uiqm".to_owned()], None, None)
        .await
        .unwrap();
    assert_eq!(stats.groups[0].count, 2);
    let late = db
        .catalogue
        .insert_image("job_a", &synthetic::record("job_a", 3), 0)
        .await;
    assert!(matches!(late, Err(CatalogueError::NotFound { .. })));
    db.give_up("job_a", 3).await;
    let again = db.catalogue.delete_job("job_a").await;
    assert!(matches!(again, Err(CatalogueError::NotFound { .. })));
    db.is_sound().await;
}

#[tokio::test]
async fn the_rows_go_in_small_steps_and_a_crash_between_them_loses_no_orphan() {
    let mut db = Fixture::new().await;
    db.job("job_a", "bay", 2500, 2400).await;
    db.job("job_b", "bay", 2, 2).await;
    db.catalogue.delete_job("job_a").await.unwrap();
    let mut steps = 0;
    while db.catalogue.sweep().await.unwrap() {
        steps += 1;
        db = db.reopen().await;
        db.is_sound().await;
    }
    assert!(steps > 10, "{steps} steps for thousands of rows");
    let left = db.counts().await;
    assert_eq!(
        [
            left["jobs"],
            left["images"],
            left["artifacts"],
            left["measurements"]
        ],
        [1, 2, 4, 4]
    );
    assert_eq!(
        [left["deletions"], left["failures"], left["orphans"]],
        [0, 0, 4800]
    );
    let mut orphans = BTreeSet::new();
    loop {
        let some = db.catalogue.orphans(500).await.unwrap();
        if some.is_empty() {
            break;
        }
        db.catalogue.forget_orphans(some.clone()).await.unwrap();
        db = db.reopen().await;
        orphans.extend(some);
    }
    assert_eq!(orphans, named("job_a", 2400));
}

#[tokio::test]
async fn what_another_row_or_a_scene_names_is_no_orphan() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 2, 2).await;
    // The same description again has the same bytes.
    let mut copy = synthetic::job("job_copy", "cove", 2, 0);
    copy.idempotency = Some(Idempotency {
        owner: "me".to_owned(),
        key: "k".to_owned(),
        body_digest: "d".to_owned(),
    });
    db.catalogue.insert_job(copy.clone()).await.unwrap();
    db.catalogue
        .insert_image("job_copy", &synthetic::record("job_a", 0), 0)
        .await
        .unwrap();
    db.catalogue.delete_job("job_a").await.unwrap();
    sweep_to_the_end(&db).await;
    let of_frame = |frame| -> BTreeSet<String> {
        let record = synthetic::record("job_a", frame);
        record
            .artifacts
            .into_iter()
            .map(|artifact| artifact.digest)
            .collect()
    };
    let orphans: BTreeSet<String> = db.catalogue.orphans(100).await.unwrap().into_iter().collect();
    assert_eq!(orphans, of_frame(1));
    let listed = db.catalogue.artifacts_after(None, 10).await.unwrap();
    assert!(listed.iter().all(|row| row.job_id == "job_copy"));
    assert_eq!(
        listed.into_iter().map(|row| row.digest).collect::<BTreeSet<_>>(),
        of_frame(0)
    );
    // With the last name the bytes go, and the key is free for another description.
    db.catalogue.delete_job("job_copy").await.unwrap();
    sweep_to_the_end(&db).await;
    assert_eq!(db.catalogue.orphans(100).await.unwrap().len(), 4);
    copy.id = "job_third".to_owned();
    assert!(matches!(
        db.catalogue.insert_job(copy).await.unwrap(),
        InsertJob::Created(_)
    ));
}

#[tokio::test]
async fn a_dataset_goes_with_all_its_jobs_unless_one_of_them_is_under_way() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 2, 2).await;
    db.job("job_b", "bay", 2, 1).await;
    db.job("job_c", "cove", 1, 1).await;
    match db.catalogue.delete_dataset("bay").await {
        Err(CatalogueError::Transition { id, from, .. }) => assert_eq!((&*id, &*from), ("job_b", "running")),
        other => panic!("{other:?}"),
    }
    db.catalogue
        .set_state("job_b", JobState::Cancelled)
        .await
        .unwrap();
    let gone = db.catalogue.delete_dataset("bay").await.unwrap();
    assert!(
        matches!(
            gone,
            Deleted {
                jobs: 2,
                images: 3,
                bytes: 900_000..
            }
        ),
        "{gone:?}"
    );
    assert!(matches!(
        db.catalogue.delete_dataset("bay").await,
        Err(CatalogueError::NotFound { .. })
    ));
    // The name is free again while the rows still go.
    db.job("job_d", "bay", 1, 1).await;
    sweep_to_the_end(&db).await;
    db.is_sound().await;
    let left = db.datasets().await;
    let sums: Vec<_> = left
        .iter()
        .map(|row| (row.name.as_str(), row.images, row.jobs))
        .collect();
    assert_eq!(sums, [("bay", 1, 1), ("cove", 1, 1)]);
}
