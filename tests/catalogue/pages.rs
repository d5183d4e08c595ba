//! Pages: every row once and in order, whatever the order, the ties, the gaps, and what arrives meanwhile.

use catalogue::{CatalogueError, ImageQuery};
use serde_json::Value;

use crate::fixture::Fixture;

/// A catalogue in which `alpha` has ties and gaps, and `water.style` has ties and gaps.
async fn uneven() -> Fixture {
    let db = Fixture::new().await;
    for job in ["job_a", "job_b"] {
        db.catalogue
            .insert_job(synthetic::job(job, "bay", 100, 0))
            .await
            .unwrap();
        for frame in 0..40 {
            insert(&db, job, frame).await;
        }
    }
    db
}

async fn insert(db: &Fixture, job: &str, frame: u64) {
    let mut record = synthetic::record(job, frame);
    let parameters = record.parameters.as_object_mut().unwrap();
    match frame % 5 {
        0 => drop(parameters.remove("alpha")),
        step => drop(parameters.insert("alpha".to_owned(), (step as f64 / 4.0 - 0.5).into())),
    }
    if frame.is_multiple_of(3) {
        record.parameters["water"]
            .as_object_mut()
            .unwrap()
            .remove("style");
    }
    db.catalogue.insert_image(job, &record, frame).await.unwrap();
}

fn query(order: Option<&str>, limit: u32) -> ImageQuery {
    ImageQuery {
        dataset: Some("bay".to_owned()),
        order_by: order.map(str::to_owned),
        limit,
        fields: ["job", "frame", "alpha", "water.style", "uiqm"]
            .map(str::to_owned)
            .to_vec(),
        ..ImageQuery::default()
    }
}

async fn all(db: &Fixture, mut query: ImageQuery) -> Vec<Value> {
    let mut rows = Vec::new();
    loop {
        let page = db.catalogue.images(query.clone()).await.unwrap();
        assert!(page.items.len() <= query.limit as usize);
        rows.extend(page.items);
        query.cursor = page.next_cursor;
        if query.cursor.is_none() {
            return rows;
        }
    }
}

fn key(row: &Value) -> (String, u64) {
    (
        row["job"].as_str().unwrap().to_owned(),
        row["frame"].as_u64().unwrap(),
    )
}

/// The order that is promised: by the column, what has no value last, then by job and frame.
fn sorted(mut rows: Vec<Value>, order: Option<&str>) -> Vec<Value> {
    rows.sort_by(|a, b| {
        let Some(order) = order else {
            return key(a).cmp(&key(b));
        };
        let (name, descending) = order
            .strip_prefix('-')
            .map_or((order, false), |name| (name, true));
        let (x, y) = (a.get(name), b.get(name));
        let by_value = match (x, y) {
            (Some(x), Some(y)) => match (x.as_str(), y.as_str()) {
                (Some(x), Some(y)) => x.cmp(y),
                _ => x.as_f64().unwrap().total_cmp(&y.as_f64().unwrap()),
            },
            _ => std::cmp::Ordering::Equal,
        };
        let by_value = if descending { by_value.reverse() } else { by_value };
        x.is_none()
            .cmp(&y.is_none())
            .then(by_value)
            .then(key(a).cmp(&key(b)))
    });
    rows
}

const ORDERS: [Option<&str>; 8] = [
    None,
    Some("alpha"),
    Some("-alpha"),
    Some("water.style"),
    Some("-water.style"),
    Some("-uiqm"),
    Some("-frame"),
    Some("job"),
];

#[tokio::test]
async fn every_order_gives_every_row_once_whatever_the_size_of_a_page() {
    let db = uneven().await;
    for order in ORDERS {
        for limit in [1, 7, 79, 80, 1000] {
            let rows = all(&db, query(order, limit)).await;
            assert_eq!(rows.len(), 80, "{order:?} in pages of {limit}");
            assert_eq!(rows, sorted(rows.clone(), order), "{order:?} in pages of {limit}");
        }
    }
}

#[tokio::test]
async fn rows_that_arrive_between_two_pages_neither_repeat_nor_hide_others() {
    for order in ORDERS {
        let db = uneven().await;
        let before: Vec<_> = all(&db, query(order, 1000)).await.iter().map(key).collect();
        let (mut seen, mut asked, mut next) = (Vec::new(), query(order, 9), 40);
        loop {
            let page = db.catalogue.images(asked.clone()).await.unwrap();
            seen.extend(page.items.iter().map(key));
            asked.cursor = page.next_cursor;
            if asked.cursor.is_none() {
                break;
            }
            if next < 60 {
                insert(&db, "job_a", next).await;
                insert(&db, "job_b", 139 - next).await;
                next += 1;
            }
        }
        let mut once = seen.clone();
        once.sort();
        once.dedup();
        assert_eq!(once.len(), seen.len(), "{order:?} repeats a row");
        assert!(
            before.iter().all(|row| seen.contains(row)),
            "{order:?} hides a row"
        );
    }
}

#[tokio::test]
async fn a_cursor_of_another_question_or_a_changed_one_is_refused() {
    let db = uneven().await;
    let given = db
        .catalogue
        .images(query(Some("alpha"), 5))
        .await
        .unwrap()
        .next_cursor
        .unwrap();
    let with = |change: fn(&mut ImageQuery), cursor: &str| {
        let mut query = query(Some("alpha"), 5);
        query.cursor = Some(cursor.to_owned());
        change(&mut query);
        query
    };
    let changes: [fn(&mut ImageQuery); 4] = [
        |query| query.order_by = Some("-alpha".to_owned()),
        |query| query.order_by = None,
        |query| query.filter = Some("alpha > 0".to_owned()),
        |query| query.dataset = None,
    ];
    for change in changes {
        let refused = db.catalogue.images(with(change, &given)).await;
        assert!(matches!(refused, Err(CatalogueError::Cursor)));
    }
    for at_char in 0..given.len() {
        let mut forged = given.clone();
        let digit = if &given[at_char..=at_char] == "0" {
            "1"
        } else {
            "0"
        };
        forged.replace_range(at_char..=at_char, digit);
        let refused = db.catalogue.images(with(|_| {}, &forged)).await;
        assert!(matches!(refused, Err(CatalogueError::Cursor)), "{at_char}");
    }
    let of_jobs = db
        .catalogue
        .jobs(None, None, 1, None)
        .await
        .unwrap()
        .next_cursor
        .unwrap();
    for text in [
        of_jobs.as_str(),
        "",
        "x",
        "%00",
        &given.repeat(50),
        "ffffffffffffffff",
    ] {
        let refused = db.catalogue.images(with(|_| {}, text)).await;
        assert!(matches!(refused, Err(CatalogueError::Cursor)), "{text}");
        let refused = db.catalogue.scenes(1, Some(text.to_owned())).await;
        assert!(matches!(refused, Err(CatalogueError::Cursor)), "{text}");
    }
}
