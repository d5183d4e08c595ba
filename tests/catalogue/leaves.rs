//! Columns of every leaf: large whole numbers, elements of lists, and images stored before a column was there.

use catalogue::ImageQuery;
use serde_json::{Value, json};
use spec::FrameRecord;

use crate::fixture::Fixture;

const SEEDS: [u64; 6] = [0, 1 << 53, (1 << 53) + 1, 1 << 63, u64::MAX - 1, u64::MAX];

/// A record with these values at JSON pointers of its parameters.
fn record(frame: u64, values: &[(&str, Value)]) -> FrameRecord {
    let mut record = synthetic::record("job_a", frame);
    for (pointer, value) in values {
        let (parent, field) = pointer.rsplit_once('/').unwrap();
        record.parameters.pointer_mut(parent).unwrap()[field] = value.clone();
    }
    record
}

async fn with_records(records: Vec<FrameRecord>) -> Fixture {
    let db = Fixture::new().await;
    db.job("job_a", "bay", records.len() as u64, 0).await;
    for record in records {
        db.catalogue.insert_image("job_a", &record, 1).await.unwrap();
    }
    db
}

async fn rows(db: &Fixture, filter: &str, order_by: &str, fields: &[&str]) -> Vec<Value> {
    let mut query = ImageQuery {
        filter: Some(filter.to_owned()),
        order_by: Some(order_by.to_owned()),
        limit: 2,
        fields: fields.iter().map(ToString::to_string).collect(),
        ..ImageQuery::default()
    };
    let mut rows = Vec::new();
    loop {
        let page = db.catalogue.images(query.clone()).await.unwrap();
        rows.extend(page.items);
        query.cursor = page.next_cursor;
        if query.cursor.is_none() {
            return rows;
        }
    }
}

#[tokio::test]
async fn seeds_of_64_bits_are_kept_compared_and_ordered_exactly() {
    // Not in the order of the frames.
    let frames = [3, 0, 5, 1, 4, 2];
    let records = (0..)
        .zip(frames)
        .map(|(frame, seed): (u64, usize)| record(frame, &[("/seed", json!(SEEDS[seed]))]));
    let db = with_records(records.collect()).await;
    let seeds = |rows: Vec<Value>| {
        rows.iter()
            .map(|row| row["seed"].as_u64().unwrap())
            .collect::<Vec<_>>()
    };
    let found = async |filter: String, order: &str| seeds(rows(&db, &filter, order, &["seed"]).await);
    assert_eq!(found(String::new(), "seed").await, SEEDS);
    let mut falling = SEEDS;
    falling.reverse();
    assert_eq!(found(String::new(), "-seed").await, falling);
    for seed in SEEDS {
        assert_eq!(found(format!("seed = {seed}"), "seed").await, [seed]);
        let below: Vec<_> = SEEDS.into_iter().filter(|other| *other < seed).collect();
        assert_eq!(found(format!("seed < {seed}"), "seed").await, below);
        let rest: Vec<_> = SEEDS.into_iter().filter(|other| *other != seed).collect();
        assert_eq!(found(format!("seed not in ({seed})"), "seed").await, rest);
    }
    assert_eq!(
        found(
            "seed between 9007199254740993 and 9223372036854775808".to_owned(),
            "seed"
        )
        .await,
        SEEDS[2..4]
    );
    assert_eq!(
        found("seed < 18446744073709551616 and seed > -1".to_owned(), "seed").await,
        SEEDS
    );
    assert!(
        found("seed = 9007199254740994".to_owned(), "seed")
            .await
            .is_empty()
    );
    let histogram = db
        .catalogue
        .histogram("bay", None, "seed", 2, None)
        .await
        .unwrap();
    assert_eq!((histogram.edges[0], histogram.edges[2]), (0.0, u64::MAX as f64));
    let stats = db
        .catalogue
        .stats("bay", &["uiqm".to_owned()], Some("seed"), None)
        .await
        .unwrap();
    let groups: Vec<_> = stats
        .groups
        .iter()
        .filter_map(|group| group.group.as_u64())
        .collect();
    assert!(SEEDS.iter().all(|seed| groups.contains(seed)), "{groups:?}");
}

