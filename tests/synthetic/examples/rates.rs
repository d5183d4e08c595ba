//! How fast a catalogue of many images is: `cargo run --release --workspace --example rates -- 1000000 [FOLDER]`.
//!
//! Prints commits per second for each tenth of the images, the time of pages and of counts, the bytes on the disk, and the
//! time of the deletion of it all. A folder that is named is kept and taken up again, and nothing of it is deleted.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use catalogue::{Catalogue, CatalogueError, ImageQuery};

/// Repetitions of each question.
const TIMES: usize = 200;

#[tokio::main]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let images: u64 = arguments.next().map_or(Ok(100_000), |text| text.parse())?;
    let kept = arguments.next().map(PathBuf::from);
    let temporary = tempfile::tempdir()?;
    let path = kept
        .as_deref()
        .unwrap_or(temporary.path())
        .join("catalogue.sqlite");
    let catalogue = Arc::new(Catalogue::open(&path, &synthetic::metrics()).await?);
    if catalogue.job("job_1").await?.is_none() {
        catalogue
            .insert_job(synthetic::job("job_1", "bay", images, 0))
            .await?;
        for part in 0..10 {
            let frames = images * part / 10..images * (part + 1) / 10;
            let (count, begun) = (frames.end - frames.start, Instant::now());
            synthetic::fill(&catalogue, "job_1", frames, 0).await?;
            let rate = count as f64 / begun.elapsed().as_secs_f64();
            println!("{:>9} images: {rate:.0} commits/s", images * (part + 1) / 10);
        }
    }
    println!("{} bytes an image", std::fs::metadata(&path)?.len() / images);
    submissions(&catalogue).await?;
    pages(&catalogue).await?;
    counts(&catalogue).await?;
    if kept.is_none() {
        deletion(&catalogue).await?;
    }
    Ok(())
}

/// How long the writer is held up by the deletion of the whole job, and how long all of it takes.
async fn deletion(catalogue: &Catalogue) -> Result<(), CatalogueError> {
    let begun = Instant::now();
    let gone = catalogue.delete_job("job_1").await?;
    println!(
        "hide {} images: {:.1} ms",
        gone.images,
        begun.elapsed().as_secs_f64() * 1e3
    );
    let (mut times, begun) = (Vec::new(), Instant::now());
    loop {
        let step = Instant::now();
        let more = catalogue.sweep().await?;
        times.push(step.elapsed());
        if !more {
            break;
        }
    }
    println!("take all rows away: {:.1} s", begun.elapsed().as_secs_f64());
    report("one step of that", times);
    Ok(())
}

async fn submissions(catalogue: &Catalogue) -> Result<(), CatalogueError> {
    let mut times = Vec::new();
    let now = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(0, |now| now.as_millis());
    for number in 0..TIMES {
        let id = format!("job_2_{now}_{number:05}");
        let begun = Instant::now();
        catalogue
            .insert_job(synthetic::job(&id, "cove", 10_000_000, 0))
            .await?;
        times.push(begun.elapsed());
    }
    report("submit a job", times);
    Ok(())
}

async fn pages(catalogue: &Catalogue) -> Result<(), CatalogueError> {
    let page = |filter: Option<&str>, order: Option<&str>, dataset: Option<&str>| ImageQuery {
        dataset: dataset.map(str::to_owned),
        filter: filter.map(str::to_owned),
        order_by: order.map(str::to_owned),
        limit: 100,
        ..ImageQuery::default()
    };
    for (name, query) in [
        ("default page", page(None, None, None)),
        ("page of a dataset", page(None, None, Some("bay"))),
        (
            "page with a filter",
            page(Some("uiqm > 0.5 and alpha < 0.5"), None, Some("bay")),
        ),
    ] {
        let (mut times, mut query) = (Vec::new(), query);
        for _ in 0..TIMES {
            let begun = Instant::now();
            query.cursor = catalogue.images(query.clone()).await?.next_cursor;
            times.push(begun.elapsed());
        }
        report(name, times);
    }
    let begun = Instant::now();
    catalogue.images(page(None, Some("-uiqm"), Some("bay"))).await?;
    println!(
        "best hundred by uiqm: {:.0} ms",
        begun.elapsed().as_secs_f64() * 1e3
    );
    Ok(())
}

async fn counts(catalogue: &Catalogue) -> Result<(), CatalogueError> {
    for (name, filter) in [
        ("two metrics", "uiqm > 0.5 and hscm.uciqe > 0.5"),
        ("two parameters", "alpha > 0.5 and water.style = 'muddy'"),
    ] {
        let begun = Instant::now();
        let histogram = catalogue.histogram("bay", Some(filter), "uiqm", 20, None).await?;
        let found: u64 = histogram.counts.iter().sum();
        println!(
            "histogram where {name}: {:.0} ms, {found} images",
            begun.elapsed().as_secs_f64() * 1e3
        );
    }
    let begun = Instant::now();
    catalogue
        .stats("bay", &["uiqm".to_owned()], Some("water.style"), None)
        .await?;
    println!(
        "statistics by style: {:.0} ms",
        begun.elapsed().as_secs_f64() * 1e3
    );
    Ok(())
}

fn report(name: &str, mut times: Vec<Duration>) {
    times.sort_unstable();
    let ms = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    println!("{name}: p50 {:.2} ms, p99 {:.2} ms", ms(0.5), ms(0.99));
}
