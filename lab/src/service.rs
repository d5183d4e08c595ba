//! The rates of a service, measured over HTTP as its clients see them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use ::client::{Client, JobRow, Page, encode};
use anyhow::Context;
use api::{Data, Service};
use catalogue::InsertJob;
use cli::exit::Failure;
use cli::progress::Progress;
use renderer::worker::client as worker;
use serde_json::{Value, json};
use store::Blob;
use style::Library;
use tokio::runtime::Runtime;
use wire::messages::{LeaseRequest, RegisterRequest};

use crate::measurement::time_once;
use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::statistics::{quantile, sorted};
use crate::table::Table;

/// The parameters of the service.
pub const PARAMETERS: &[Parameter] = &[Parameter::number(
    "rows",
    "1000000",
    [1000.0, 5e7],
    "images in the catalogue; as many frames wait",
)];
/// Repetitions of single measurements.
const TIMES: usize = 500;
const DATASET: &str = "bench";
const TWO_METRICS: &str = "uiqm > 0.5 and uciqe > 0.3";

/// Measures submissions, claims, commits, pages and counts over a catalogue of many rows. The input, if any, is the folder to measure
/// on, which must not exist and is removed afterwards.
///
/// # Errors
/// The folder exists, or the service fails.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let folder = match setup.inputs.first() {
        Some(folder) if folder.exists() => {
            return Err(Failure::BadInput(format!(
                "{} exists already; name a new folder",
                folder.display()
            )));
        }
        Some(folder) => folder.clone(),
        None => std::env::temp_dir().join(format!("fathom-service-{}", std::process::id())),
    };
    let rows = setup.number("rows") as u64;
    let mut table = Table::new(
        "service",
        ["operation", "times", "p50, ms", "p99, ms", "target, p99"],
    );
    let measured = measure(rows, &folder, &mut table);
    std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    let commits = measured?;
    let about = format!("{rows} images stored and as many frames waiting. {commits}; the target is 3000.");
    Ok(Report::new(about, vec![table]))
}

/// Adds a row of times in milliseconds.
fn push_times(table: &mut Table, operation: &str, target: &str, times: Vec<f64>) {
    let times = sorted(times);
    let [middle, high] = [0.5, 0.99].map(|share| quantile(&times, share));
    table.push(row![operation, times.len(), middle, high, target]);
}

fn measure(rows: u64, folder: &Path, table: &mut Table) -> Result<String, Failure> {
    let runtime = Runtime::new().context("cannot start the asynchronous runtime")?;
    let commits = runtime.block_on(fill(rows, folder))?;
    let service = start(&runtime, folder)?;
    let server = format!("http://{}", service.address());
    let measured = measure_requests(&server, table);
    runtime.block_on(service.stop()).map_err(anyhow::Error::from)?;
    measured.map(|()| commits)
}

fn measure_requests(server: &str, table: &mut Table) -> Result<(), Failure> {
    let client = Client::new(server, None);
    push_times(table, "claim a frame", "5 ms", measure_claims(server)?);
    push_times(
        table,
        "submit a job, durable before the response",
        "25 ms",
        measure_submissions(&client)?,
    );
    for (name, filter) in [
        ("a default page of 100 images", ""),
        ("a page of 100 images with two metrics in the filter", TWO_METRICS),
    ] {
        push_times(table, name, "10 ms", measure_pages(&client, filter)?);
    }
    let path = format!(
        "/v1/datasets/{DATASET}/histogram?column=uiqm&bins=20&filter={}",
        encode(TWO_METRICS)
    );
    let counts = repeat(3, || Ok(client.get::<Value>(&path).map(drop)?))?;
    push_times(table, "count all rows by two metrics", "", counts);
    Ok(())
}

/// Milliseconds of each of several calls.
fn repeat(count: usize, mut call: impl FnMut() -> Result<(), Failure>) -> Result<Vec<f64>, Failure> {
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
    let data = Data::open(folder, &synthetic::metrics()).await?;
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
    let mut progress = Progress::new("fill", "rows", rows);
    let (mut rates, step) = (Vec::new(), (rows / 100).max(1000));
    for start in (0..rows).step_by(step as usize) {
        let end = rows.min(start + step);
        let begun = std::time::Instant::now();
        synthetic::fill(&catalogue, "job_bench", start..end, now_ms).await?;
        rates.push((end - start) as f64 / begun.elapsed().as_secs_f64());
        progress.set(end);
    }
    progress.finish();
    catalogue.close().await;
    data.store.close().await;
    let last = rates[rates.len() - 1];
    let median = quantile(&sorted(rates), 0.5);
    Ok(format!(
        "Commits in groups: {median:.0} per second in the median, {last:.0} at the end"
    ))
}

fn start(runtime: &Runtime, folder: &Path) -> Result<Service, Failure> {
    let config = api::Config {
        data: folder.to_owned(),
        listen: ([127, 0, 0, 1], 0).into(),
        workers: 0,
        slots_per_worker: 1,
        worker_program: PathBuf::new(),
        hosts: Vec::new(),
        token: None,
        styles: None,
        onnxruntime: None,
        library: Library::embedded().context("the embedded style models")?,
        cluster_program: PathBuf::new(),
        stores: Vec::new(),
        engine: None,
        buckets: None,
        style_trial: Duration::from_secs(60),
        frame_limit: Duration::from_secs(600),
        // The rows stored first name another version.
        mix_workers: true,
        spot_check: 0,
    };
    runtime
        .block_on(api::start(config))
        .map_err(|error| Failure::Other(error.into()))
}

/// Claims one frame at a time, like a worker without cost estimates.
fn measure_claims(server: &str) -> Result<Vec<f64>, Failure> {
    let client = worker::Client::new(server, None);
    let about = RegisterRequest {
        name: "bench".to_owned(),
        slots: 1,
        code_version: renderer::CODE_VERSION.to_owned(),
        onnx_runtime: None,
        cpu_features: renderer::cpu_features(),
        protocol: wire::VERSION,
    };
    let worker_id = client.register(&about).map_err(anyhow::Error::from)?.worker_id;
    let mut times = Vec::new();
    for _ in 0..TIMES {
        let request = LeaseRequest {
            worker_id: worker_id.clone(),
            wait_ms: 0,
            frame_ms: 0.0,
        };
        let mut lease = None;
        times.push(time_once(|| lease = Some(client.lease(&request))));
        let lease = lease.expect("it was requested").map_err(anyhow::Error::from)?;
        let token = lease.context("no lease while a frame waits")?.token;
        client.release(token, "bench").map_err(anyhow::Error::from)?;
    }
    Ok(times)
}

/// Submissions one after the other. Each is on the disk before its response.
fn measure_submissions(client: &Client) -> Result<Vec<f64>, Failure> {
    let job = json!({"dataset": "other", "count": 1000, "seed": 1,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}}});
    let job = job.to_string();
    repeat(TIMES, || {
        Ok(client.post::<JobRow>("/v1/jobs", &[], job.as_bytes()).map(drop)?)
    })
}

/// Pages one after the other, without the time to parse them.
fn measure_pages(client: &Client, filter: &str) -> Result<Vec<f64>, Failure> {
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
