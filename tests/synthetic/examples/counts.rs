//! How fast images are counted: `cargo run --release --workspace --example counts -- 10000000 FOLDER`.
//!
//! Fills a catalogue by copying some images with other parameters and metrics, writes the mirror, and prints the time of each answer
//! from it, that of the tables alone, and the memory of the process. A folder that is filled is taken up again.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use catalogue::{Catalogue, Histogram2dColumns, REPLICA_ROWS};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, Row};

/// Images that are stored one by one; the others are copies of them.
const FIRST: u64 = 20_000;
/// Repetitions of each question.
const TIMES: usize = 40;

type Failure = Box<dyn std::error::Error>;

#[tokio::main]
async fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let images: u64 = arguments.next().map_or(Ok(1_000_000), |text| text.parse())?;
    let folder = arguments.next().ok_or("name a folder")?;
    std::fs::create_dir_all(&folder)?;
    let path = Path::new(&folder).join("catalogue.sqlite");
    let catalogue = Arc::new(Catalogue::open(&path, &synthetic::metrics()).await?);
    if catalogue.job("job_1").await?.is_none() {
        let begun = Instant::now();
        catalogue
            .insert_job(synthetic::job("job_1", "bay", images, 0))
            .await?;
        synthetic::fill(&catalogue, "job_1", 0..FIRST.min(images), 0).await?;
        copies(&path, images).await?;
        println!("{images} images in {:.0} s", begun.elapsed().as_secs_f64());
    }
    let (begun, mut files) = (Instant::now(), 0);
    while catalogue.replicate_some(REPLICA_ROWS).await? {
        files += 1;
    }
    println!(
        "{files} files of the mirror in {:.0} s",
        begun.elapsed().as_secs_f64()
    );
    questions(&catalogue).await?;
    let status = std::fs::read_to_string("/proc/self/status")?;
    let lines = status
        .lines()
        .filter(|line| line.starts_with("VmRSS") || line.starts_with("VmHWM"));
    lines.for_each(|line| println!("{line}"));
    Ok(())
}

/// Copies the first images until there are enough, each with values of its own where values vary.
async fn copies(path: &Path, images: u64) -> Result<(), Failure> {
    let options = SqliteConnectOptions::new().filename(path);
    let mut connection = options.pragma("synchronous", "OFF").connect().await?;
    let random = "abs(random() / 9.3e18)";
    for first in (FIRST..images).step_by(FIRST as usize) {
        let more = FIRST.min(images - first);
        for (table, varies) in [
            ("images", &["alpha", "water.range_scale"][..]),
            ("measurements", &["uiqm", "uciqe", "entropy"]),
        ] {
            let names = names(&mut connection, table).await?;
            let value = |name: &String| match name.as_str() {
                "frame" => format!("frame + {first}"),
                name if varies.contains(&name) => random.to_owned(),
                name => format!("\"{name}\""),
            };
            let into: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
            let values: Vec<String> = names.iter().map(value).collect();
            let only = if table == "measurements" {
                "AND subject = 'rgb'"
            } else {
                ""
            };
            let sql = format!(
                "INSERT INTO {table} ({}) SELECT {} FROM {table} WHERE job_id = 'job_1' AND frame < {more} {only}",
                into.join(", "),
                values.join(", ")
            );
            sqlx::query(AssertSqlSafe(sql)).execute(&mut connection).await?;
        }
    }
    for sql in [
        "UPDATE jobs SET done = frames, row_digest = NULL WHERE id = 'job_1'",
        "UPDATE datasets SET images = (SELECT done FROM jobs WHERE id = 'job_1'), row_digest = NULL WHERE name = 'bay'",
        // The next start gives the changed rows their digests.
        "INSERT INTO unfilled (column_name, filled_to) VALUES ('row_digest', -1)",
    ] {
        sqlx::query(sql).execute(&mut connection).await?;
    }
    Ok(connection.close().await?)
}

async fn names(connection: &mut SqliteConnection, table: &str) -> Result<Vec<String>, Failure> {
    let sql = AssertSqlSafe(format!("SELECT name FROM pragma_table_info('{table}')"));
    let rows = sqlx::query(sql).fetch_all(connection).await?;
    Ok(rows.iter().map(|row| row.get(0)).collect())
}

async fn questions(catalogue: &Catalogue) -> Result<(), Failure> {
    let filter = Some("alpha > 0.3 and water.style = \"muddy\"");
    let metrics = ["uiqm".to_owned()];
    let pair = |mean_of| Histogram2dColumns {
        x: "alpha",
        y: "uiqm",
        mean_of,
    };
    measured("histogram", async |also| {
        catalogue.histogram("bay", also, "uiqm", 40, None).await.map(drop)
    })
    .await;
    measured("histogram under a filter", async |also| {
        let filter = both(filter, also);
        catalogue
            .histogram("bay", filter.as_deref(), "uiqm", 40, None)
            .await
            .map(drop)
    })
    .await;
    measured("density", async |also| {
        catalogue
            .histogram_2d("bay", also, pair(None), 64)
            .await
            .map(drop)
    })
    .await;
    measured("density with the mean of a third", async |also| {
        let columns = pair(Some("water.range_scale"));
        catalogue.histogram_2d("bay", also, columns, 64).await.map(drop)
    })
    .await;
    measured("statistics", async |also| {
        catalogue.stats("bay", &metrics, None, also).await.map(drop)
    })
    .await;
    measured("statistics by water and bins of alpha", async |also| {
        let by = "water.optics,alpha:0.1";
        catalogue.grouped_stats("bay", &metrics, by, also).await.map(drop)
    })
    .await;
    Ok(())
}

fn both(one: Option<&str>, other: Option<&str>) -> Option<String> {
    let all: Vec<&str> = one.into_iter().chain(other).collect();
    (!all.is_empty()).then(|| all.join(" and "))
}

/// Asks often, and once so that the mirror cannot help.
async fn measured<E: std::fmt::Display>(name: &str, ask: impl AsyncFn(Option<&str>) -> Result<(), E>) {
    let mut times = Vec::with_capacity(TIMES);
    for _ in 0..TIMES {
        let begun = Instant::now();
        if let Err(error) = ask(None).await {
            println!("{name}: {error}");
        }
        times.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    let first = times[0];
    times.sort_by(f64::total_cmp);
    let begun = Instant::now();
    let alone = match ask(Some("digest is not null")).await {
        Ok(()) => format!("{:.0} ms", begun.elapsed().as_secs_f64() * 1e3),
        Err(error) => format!("{error}"),
    };
    let (half, most) = (times[TIMES / 2], times[TIMES - 1]);
    println!("{name}: p50 {half:.0} ms, most {most:.0} ms, first {first:.0} ms; tables alone: {alone}");
}
