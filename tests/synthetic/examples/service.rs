//! The rates of a service, measured over HTTP as its clients see them, for docs/science/speed.md:
//!
//! ```sh
//! cargo run --release -p synthetic --example service -- 1000000
//! ```
//!
//! The arguments are the number of images in the catalogue, and the folder to measure on, which must not exist and is removed
//! afterwards.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use ::client::{Client, JobRow, Page, encode};
use anyhow::Context;
use api::{Data, Service};
use catalogue::InsertJob;
use renderer::worker::client as worker;
use serde_json::{Value, json};
use store::Blob;
use style::Library;
use tokio::runtime::Runtime;
use wire::messages::{LeaseRequest, RegisterRequest};

/// Repetitions of single measurements.
const TIMES: usize = 500;
const DATASET: &str = "bench";
const TWO_METRICS: &str = "uiqm > 0.5 and uciqe > 0.3";

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let rows = arguments.next().map_or(Ok(1_000_000), |rows| rows.parse())?;
    let folder = arguments.next().map(PathBuf::from);
    let folder =
        folder.unwrap_or_else(|| std::env::temp_dir().join(format!("fathom-rates-{}", std::process::id())));
    anyhow::ensure!(
        !folder.exists(),
        "{} exists already; name a new folder",
        folder.display()
    );
    println!("| operation | times | p50, ms | p99, ms | target, p99 |\n|---|---|---|---|---|");
    let measured = measure(rows, &folder);
    std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    println!("\n{rows} images stored and as many frames waiting. {}", measured?);
    Ok(())
}

/// Prints a row of times in milliseconds.
fn print_times(operation: &str, target: &str, mut times: Vec<f64>) {
    times.sort_by(f64::total_cmp);
    let [middle, high] = [0.5, 0.99].map(|share| times[((times.len() - 1) as f64 * share).round() as usize]);
    println!(
        "| {operation} | {} | {middle:.2} | {high:.2} | {target} |",
        times.len()
    );
}

/// Milliseconds of a call.
fn time_once<R>(call: impl FnOnce() -> R) -> f64 {
    let begun = Instant::now();
    std::hint::black_box(call());
    begun.elapsed().as_secs_f64() * 1e3
}

fn measure(rows: u64, folder: &Path) -> anyhow::Result<String> {
    let runtime = Runtime::new().context("cannot start the asynchronous runtime")?;
    let commits = runtime.block_on(fill(rows, folder))?;
    print_times(
        "start of the service",
        "1000 ms",
        measure_starts(&runtime, folder)?,
    );
    let service = start(&runtime, folder)?;
    let server = format!("http://{}", service.address());
    let measured = measure_requests(&server);
    runtime.block_on(service.stop())?;
    measured.map(|()| commits)
}

/// Milliseconds until the service listens.
fn measure_starts(runtime: &Runtime, folder: &Path) -> anyhow::Result<Vec<f64>> {
    let mut times = Vec::new();
    for _ in 0..5 {
        let mut started = None;
        times.push(time_once(|| started = Some(start(runtime, folder))));
        if let Some(service) = started {
            runtime.block_on(service?.stop())?;
        }
    }
    Ok(times)
}

fn measure_requests(server: &str) -> anyhow::Result<()> {
    let client = Client::new(server, None);
    print_times("claim a frame", "5 ms", measure_claims(server)?);
    print_times(
        "submit a job, durable before the response",
        "25 ms",
        measure_submissions(&client)?,
    );
    for (name, filter) in [
        ("a default page of 100 images", ""),
        ("a page of 100 images with two metrics in the filter", TWO_METRICS),
    ] {
        print_times(name, "10 ms", measure_pages(&client, filter)?);
    }
    let path = format!(
        "/v1/datasets/{DATASET}/histogram?column=uiqm&bins=20&filter={}",
        encode(TWO_METRICS)
    );
    let counts = repeat(3, || Ok(client.get::<Value>(&path).map(drop)?))?;
    print_times("count all rows by two metrics", "", counts);
    Ok(())
}

