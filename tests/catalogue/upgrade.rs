//! A catalogue of the first version under the program of today, and one of tomorrow.

use std::sync::Arc;

use catalogue::{Catalogue, CatalogueError, Idempotency, ImageQuery, InsertJob, JobState};
use serde_json::Value;

use crate::fixture::{Fixture, sabotage};

/// The database as text, made with the first migration and the columns that the first version added.
const FIRST: &str = include_str!("first.sql");

async fn opened() -> Fixture {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("catalogue.sqlite");
    // One of its images had a warning.
    let first = FIRST.replacen(r#""warnings":[]"#, r#""warnings":["odd"]"#, 1);
    sabotage(&path, &first).await;
    let catalogue = Catalogue::open(&path, &synthetic::metrics()).await.unwrap();
    Fixture {
        catalogue: Arc::new(catalogue),
        folder,
    }
}

#[tokio::test]
async fn rows_of_the_first_version_are_kept_and_found() {
    let db = opened().await;
    db.is_sound().await;
    let job = db.catalogue.job("job_old").await.unwrap().unwrap();
    assert_eq!((job.state, job.done, job.priority), (JobState::Running, 3, 0));
    let dataset = &db.datasets().await[0];
    assert_eq!((dataset.images, dataset.bytes, dataset.jobs), (3, job.bytes, 2));
    assert!(job.bytes > 1_000_000, "filled in by the upgrade");
    let results = db.catalogue.results("job_old", None, 10).await.unwrap().rows;
    assert_eq!(results.len(), 3);
    for image in results {
        let entry = &image["artifacts"][0];
        let frame = image["frame"].as_u64().unwrap();
        let named = db
            .catalogue
            .artifact("job_old", frame, "rgb")
            .await
            .unwrap()
            .unwrap();
        assert_eq!(entry["digest"], named.entry.digest);
        let page = db.catalogue.images(ImageQuery {
            filter: Some(format!(
                "alpha = {} and uiqm > 0 and frame = {frame}",
                image["parameters"]["alpha"]
            )),
            limit: 5,
            ..ImageQuery::default()
        });
        let page = page.await.unwrap();
        assert_eq!(page.items.len(), 1);
        assert_eq!(
            page.items[0]["labels.run"],
            Value::Null,
            "only when it is asked for"
        );
    }
    // Columns that came later are filled from the records, those of before are what they were.
    let later = ImageQuery {
        filter: Some(
            "seed = 42 and encode.format = 'png' and artifacts.count = 2 and camera.width = 768".to_owned(),
        ),
        limit: 5,
        fields: ["seed", "camera.width", "lights.count", "scene.seed"]
            .map(str::to_owned)
            .to_vec(),
        ..ImageQuery::default()
    };
    let later = db.catalogue.images(later).await.unwrap().items;
    assert_eq!(later.len(), 3);
    assert_eq!(
        (&later[0]["seed"], &later[0]["camera.width"]),
        (&Value::from(42), &Value::from(768))
    );
    assert_eq!(later[0]["lights.count"], 1);
    assert!(later[0]["scene.seed"].is_u64());
    let warned = |filter: &str| ImageQuery {
        filter: Some(filter.to_owned()),
        limit: 5,
        ..ImageQuery::default()
    };
    let page = db.catalogue.images(warned("warned")).await.unwrap();
    assert_eq!((page.items.len(), &page.items[0]["frame"]), (1, &Value::from(0)));
    assert_eq!(
        db.catalogue
            .images(warned("not warned"))
            .await
            .unwrap()
            .items
            .len(),
        2
    );
    assert_eq!(db.all_failures("job_sad").await.len(), 2);
}

#[tokio::test]
async fn work_of_the_first_version_goes_on() {
    let db = opened().await;
    let open = db.catalogue.open_jobs().await.unwrap();
    assert_eq!((open.len(), open[0].done.first()), (1, Some(&(0..3))));
    synthetic::fill(&db.catalogue, "job_old", 0..4, 5000)
        .await
        .unwrap();
    let done = db.catalogue.job("job_old").await.unwrap().unwrap();
    assert_eq!((done.state, done.done), (JobState::Done, 4));
    let rows = db.catalogue.images(ImageQuery {
        limit: 10,
        fields: vec!["digest".to_owned()],
        ..ImageQuery::default()
    });
    let rows = rows.await.unwrap().items;
    let digests: Vec<&str> = rows.iter().filter_map(|row| row["digest"].as_str()).collect();
    assert_eq!(done.digest, Some(spec::job_digest(digests)));
    let again = db.catalogue.retry_failed("job_sad").await.unwrap();
    assert_eq!((again.job.state, again.frames), (JobState::Queued, vec![0, 1]));
    let mut repeated = synthetic::job("job_new", "bay", 4, 0);
    repeated.idempotency = Some(Idempotency {
        owner: "me".to_owned(),
        key: "k".to_owned(),
        body_digest: "d".to_owned(),
    });
    let found = db.catalogue.insert_job(repeated).await.unwrap();
    assert!(matches!(found, InsertJob::Replayed(job) if job.id == "job_old"));
    db.catalogue.delete_job("job_old").await.unwrap();
    while db.catalogue.sweep().await.unwrap() {}
    db.is_sound().await;
    assert_eq!(db.counts().await["images"], 0);
}

#[tokio::test]
async fn a_catalogue_of_a_later_version_is_refused_and_left_alone() {
    let db = Fixture::new().await;
    db.sabotage(
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
         VALUES (9999, 'tomorrow', 1, x'00', 1)",
    )
    .await;
    let path = db.folder.path().join("catalogue.sqlite");
    match Catalogue::open(&path, &synthetic::metrics()).await.map(drop) {
        Err(error @ CatalogueError::Open { .. }) => {
            let text = error.to_string();
            assert!(text.contains("newer program") && text.contains("9999"), "{text}");
        }
        other => panic!("{other:?}"),
    }
}

#[tokio::test]
async fn what_is_no_catalogue_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("catalogue.sqlite");
    std::fs::write(&path, b"not a database at all, and long enough to be looked at").unwrap();
    let error = Catalogue::open(&path, &[]).await.err().unwrap();
    assert!(error.to_string().contains("catalogue.sqlite"), "{error}");
}
