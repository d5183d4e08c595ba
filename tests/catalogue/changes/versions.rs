//! Sealed versions: what they have stays, whatever becomes of their dataset.

use catalogue::{CatalogueError, ImageQuery, InsertImage, JobState, NewJob, UnixMs};
use spec::MerkleTree;

use crate::fixture::Fixture;

const NOW: UnixMs = UnixMs(9000);

fn root<'a>(leaves: impl IntoIterator<Item = &'a String>) -> String {
    let mut tree = MerkleTree::default();
    leaves.into_iter().for_each(|leaf| tree.push(leaf));
    tree.root()
}

fn job_root(of: &str, frames: u64) -> String {
    let digests: Vec<String> = (0..frames)
        .map(|frame| synthetic::record(of, frame).digest())
        .collect();
    root(&digests)
}

impl Fixture {
    /// A job with the images of another one's frames, and a description with this label.
    async fn made_of(&self, id: &str, of: &str, label: &str, frames: u64) {
        let spec = format!(r#"{{"dataset":"bay","labels":{{"of":"{label}"}}}}"#);
        let job = NewJob {
            spec_digest: spec::sha256(spec.as_bytes()),
            spec,
            ..synthetic::job(id, "bay", frames, 1000)
        };
        self.catalogue.insert_job(job).await.unwrap();
        for frame in 0..frames {
            let record = synthetic::record(of, frame);
            self.catalogue.insert_image(id, &record, 2000).await.unwrap();
        }
    }

    async fn frames_of(&self, dataset: &str) -> usize {
        let query = ImageQuery {
            dataset: Some(dataset.to_owned()),
            limit: 1000,
            ..ImageQuery::default()
        };
        self.catalogue.images(query).await.unwrap().items.len()
    }
}

#[tokio::test]
async fn the_root_follows_from_descriptions_and_images_whatever_the_jobs_are_called() {
    let db = Fixture::new().await;
    db.made_of("job_1", "a", "digest 4", 3).await;
    db.made_of("job_2", "b", "digest 3", 5).await;
    let (version, is_new) = db.catalogue.seal("bay", NOW).await.unwrap();
    assert!(is_new);
    assert_eq!(
        (version.name.as_str(), version.images, version.jobs),
        ("bay@1", 8, 2)
    );
    assert_eq!(version.code_versions, [env!("CARGO_PKG_VERSION")]);
    assert_eq!(version.root, root(&[job_root("b", 5), job_root("a", 3)]));
    let parts = db.catalogue.version_jobs("bay", 1).await.unwrap();
    let ids: Vec<_> = parts.iter().map(|part| (part.id.as_str(), part.images)).collect();
    assert_eq!(ids, [("job_2", 5), ("job_1", 3)]);
    assert_eq!(parts[0].description["dataset"], "bay");

    let other = Fixture::new().await;
    other.made_of("job_8", "b", "digest 3", 5).await;
    other.made_of("job_9", "a", "digest 4", 3).await;
    assert_eq!(
        other.catalogue.seal("bay", NOW).await.unwrap().0.root,
        version.root
    );
    let third = Fixture::new().await;
    third.made_of("job_8", "b", "digest 3", 5).await;
    third.made_of("job_9", "a", "digest 4", 2).await;
    assert_ne!(
        third.catalogue.seal("bay", NOW).await.unwrap().0.root,
        version.root
    );
}

#[tokio::test]
async fn a_version_stays_while_its_dataset_grows() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 4, 4).await;
    let (first, _) = db.catalogue.seal("bay", NOW).await.unwrap();
    let (again, is_new) = db.catalogue.seal("bay", NOW).await.unwrap();
    assert_eq!((&again, is_new), (&first, false), "nothing has changed");
    db.job("job_b", "bay", 3, 2).await;
    match db.catalogue.seal("bay", NOW).await {
        Err(CatalogueError::Transition { id, from, .. }) => assert_eq!((&*id, &*from), ("job_b", "running")),
        other => panic!("{other:?}"),
    }
    db.catalogue
        .set_state("job_b", JobState::Cancelled)
        .await
        .unwrap();
    let (second, is_new) = db.catalogue.seal("bay", NOW).await.unwrap();
    assert_eq!((second.version, second.images, is_new), (2, 6, true));
    assert_eq!(db.catalogue.versions("bay").await.unwrap(), [first, second]);

    assert_eq!(db.frames_of("bay@1").await, 4);
    assert_eq!((db.frames_of("bay@2").await, db.frames_of("bay").await), (6, 6));
    assert_eq!(db.frames_of("bay@3").await, 0);
    let metrics = ["uiqm".to_owned()];
    let stats = db.catalogue.stats("bay@1", &metrics, None, None).await.unwrap();
    assert_eq!(stats.groups[0].count, 4);
    let histogram = db
        .catalogue
        .histogram("bay@2", None, "uiqm", 1, None)
        .await
        .unwrap();
    assert_eq!(histogram.counts, [6]);
    assert_eq!(db.catalogue.dataset("bay@1").await.unwrap().unwrap().images, 4);
    let jobs = db
        .catalogue
        .jobs(Some("bay@1".to_owned()), None, 9, None)
        .await
        .unwrap();
    assert_eq!(jobs.items.len(), 1);
    assert!(
        db.catalogue
            .columns("bay@1")
            .await
            .unwrap()
            .iter()
            .any(|column| column.name == "labels.run")
    );
    let nowhere = db.catalogue.stats("bay@3", &metrics, None, None).await;
    assert!(matches!(nowhere, Err(CatalogueError::NotFound { .. })));
    assert_eq!(db.catalogue.dataset("bay@3").await.unwrap(), None);
}

