//! Histograms, columns and whole rows.

use std::collections::BTreeSet;

use catalogue::{CatalogueError, ImageQuery};

use crate::fixture::Fixture;

#[tokio::test]
async fn a_histogram_counts_what_a_plain_loop_counts() {
    let at = Fixture::new().await;
    at.job("job_a", "bay", 300, 300).await;
    at.job("job_b", "cove", 5, 5).await;
    let got = at
        .catalogue
        .histogram("bay", Some("alpha > 0.5"), "uiqm", 7, Some((0.25, 0.75)))
        .await
        .unwrap();
    let values: Vec<f64> = (0..300)
        .map(|frame| synthetic::record("job_a", frame))
        .filter(|record| record.parameters["alpha"].as_f64().unwrap() > 0.5)
        .map(|record| record.measurements["rgb"]["uiqm"])
        .collect();
    let within = |low: f64, high: f64| values.iter().filter(|v| **v >= low && **v < high).count() as u64;
    let expected: Vec<u64> = got
        .edges
        .windows(2)
        .map(|pair| within(pair[0], pair[1]))
        .collect();
    assert_eq!(got.counts, expected);
    assert_eq!((got.below, got.missing), (within(-1.0, 0.25), 0));
    assert_eq!(
        got.counts.iter().sum::<u64>() + got.below + got.above,
        values.len() as u64
    );
    let none = at
        .catalogue
        .histogram("bay", None, "water.depth_m", 3, None)
        .await
        .unwrap();
    assert_eq!((none.missing, none.counts), (300, vec![0, 0, 0]));
}

#[tokio::test]
async fn what_has_no_histogram_is_refused_with_its_reason() {
    let at = Fixture::new().await;
    at.job("job_a", "bay", 1, 1).await;
    for (column, bins, range) in [
        ("uiqn", 3, None),
        ("water.style", 3, None),
        ("uiqm", 0, None),
        ("uiqm", 5000, None),
        ("uiqm", 3, Some((1.0, 1.0))),
        ("uiqm", 3, Some((f64::NAN, 1.0))),
        ("uiqm", 3, Some((f64::MIN, f64::MAX))),
    ] {
        let got = at.catalogue.histogram("bay", None, column, bins, range).await;
        assert!(
            matches!(got, Err(CatalogueError::Filter(_))),
            "{column} {bins} {range:?}"
        );
    }
    let nowhere = at.catalogue.histogram("nowhere", None, "uiqm", 3, None).await;
    assert!(matches!(nowhere, Err(CatalogueError::NotFound { .. })));
}

#[tokio::test]
async fn whole_rows_have_every_column_of_the_dataset_and_come_page_by_page() {
    let at = Fixture::new().await;
    at.job("job_a", "bay", 25, 25).await;
    let columns = at.catalogue.columns("bay").await.unwrap();
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    assert_eq!(
        names.iter().collect::<BTreeSet<_>>().len(),
        names.len(),
        "no name twice"
    );
    for expected in [
        "job",
        "alpha",
        "digest",
        "labels.run",
        "uiqm",
        "hscm.uiqm",
        "artifacts.range",
    ] {
        assert!(
            names.iter().any(|name| name == expected),
            "{expected} in {names:?}"
        );
    }
    let scale = columns
        .iter()
        .find(|column| column.name == "camera.hfov_deg")
        .unwrap();
    assert_eq!((scale.kind, scale.unit), ("number", Some("degree")));
    let mut query = ImageQuery {
        dataset: Some("bay".to_owned()),
        limit: 10,
        fields: names,
        ..ImageQuery::default()
    };
    let mut frames = Vec::new();
    loop {
        let page = at.catalogue.images(query.clone()).await.unwrap();
        for row in &page.items {
            let frame = row["frame"].as_u64().unwrap();
            let record = synthetic::record("job_a", frame);
            assert_eq!(row["artifacts.rgb"], record.artifacts[0].digest);
            assert_eq!(row["hscm.uiqm"], record.measurements["hscm"]["uiqm"]);
            assert_eq!(
                (&row["labels.run"], &row["digest"]),
                (&"job_a".into(), &record.digest().into())
            );
            frames.push(frame);
        }
        query.cursor = page.next_cursor;
        if query.cursor.is_none() {
            break;
        }
    }
    assert_eq!(frames, (0..25).collect::<Vec<_>>());
    assert!(
        at.catalogue
            .columns("nowhere")
            .await
            .unwrap()
            .iter()
            .all(|c| !c.name.starts_with("labels"))
    );
}