/// Milliseconds of each of several calls.
fn repeat(count: usize, mut call: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<Vec<f64>> {
    let mut times = Vec::new();
    for _ in 0..count {
        let mut result = Ok(());
        times.push(time_once(|| result = call()));
        result?;
    }
    Ok(times)
}

/// Fills a catalogue with images and as many pending frames; returns the commit rates.
async fn fill(rows: u64, folder: &Path) -> anyhow::Result<String> {
    // The metrics of the service: otherwise its first start adds columns, and SQLite reads the whole table for each.
    let metrics = renderer::vocabulary(&Library::embedded()?, false).metrics;
    let data = Data::open(folder, &metrics).await?;
    let now = SystemTime::UNIX_EPOCH.elapsed();
    let now_ms = now.map_or(0, |now| now.as_millis() as u64);
    let job = synthetic::job("job_bench", DATASET, 2 * rows, now_ms);
    let inserted = data.catalogue.insert_job(job).await?;
    anyhow::ensure!(
        matches!(inserted, InsertJob::Created(_)),
        "the folder holds a job already"
    );
    let catalogue = Arc::new(data.catalogue);
    // The service needs a pack for the artifacts.
    let empty = Blob {
        digest: spec::sha256(b""),
        bytes: Vec::new(),
    };
    data.store.put_all(vec![empty]).await?;
    let (mut rates, step) = (Vec::new(), (rows / 100).max(1000));
    for start in (0..rows).step_by(step as usize) {
        let end = rows.min(start + step);
        let begun = std::time::Instant::now();
        synthetic::fill(&catalogue, "job_bench", start..end, now_ms).await?;
        rates.push((end - start) as f64 / begun.elapsed().as_secs_f64());
    }
    // The stored rows name another kind of machine.
    catalogue.mix_machines("job_bench", true).await?;
    catalogue.close().await;
    data.store.close().await;
    let last = rates[rates.len() - 1];
    rates.sort_by(f64::total_cmp);
    let median = rates[rates.len() / 2];
    Ok(format!(
        "Commits in groups: {median:.0} per second in the median, {last:.0} at the end; the target is 3000."
    ))
}

fn start(runtime: &Runtime, folder: &Path) -> anyhow::Result<Service> {
    let config = api::Config {
        data: folder.to_owned(),
        listen: ([127, 0, 0, 1], 0).into(),
        workers: 0,
        slots_per_worker: 1,
        program: PathBuf::new(),
        hosts: Vec::new(),
        token: None,
        styles: None,
        onnxruntime: None,
        library: Library::embedded().context("the embedded style models")?,
        stores: Vec::new(),
        engine: None,
        buckets: std::sync::Arc::new(|place, _| Err(api::Unread::Gone(place.set.clone()))),
        style_trial: Duration::from_secs(60),
        frame_limit: Duration::from_secs(600),
        prices: api::PriceLimits::default(),
        mix_workers: true,
        spot_check: 0,
    };
    Ok(runtime.block_on(api::start(config))?)
}

/// Claims one frame at a time, like a worker without cost estimates.
fn measure_claims(server: &str) -> anyhow::Result<Vec<f64>> {
    let client = worker::Client::new(server, None);
    let about = RegisterRequest {
        name: "bench".to_owned(),
        slots: 1,
        code_version: renderer::CODE_VERSION.to_owned(),
        onnx_runtime: None,
        cpu_features: renderer::cpu_features(),
        protocol: wire::VERSION,
    };
    let worker_id = client.register(&about)?.worker_id;
    let mut times = Vec::new();
    for _ in 0..TIMES {
        let request = LeaseRequest {
            worker_id: worker_id.clone(),
            wait_ms: 0,
            frame_ms: 0.0,
        };
        let mut lease = None;
        times.push(time_once(|| lease = Some(client.lease(&request))));
        let lease = lease.expect("it was requested")?;
        let token = lease.context("no lease while a frame waits")?.token;
        client.release(token, "bench")?;
    }
    Ok(times)
}

/// Submissions one after the other. Each is on the disk before its response.
fn measure_submissions(client: &Client) -> anyhow::Result<Vec<f64>> {
    let job = json!({"dataset": "other", "count": 1000, "seed": 1,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}}});
    let job = job.to_string();
    repeat(TIMES, || {
        Ok(client.post::<JobRow>("/v1/jobs", &[], job.as_bytes()).map(drop)?)
    })
}

/// Pages one after the other, without the time to parse them.
fn measure_pages(client: &Client, filter: &str) -> anyhow::Result<Vec<f64>> {
    let mut first = format!("/v1/images?dataset={DATASET}&limit=100");
    if !filter.is_empty() {
        first.push_str(&format!("&filter={}", encode(filter)));
    }
    let (mut times, mut path) = (Vec::new(), first.clone());
    for _ in 0..TIMES {
        let mut bytes = None;
        times.push(time_once(|| bytes = Some(client.get_bytes(&path))));
        let page: Page<Value> =
            serde_json::from_slice(&bytes.expect("it was requested")?).context("a page is JSON")?;
        let next = page.next_cursor.map(|cursor| format!("{first}&cursor={cursor}"));
        path = next.unwrap_or_else(|| first.clone());
    }
    Ok(times)
}
