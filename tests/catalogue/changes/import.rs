//! Images whose bytes stay in the tars of a set.

use std::collections::BTreeMap;

use catalogue::{CatalogueError, InsertJob, JobState, NewImage, NewJob, NewShard, ShardEnd};

use spec::RecordText;

use crate::fixture::{Fixture, failure};

const JOB: &str = "job_set";
const SET: &str = "/sets/reef";

fn new_job(id: &str, frames: u64) -> NewJob {
    NewJob {
        set: Some(SET.to_owned()),
        again: true,
        ..synthetic::job(id, "reef", frames, 1000)
    }
}

fn shard(frame: u64, tar: &str) -> NewShard {
    NewShard {
        frame,
        tar: tar.to_owned(),
        end: None,
    }
}

fn end(changed_ms: i64) -> ShardEnd {
    ShardEnd {
        digest: "d".to_owned(),
        changed_ms,
        failed: Vec::new(),
    }
}

impl Fixture {
    fn image(&self, of: &str, frame: u64, offset: u64) -> NewImage {
        let record = synthetic::record(of, frame);
        let kinds = record.artifacts.iter().zip(0..);
        let offsets: BTreeMap<String, u64> = kinds
            .map(|(artifact, place)| (artifact.kind.clone(), offset + 100 * place))
            .collect();
        let text = serde_json::to_value(&record).unwrap().to_string();
        let record = RecordText::read(text).unwrap();
        self.catalogue
            .imported_image(JOB, &record, 2000 + frame, &offsets)
            .unwrap()
    }

    async fn place(&self, frame: u64) -> Option<(String, u64)> {
        let artifact = self
            .catalogue
            .artifact(JOB, frame, "range")
            .await
            .unwrap()
            .unwrap();
        artifact.place.map(|place| (place.tar, place.offset))
    }
}

#[tokio::test]
async fn an_imported_artifact_is_found_in_the_tar_of_its_shard() {
    let db = Fixture::new().await;
    db.catalogue.insert_job(new_job(JOB, 6)).await.unwrap();
    for (first, tar) in [(0, "a.tar"), (3, "b.tar")] {
        let images = (first..first + 3)
            .map(|frame| db.image(JOB, frame, 1000 * frame))
            .collect();
        let shard = NewShard {
            end: Some(end(7)),
            ..shard(first, tar)
        };
        assert_eq!(db.catalogue.import(JOB, images, shard).await.unwrap(), 3);
    }
    assert_eq!(db.place(2).await, Some(("a.tar".to_owned(), 2100)));
    assert_eq!(db.place(3).await, Some(("b.tar".to_owned(), 3100)));
    let row = db.catalogue.job(JOB).await.unwrap().unwrap();
    assert_eq!(
        (row.state, row.done, row.set.as_deref()),
        (JobState::Done, 6, Some(SET))
    );
    assert!(
        db.catalogue.artifacts_after(None, 100).await.unwrap().is_empty(),
        "none is in the packs"
    );
    let (mut listed, mut last) = (Vec::new(), None);
    while let Some(artifact) = db
        .catalogue
        .imported_artifacts(JOB, last.as_ref(), 1)
        .await
        .unwrap()
        .pop()
    {
        listed.push((artifact.frame, artifact.entry.kind.clone()));
        last = Some(artifact);
    }
    assert_eq!(listed.len(), 12);
    assert!(listed.is_sorted());
    db.is_sound().await;
}

#[tokio::test]
async fn importing_again_changes_only_the_places() {
    let db = Fixture::new().await;
    db.catalogue.insert_job(new_job(JOB, 3)).await.unwrap();
    let whole = |tar: &str, changed_ms| NewShard {
        end: Some(end(changed_ms)),
        ..shard(0, tar)
    };
    let images = |offset| {
        (0..3)
            .map(|frame| db.image(JOB, frame, offset))
            .collect::<Vec<_>>()
    };
    db.catalogue
        .import(JOB, images(10), whole("a.tar", 1))
        .await
        .unwrap();
    let row = db.catalogue.job(JOB).await.unwrap();
    assert_eq!(
        db.catalogue
            .import(JOB, images(20), whole("b.tar", 2))
            .await
            .unwrap(),
        0
    );
    assert_eq!(db.place(1).await, Some(("b.tar".to_owned(), 120)));
    assert_eq!(db.catalogue.job(JOB).await.unwrap(), row);
    let other = vec![db.image("job_other", 1, 30)];
    let refused = db.catalogue.import(JOB, other, whole("c.tar", 3)).await;
    assert!(
        matches!(refused, Err(CatalogueError::Contradicted { frame: 1, .. })),
        "{refused:?}"
    );
    assert_eq!(
        db.place(1).await,
        Some(("b.tar".to_owned(), 120)),
        "all or nothing"
    );
    let shards = db.catalogue.imported_shards(JOB).await.unwrap();
    assert_eq!(
        shards.iter().map(|shard| shard.changed_ms).collect::<Vec<_>>(),
        [2]
    );
    db.is_sound().await;
}