#[tokio::test]
async fn leaves_are_found_under_their_own_names_and_under_those_of_before() {
    let snow = json!({"density_per_m3": 40.0, "radius_m": 0.001, "albedo": [0.1, 0.2, 0.3]});
    let lights = json!([{"kind": "spot", "position_m": [1.0, 2.0, 3.0], "intensity": [4.0, 5.0, 6.0], "cone_deg": 30.0}]);
    let path = json!({"frames": 9, "frame": 4, "sway_m": 0.25, "start": {"position_m": [1.0, 2.0, 3.0], "target_m": [0.0, 0.0, 0.0]}});
    let db = with_records(vec![
        record(0, &[]),
        record(1, &[
            ("/water/snow", snow),
            ("/water/holes", json!({"range_m": 12.0})),
            ("/water/optics", json!({"name": "quay", "absorption_per_m": [0.4, 0.2, 0.5], "forward_scatter": {"model": "jaffe"}})),
            ("/lights", lights),
            ("/camera/path", path),
            ("/encode", json!({"format": "jpeg", "quality": 80})),
        ]),
    ])
    .await;
    for filter in [
        "water.snow.density_per_m3 = 40",
        "snow.density_per_m3 = 40 and snow.albedo.b = 0.3",
        "water.snow.albedo.g between 0.1 and 0.3",
        "water.holes.range_m > 11 and water.holes is null",
        "water.optics = \"quay\" and water.optics.name = \"quay\" and water.optics.preset is null",
        "water.optics.absorption_per_m.r = 0.4",
        "water.optics.forward_scatter.model in ('jaffe')",
        "lights.0.position_m.y = 2 and lights.0.intensity.b = 6 and lights.0.intensity is null and lights.0.kind = 'spot'",
        "camera.path.frame = 4 and path.frame = 4 and camera.path.sway_m < 0.3 and camera.path.start.position_m.z = 3",
        "encode.format = 'jpeg' and encode.quality >= 80",
        "enhance.0 = 'hscm' and enhance.count = 1 and metrics.5 = 'uciqe' and artifacts.count = 2 and frame = 1",
    ] {
        let found = rows(&db, filter, "frame", &["frame"]).await;
        assert_eq!(found, [json!({"frame": 1})], "{filter}");
    }
    for order in ["failed", "-failed", "warned", "-snow.radius_m", "lights.0.kind"] {
        assert_eq!(rows(&db, "", order, &["frame"]).await.len(), 2, "{order}");
    }
    let all = db.catalogue.columns("bay").await.unwrap();
    let column = |name: &str| all.iter().find(|column| column.name == name).unwrap();
    assert_eq!(column("camera.path.sway_m").unit.as_deref(), Some("m"));
    assert_eq!(column("snow.radius_m").unit.as_deref(), Some("m"));
    assert_eq!(
        [column("seed").kind.as_str(), column("holes").kind.as_str()],
        ["number", "number"]
    );
}

#[tokio::test]
async fn columns_of_a_newer_program_are_filled_from_the_records_wherever_the_last_start_ended() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", 50, 50).await;
    let before = rows(&db, "", "frame", &[]).await;
    // As after a start that was killed behind the 20th image.
    db.sabotage(
        "INSERT INTO unfilled VALUES ('alpha', 20), ('seed - 2^63', 20), ('scene.kind', 20);
         UPDATE images SET alpha = NULL, \"seed - 2^63\" = NULL, \"scene.kind\" = NULL WHERE rowid > 20;
         UPDATE images SET alpha = 7 WHERE rowid = 5",
    )
    .await;
    let db = db.reopen().await;
    let seventh = ImageQuery {
        filter: Some("alpha = 7".to_owned()),
        limit: 2,
        ..ImageQuery::default()
    };
    let found = db.catalogue.images(seventh).await.unwrap();
    assert!(
        found.items.is_empty() && found.damaged.len() == 1,
        "it goes on, it does not begin again: {found:?}"
    );
    // As under a program that knew fewer columns.
    db.sabotage(
        "ALTER TABLE images DROP COLUMN alpha;
         ALTER TABLE images DROP COLUMN \"encode.format\";
         ALTER TABLE images DROP COLUMN \"water.range_scale\"",
    )
    .await;
    let db = db.reopen().await;
    assert_eq!(rows(&db, "", "frame", &[]).await, before);
    let filter = "encode.format = 'png' and water.range_scale > 0";
    assert_eq!(rows(&db, filter, "frame", &["frame"]).await.len(), 50);
    db.is_sound().await;
}

#[tokio::test]
async fn the_first_edge_of_a_histogram_over_seeds_is_the_least_seed() {
    let seeds = [5, u64::MAX].into_iter().zip(0..);
    let records = seeds.map(|(seed, frame)| record(frame, &[("/seed", json!(seed))]));
    let db = with_records(records.collect()).await;
    let histogram = db
        .catalogue
        .histogram("bay", None, "seed", 2, None)
        .await
        .unwrap();
    assert_eq!((histogram.edges[0], histogram.edges[2]), (5.0, u64::MAX as f64));
    assert_eq!(histogram.counts, [1, 1]);
}