#[tokio::test]
async fn nothing_changes_a_sealed_job_until_it_is_unsealed() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 2).await;
    db.give_up("job_a", 2).await;
    db.catalogue.seal("bay", NOW).await.unwrap();
    let sealed = |error: CatalogueError| match error {
        CatalogueError::Sealed { job, .. } => assert_eq!(job, "job_a"),
        other => panic!("{other:?}"),
    };
    sealed(db.catalogue.delete_job("job_a").await.unwrap_err());
    sealed(db.catalogue.delete_dataset("bay").await.unwrap_err());
    sealed(db.catalogue.retry_failed("job_a").await.unwrap_err());
    let late = db
        .catalogue
        .insert_image("job_a", &synthetic::record("job_a", 2), 0)
        .await;
    sealed(late.unwrap_err());
    let repeated = db
        .catalogue
        .insert_image("job_a", &synthetic::record("job_a", 1), 0)
        .await;
    assert_eq!(repeated.unwrap(), InsertImage::AlreadyThere);
    assert_eq!(db.frames_of("bay@1").await, 2);

    db.catalogue.unseal("bay", 1, NOW).await.unwrap();
    assert!(matches!(
        db.catalogue.unseal("bay", 1, NOW).await,
        Err(CatalogueError::NotFound { .. })
    ));
    assert_eq!(db.catalogue.version("bay", 1).await.unwrap(), None);
    db.catalogue.retry_failed("job_a").await.unwrap();
    synthetic::fill(&db.catalogue, "job_a", 2..3, 0).await.unwrap();
    // What was called `bay@1` once is never called so again.
    let (version, _) = db.catalogue.seal("bay", NOW).await.unwrap();
    assert_eq!((version.version, version.images), (2, 3));
    db.catalogue.unseal("bay", 2, NOW).await.unwrap();
    db.catalogue.delete_dataset("bay").await.unwrap();
    db.job("job_b", "bay", 1, 1).await;
    assert_eq!(db.catalogue.seal("bay", NOW).await.unwrap().0.version, 3);
    db.is_sound().await;
}

#[tokio::test]
async fn what_has_no_images_is_not_sealed() {
    let db = Fixture::new().await;
    assert!(matches!(
        db.catalogue.seal("bay", NOW).await,
        Err(CatalogueError::NotFound { .. })
    ));
    db.job("job_a", "bay", 3, 0).await;
    db.catalogue
        .set_state("job_a", JobState::Cancelled)
        .await
        .unwrap();
    assert!(matches!(
        db.catalogue.seal("bay", NOW).await,
        Err(CatalogueError::Unsealable { .. })
    ));
}