#[tokio::test]
async fn a_set_is_one_job_whose_frames_nobody_renders_here() {
    let db = Fixture::new().await;
    db.catalogue.insert_job(new_job(JOB, 4)).await.unwrap();
    let again = db.catalogue.insert_job(new_job("job_again", 4)).await.unwrap();
    assert!(matches!(again, InsertJob::Replayed(row) if row.id == JOB));
    let failed = vec![failure(1, 3, "boom", true)];
    let shard = NewShard {
        end: Some(ShardEnd { failed, ..end(1) }),
        ..shard(0, "a.tar")
    };
    db.catalogue
        .import(JOB, vec![db.image(JOB, 0, 0)], shard)
        .await
        .unwrap();
    let row = db.catalogue.job(JOB).await.unwrap().unwrap();
    assert_eq!((row.state, row.done, row.failed), (JobState::Running, 1, 1));
    assert_eq!(db.all_failures(JOB).await, [failure(1, 3, "boom", true)]);
    assert!(db.catalogue.open_jobs().await.unwrap().is_empty());
    for state in [JobState::Paused, JobState::Cancelled] {
        let refused = db.catalogue.set_state(JOB, state).await;
        assert!(
            matches!(refused, Err(CatalogueError::Imported { .. })),
            "{refused:?}"
        );
    }
    assert!(matches!(
        db.catalogue.retry_failed(JOB).await,
        Err(CatalogueError::Imported { .. })
    ));
    db.is_sound().await;
}

#[tokio::test]
async fn a_frame_that_had_failed_and_is_imported_ends_its_job_anew() {
    let db = Fixture::new().await;
    db.catalogue.insert_job(new_job(JOB, 2)).await.unwrap();
    let whole = |tar: &str, changed_ms, failed| NewShard {
        end: Some(ShardEnd {
            failed,
            ..end(changed_ms)
        }),
        ..shard(0, tar)
    };
    let failed = vec![failure(1, 3, "boom", true)];
    let image = |frame| db.image(JOB, frame, 0);
    db.catalogue
        .import(JOB, vec![image(0)], whole("a.tar", 1, failed))
        .await
        .unwrap();
    let row = db.catalogue.job(JOB).await.unwrap().unwrap();
    assert_eq!((row.state, row.failed), (JobState::DoneWithFailures, 1));
    db.catalogue
        .import(JOB, vec![image(0), image(1)], whole("b.tar", 2, Vec::new()))
        .await
        .unwrap();
    let row = db.catalogue.job(JOB).await.unwrap().unwrap();
    assert_eq!((row.state, row.done, row.failed), (JobState::Done, 2, 0));
    assert!(row.digest.is_some());
    db.is_sound().await;
}

#[tokio::test]
async fn a_deleted_import_leaves_nothing_and_keeps_what_the_packs_hold() {
    let db = Fixture::new().await;
    // The same images, rendered here: their bytes are in the packs.
    db.job("job_here", "reef", 2, 2).await;
    db.catalogue.insert_job(new_job(JOB, 2)).await.unwrap();
    let images = (0..2).map(|frame| db.image("job_here", frame, 0)).collect();
    db.catalogue.import(JOB, images, shard(0, "a.tar")).await.unwrap();
    db.catalogue.delete_job(JOB).await.unwrap();
    let late = db.catalogue.import(JOB, Vec::new(), shard(2, "b.tar")).await;
    assert!(matches!(late, Err(CatalogueError::NotFound { .. })), "{late:?}");
    while db.catalogue.sweep().await.unwrap() {}
    assert_eq!(db.counts().await["shards"], 0);
    assert!(db.catalogue.orphans(100).await.unwrap().is_empty());
    // The other way round a row of a set keeps no bytes in the packs.
    db.catalogue.insert_job(new_job(JOB, 2)).await.unwrap();
    let images = (0..2).map(|frame| db.image("job_here", frame, 0)).collect();
    db.catalogue.import(JOB, images, shard(0, "a.tar")).await.unwrap();
    db.catalogue.delete_job("job_here").await.unwrap();
    while db.catalogue.sweep().await.unwrap() {}
    assert_eq!(db.catalogue.orphans(100).await.unwrap().len(), 4);
    db.is_sound().await;
}
