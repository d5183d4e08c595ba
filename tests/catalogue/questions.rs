//! Histograms, columns and whole rows.

use std::collections::BTreeSet;

use catalogue::{CatalogueError, ImageQuery};
use serde_json::json;

use crate::fixture::Fixture;

#[tokio::test]
async fn a_histogram_counts_what_a_plain_loop_counts() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 300, 300).await;
    db.job("job_b", "cove", 5, 5).await;
    let got = db
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
    let none = db
        .catalogue
        .histogram("bay", None, "water.depth_m", 3, None)
        .await
        .unwrap();
    assert_eq!((none.missing, none.counts), (300, vec![0, 0, 0]));
}

#[tokio::test]
async fn what_has_no_histogram_is_refused_with_its_reason() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 1, 1).await;
    for (column, bins, range) in [
        ("uiqn", 3, None),
        ("water.style", 3, None),
        ("uiqm", 0, None),
        ("uiqm", 5000, None),
        ("uiqm", 3, Some((1.0, 1.0))),
        ("uiqm", 3, Some((f64::NAN, 1.0))),
        ("uiqm", 3, Some((f64::MIN, f64::MAX))),
    ] {
        let got = db.catalogue.histogram("bay", None, column, bins, range).await;
        assert!(
            matches!(got, Err(CatalogueError::Filter(_))),
            "{column} {bins} {range:?}"
        );
    }
    let nowhere = db.catalogue.histogram("nowhere", None, "uiqm", 3, None).await;
    assert!(matches!(nowhere, Err(CatalogueError::NotFound { .. })));
}

/// The statistics of numbers, by definition.
fn plainly(values: &[f64]) -> (u64, Option<f64>, Option<f64>, Option<f64>) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = values.len();
    let mean = (count > 0).then(|| values.iter().sum::<f64>() / count as f64);
    let median = (count > 0).then(|| (sorted[(count - 1) / 2] + sorted[count / 2]) / 2.0);
    (count as u64, mean, median, sorted.last().copied())
}

#[tokio::test]
async fn groups_by_columns_and_bins_have_the_statistics_of_a_plain_loop() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 300, 300).await;
    db.job("job_b", "bay", 2, 0).await;
    // One image without α, and one with an enhanced picture that was not measured.
    let mut records: Vec<_> = (0..300).map(|frame| synthetic::record("job_a", frame)).collect();
    for frame in 0..2 {
        let mut record = synthetic::record("job_b", frame);
        match frame {
            0 => drop(record.parameters.as_object_mut().unwrap().remove("alpha")),
            _ => drop(record.measurements.remove("hscm")),
        }
        db.catalogue.insert_image("job_b", &record, 0).await.unwrap();
        records.push(record);
    }
    let metrics = ["uiqm".to_owned(), "hscm.uiqm".to_owned()];
    let got = db
        .catalogue
        .grouped_stats("bay", &metrics, "water.optics, alpha:0.1", Some("frame < 250"));
    let got = got.await.unwrap();
    let widths: Vec<_> = got
        .by
        .iter()
        .flatten()
        .map(|by| (by.column.as_str(), by.width))
        .collect();
    assert_eq!(widths, [("water.optics", None), ("alpha", Some(0.1))]);

    let mut expected = Vec::new();
    for (subject, metric) in ["rgb", "hscm"].into_iter().zip(&metrics) {
        for optics in ["jerlov-1C", "jerlov-5C", "jerlov-9C"] {
            let bins = (0..10).map(|bin| Some((f64::from(bin) / 10.0, f64::from(bin + 1) / 10.0)));
            for bin in bins.chain([None]) {
                let members = records.iter().filter(|record| {
                    let alpha = record.parameters["alpha"].as_f64();
                    let fits = match (bin, alpha) {
                        (Some((low, high)), Some(alpha)) => low <= alpha && alpha < high,
                        (bin, alpha) => bin.is_none() && alpha.is_none(),
                    };
                    fits && record.frame < 250 && record.parameters["water"]["optics"]["preset"] == optics
                });
                let members: Vec<_> = members.collect();
                if members.is_empty() {
                    continue;
                }
                let values = members
                    .iter()
                    .filter_map(|record| record.measurements.get(subject)?.get("uiqm"));
                let values: Vec<f64> = values.copied().collect();
                let key = json!({"water.optics": optics, "alpha": bin.map(|(low, _)| low)});
                expected.push((key, metric.clone(), plainly(&values)));
            }
        }
    }
    let close = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() < 1e-12,
        (one, other) => one == other,
    };
    assert_eq!(got.groups.len(), expected.len());
    for (group, (key, metric, (count, mean, median, max))) in got.groups.iter().zip(&expected) {
        assert_eq!((&group.group, &group.metric, group.count), (key, metric, *count));
        assert!(
            close(group.mean, *mean) && close(group.median, *median),
            "{group:?}"
        );
        assert_eq!(group.max, *max, "{key}");
    }
    assert!(expected.iter().any(|(key, ..)| key["alpha"].is_null()));
}

