//! How SQLite reads pages: from an index and in its order, without sorting and without reading everything.

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, Row};

use super::page::PageStatement;
use super::top_k::ImageKey;
use crate::query::columns::Columns;
use crate::query::cursor;
use crate::schema::backfill::add_columns;
use crate::schema::migrations::migrator;
use crate::types::ImageQuery;

fn columns() -> Columns {
    Columns::new(&["uiqm".to_owned(), "uciqe".to_owned()])
}

async fn empty() -> SqliteConnection {
    let mut connection = SqliteConnectOptions::new()
        .filename(":memory:")
        .connect()
        .await
        .unwrap();
    migrator().run(&mut connection).await.unwrap();
    add_columns(&mut connection, &columns()).await.unwrap();
    connection
}

/// The steps of the plan, one a line.
async fn plan(query: &ImageQuery) -> String {
    steps(&PageStatement::new(&columns(), query).unwrap()).await
}

async fn steps(statement: &PageStatement) -> String {
    let sql = format!("EXPLAIN QUERY PLAN {}", statement.sql.text);
    let statement = statement.sql.bound_to(sqlx::query(AssertSqlSafe(sql)));
    let steps = statement.fetch_all(&mut empty().await).await.unwrap();
    steps
        .iter()
        .map(|step| step.get::<String, _>("detail") + "\n")
        .collect()
}

fn of_dataset(filter: Option<&str>) -> ImageQuery {
    ImageQuery {
        dataset: Some("bay".to_owned()),
        filter: filter.map(str::to_owned),
        limit: 100,
        ..ImageQuery::default()
    }
}

fn behind(query: &ImageQuery) -> ImageQuery {
    let identity = PageStatement::new(&columns(), query).unwrap().identity;
    let place = serde_json::json!([null, "job_1", 7]);
    ImageQuery {
        cursor: Some(cursor::write(&identity, &place)),
        ..query.clone()
    }
}

#[tokio::test]
async fn pages_of_a_dataset_follow_its_index_whatever_the_filter() {
    for filter in [
        None,
        Some("uiqm > 0.8"),
        Some("hscm.uciqe > 0.5 and alpha between 0.2 and 0.6"),
        Some("water.style in ('muddy') and labels.run = 'a' and not failed"),
        Some("frame >= 10 and warned"),
    ] {
        let query = of_dataset(filter);
        for query in [behind(&query), query] {
            let plan = plan(&query).await;
            assert!(
                plan.contains("SEARCH images USING INDEX images_by_dataset (dataset=?"),
                "{plan}"
            );
            assert!(
                !plan.contains("TEMP B-TREE") && !plan.contains("SCAN images"),
                "{plan}"
            );
            assert!(!plan.contains("SCAN m") && !plan.contains("SCAN r"), "{plan}");
        }
    }
}

#[tokio::test]
async fn a_cursor_without_an_order_continues_inside_the_index() {
    let plan = plan(&behind(&of_dataset(None))).await;
    assert!(plan.contains("(dataset=? AND (job_id,frame)>(?,?))"), "{plan}");
}

#[tokio::test]
async fn pages_of_everything_follow_the_order_of_jobs_and_frames_without_sorting() {
    let query = ImageQuery {
        limit: 100,
        ..ImageQuery::default()
    };
    let first = plan(&query).await;
    assert!(
        first.contains("SCAN images USING INDEX sqlite_autoindex_images_1"),
        "{first}"
    );
    let next = plan(&behind(&query)).await;
    assert!(
        next.contains("SEARCH images USING INDEX sqlite_autoindex_images_1 ((job_id,frame)>(?,?))"),
        "{next}"
    );
    assert!(!first.contains("TEMP B-TREE") && !next.contains("TEMP B-TREE"));
}

#[tokio::test]
async fn images_found_by_the_replica_are_read_one_by_one() {
    let rows: Vec<ImageKey> = (0..101).map(|frame| ("job_1".into(), frame)).collect();
    for filter in [None, Some("uiqm > 0.8"), Some("water.style = 'muddy'")] {
        for order_by in [None, Some("-alpha".to_owned()), Some("uiqm".to_owned())] {
            let query = ImageQuery {
                order_by,
                ..of_dataset(filter)
            };
            let statement = PageStatement::of_rows(&columns(), &query, &rows).unwrap();
            let plan = steps(&statement).await;
            assert!(
                plan.contains("(dataset=? AND job_id=? AND frame=?)")
                    || plan.contains("(job_id=? AND frame=?)"),
                "{plan}"
            );
            assert!(!plan.contains("SCAN images"), "{plan}");
        }
    }
}

#[tokio::test]
async fn the_images_of_one_job_are_found_and_not_looked_for() {
    for filter in [
        "job = 'job_1'",
        "job = 'job_1' and frame between 5 and 9",
        "uiqm > 0.5 and job in ('a', 'b')",
    ] {
        for query in [
            of_dataset(Some(filter)),
            ImageQuery {
                dataset: None,
                ..of_dataset(Some(filter))
            },
        ] {
            let plan = plan(&query).await;
            assert!(plan.contains("job_id=?"), "{filter}: {plan}");
        }
    }
}

#[tokio::test]
async fn every_statement_that_stands_in_the_source_fits_the_schema() {
    let mut connection = empty().await;
    let mut checked = 0;
    let mut folders = vec![std::path::PathBuf::from("src")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path)
            } else {
                files.push(path)
            }
        }
    }
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        // Every other piece between quotes is a literal; escaped quotes occur only in statements about columns.
        let text = text.replace("\\\"", "`");
        for literal in text.split('"').skip(1).step_by(2) {
            // Literals with braces or without a complete statement are only parts.
            let whole = [
                ("SELECT ", " FROM "),
                ("INSERT ", " VALUES ("),
                ("UPDATE ", " SET "),
                ("DELETE ", " FROM "),
            ]
            .iter()
            .any(|(begin, middle)| literal.starts_with(begin) && literal.contains(middle));
            if !whole || literal.contains(['{', '}']) || literal.ends_with(' ') {
                continue;
            }
            let sql = format!("EXPLAIN {}", literal.replace('`', "\""));
            let fits = sqlx::query(AssertSqlSafe(sql)).fetch_all(&mut connection).await;
            assert!(fits.is_ok(), "{}: {literal}: {:?}", path.display(), fits.err());
            checked += 1;
        }
    }
    assert!(checked > 40, "only {checked} statements were found");
}
