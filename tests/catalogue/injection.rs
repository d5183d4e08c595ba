//! Text that tries to be SQL: it is a value, or it is refused.

use catalogue::{CatalogueError, ImageQuery};

use crate::fixture::Fixture;

const ATTEMPTS: [&str; 15] = [
    "'; DROP TABLE images; --",
    "\" OR 1=1 --",
    "1) OR (1=1",
    "x' OR 'a'='a",
    "uiqm\" FROM jobs --",
    "images.record",
    "(SELECT spec FROM jobs)",
    "rowid",
    "uiqm; DELETE FROM jobs",
    "uiqm/**/OR/**/1",
    "labels.x') OR 1=1 --",
    "labels.\"x\"",
    "rgb'--.uiqm",
    "artifacts.rgb' OR '1'='1",
    // Found by fuzzing: the NUL ended the path within the record.
    "labels.u\u{1}\0\0{",
];

fn asking() -> ImageQuery {
    ImageQuery {
        limit: 10,
        ..ImageQuery::default()
    }
}

#[tokio::test]
async fn as_a_value_it_is_only_compared() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 3).await;
    for attempt in ATTEMPTS {
        let quoted = attempt.replace('\\', "\\\\").replace('\'', "\\'");
        let filter = format!("water.style = '{quoted}'");
        let query = ImageQuery {
            filter: Some(filter.clone()),
            ..asking()
        };
        match db.catalogue.images(query).await {
            Ok(page) => assert!(page.items.is_empty(), "{filter}"),
            Err(error) => assert!(matches!(error, CatalogueError::Filter(_)), "{filter}: {error}"),
        }
        let query = ImageQuery {
            dataset: Some(attempt.to_owned()),
            ..asking()
        };
        assert!(db.catalogue.images(query).await.unwrap().items.is_empty());
        assert_eq!(db.catalogue.job(attempt).await.unwrap(), None);
        assert!(
            db.catalogue
                .jobs(Some(attempt.to_owned()), None, 5, None)
                .await
                .unwrap()
                .items
                .is_empty()
        );
        assert_eq!(db.catalogue.artifact("job_a", 0, attempt).await.unwrap(), None);
    }
    db.is_sound().await;
    assert_eq!(db.counts().await["images"], 3);
}

#[tokio::test]
async fn as_a_name_a_filter_or_an_order_it_is_refused_or_unknown() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 3, 3).await;
    for attempt in ATTEMPTS {
        let places = [
            ImageQuery {
                filter: Some(attempt.to_owned()),
                ..asking()
            },
            ImageQuery {
                filter: Some(format!("{attempt} = 1")),
                ..asking()
            },
            ImageQuery {
                filter: Some(format!("uiqm > 0 {attempt}")),
                ..asking()
            },
            ImageQuery {
                order_by: Some(attempt.to_owned()),
                ..asking()
            },
            ImageQuery {
                order_by: Some(format!("-{attempt}")),
                ..asking()
            },
            ImageQuery {
                fields: vec![attempt.to_owned()],
                ..asking()
            },
        ];
        for query in places {
            match db.catalogue.images(query.clone()).await {
                Err(CatalogueError::Filter(_)) => {}
                // Labels and kinds of artifacts may have any name; nothing has this one.
                Ok(page) => {
                    let open = ["labels.", "artifacts."]
                        .iter()
                        .any(|open| attempt.starts_with(open));
                    assert!(open && query.filter.is_none(), "{query:?}");
                    assert!(page.items.iter().all(|row| row.get(attempt).is_none()));
                }
                Err(other) => panic!("{query:?}: {other}"),
            }
        }
        let refused = db.catalogue.histogram("bay", None, attempt, 3, None).await;
        assert!(matches!(refused, Err(CatalogueError::Filter(_))), "{attempt}");
        let names = [attempt.to_owned()];
        let refused = db.catalogue.stats("bay", &names, None, None).await;
        assert!(matches!(refused, Err(CatalogueError::Filter(_))), "{attempt}");
    }
    db.is_sound().await;
    assert_eq!(db.counts().await["images"], 3);
}