#[tokio::test]
async fn groups_that_make_no_sense_are_refused_with_what_is_wrong() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 1100, 1100).await;
    let ask = async |by: &str| match db
        .catalogue
        .grouped_stats("bay", &["uiqm".to_owned()], by, None)
        .await
    {
        Err(CatalogueError::Filter(error)) => error.to_string(),
        other => panic!("{by}: {other:?}"),
    };
    for (by, said) in [
        ("alpah:0.1", "did you mean `alpha`?"),
        (
            "water.optics:2",
            "`by` names `water.optics`, which is not a column of numbers and has no bins",
        ),
        (
            "alpha:0",
            "`by` has the width `0` for the bins of `alpha`; must be a number above 0",
        ),
        ("alpha:-1", "has the width `-1`"),
        ("alpha:NaN", "has the width `NaN`"),
        ("alpha:inf", "has the width `inf`"),
        ("alpha:", "has the width ``"),
        ("alpha,alpha:0.5", "`by` names `alpha` twice"),
        ("frame", "more than 1000 groups"),
        (
            "seed,frame,alpha,job,dataset,digest,camera.width,camera.height,labels.run",
            "9 columns",
        ),
        ("", "unknown column"),
    ] {
        let message = ask(by).await;
        assert!(message.contains(said), "{by}: {message}");
    }
    let wide = db
        .catalogue
        .grouped_stats("bay", &["uiqm".to_owned()], "frame:500", None)
        .await
        .unwrap();
    let counts: Vec<_> = wide
        .groups
        .iter()
        .map(|group| (group.group["frame"].as_f64(), group.count))
        .collect();
    assert_eq!(
        counts,
        [(Some(0.0), 500), (Some(500.0), 500), (Some(1000.0), 100)]
    );
    let nowhere = db
        .catalogue
        .grouped_stats("nowhere", &["uiqm".to_owned()], "alpha", None)
        .await;
    assert!(matches!(nowhere, Err(CatalogueError::NotFound { .. })));
}

#[tokio::test]
async fn whole_rows_have_every_column_of_the_dataset_and_come_page_by_page() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 25, 25).await;
    let columns = db.catalogue.columns("bay").await.unwrap();
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
    assert_eq!(
        (scale.kind.as_str(), scale.unit.as_deref()),
        ("number", Some("degree"))
    );
    let mut query = ImageQuery {
        dataset: Some("bay".to_owned()),
        limit: 10,
        fields: names,
        ..ImageQuery::default()
    };
    let mut frames = Vec::new();
    loop {
        let page = db.catalogue.images(query.clone()).await.unwrap();
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
        db.catalogue
            .columns("nowhere")
            .await
            .unwrap()
            .iter()
            .all(|c| !c.name.starts_with("labels"))
    );
}

#[tokio::test]
async fn the_values_of_networks_are_filtered_sorted_and_listed() {
    let db = Fixture::new().await;
    let mut new = synthetic::job("job_a", "bay", 3, 1000);
    let mut description: serde_json::Value = serde_json::from_str(&new.spec).unwrap();
    description["metrics"] = json!(["uiqm", "net.judge"]);
    new.spec = description.to_string();
    new.spec_digest = spec::sha256(new.spec.as_bytes());
    db.catalogue.insert_job(new).await.unwrap();
    db.job("job_b", "bay", 2, 2).await;
    for frame in 0..3 {
        let mut record = synthetic::record("job_a", frame);
        for subject in ["rgb", "mine"] {
            let values = record.measurements.entry(subject.to_owned()).or_default();
            values.insert("net.judge".to_owned(), frame as f64 + 0.5);
        }
        db.catalogue.insert_image("job_a", &record, 2000).await.unwrap();
    }
    let query = ImageQuery {
        dataset: Some("bay".to_owned()),
        filter: Some("net.judge > 1".to_owned()),
        order_by: Some("-mine.net.judge".to_owned()),
        limit: 10,
        fields: vec!["frame".to_owned(), "mine.net.judge".to_owned()],
        ..ImageQuery::default()
    };
    let rows = db.catalogue.images(query.clone()).await.unwrap().items;
    let found: Vec<_> = rows
        .iter()
        .map(|row| (row["frame"].as_u64(), row["mine.net.judge"].as_f64()))
        .collect();
    assert_eq!(found, [(Some(2), Some(2.5)), (Some(1), Some(1.5))]);
    let unmeasured = ImageQuery {
        filter: Some("mine.net.judge is null".to_owned()),
        ..query
    };
    assert_eq!(db.catalogue.images(unmeasured).await.unwrap().items.len(), 2);
    let columns = db.catalogue.columns("bay").await.unwrap();
    for name in ["net.judge", "mine.net.judge"] {
        let column = columns.iter().find(|column| column.name == name);
        assert_eq!(
            column.map(|column| column.kind.as_str()),
            Some("number"),
            "{name}"
        );
    }
    let stats = db
        .catalogue
        .stats("bay", &["net.judge".to_owned()], None, None)
        .await;
    assert_eq!(json!(stats.unwrap())["groups"][0]["mean"], json!(1.5));
}
