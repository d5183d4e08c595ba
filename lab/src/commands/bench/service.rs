//! The rates of a service, measured over HTTP as its clients see them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use ::client::{JobRow, Page, encode};
use anyhow::Context;
use api::{Data, Service};
use catalogue::InsertJob;
use cli::exit::Failure;
use cli::progress::Progress;
use renderer::worker::client::Client;
use serde_json::{Value, json};
use store::Blob;
use style::Library;
use tokio::runtime::Runtime;
use wire::messages::{LeaseRequest, RegisterRequest};

use super::ServiceArguments;
use crate::machine;

/// Repetitions of single measurements.
const TIMES: usize = 500;
const DATASET: &str = "bench";
/// Design targets of the service on a local solid-state disk.
const TARGETS: &str = "targets: submit p99 <= 25 ms, claim p99 <= 5 ms, >= 3000 commits/s, page p99 <= 10 ms";

/// Runs the command.
pub(crate) fn run(arguments: &ServiceArguments) -> Result<(), Failure> {
    let folder = match &arguments.data {
        Some(folder) if folder.exists() => {
            return Err(Failure::BadInput(format!("{} exists already", folder.display())));
        }
        Some(folder) => folder.clone(),
        None => std::env::temp_dir().join(format!("fathom-bench-{}", std::process::id())),
    };
    let measured = measure(arguments.rows, &folder);
    std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    let lines = measured?;
    println!(
        "{}, {} rows, {}",
        machine::describe(),
        arguments.rows,
        disk(&folder)
    );
    lines.iter().for_each(|line| println!("{line}"));
    println!("{TARGETS}");
    Ok(())
}

fn measure(rows: u64, folder: &Path) -> Result<Vec<String>, Failure> {
    let runtime = Runtime::new().context("cannot start the asynchronous runtime")?;
    let mut lines = vec![runtime.block_on(fill(rows, folder))?];
    let (service, server) = start(&runtime, folder)?;
    let remote = ::client::Client::new(&server, None);
    let asked = || -> Result<Vec<String>, Failure> {
        Ok(vec![
            claims(&server)?,
            submissions(&remote)?,
            pages(&remote, "default page of 100", "")?,
            pages(
                &remote,
                "page of 100 with two metrics in the filter",
                "uiqm > 0.5 and uciqe > 0.3",
            )?,
            count(&remote)?,
        ])
    };
    let asked = asked();
    runtime.block_on(service.stop()).map_err(anyhow::Error::from)?;
    lines.extend(asked?);
    Ok(lines)
}

/// Fills a catalogue with images and as many pending frames; returns the commit rates.
async fn fill(rows: u64, folder: &Path) -> anyhow::Result<String> {
    let data = Data::open(folder, &synthetic::metrics()).await?;
    let now_ms = SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(0, |now| now.as_millis() as u64);
    let job = synthetic::job("job_bench", DATASET, 2 * rows, now_ms);
    anyhow::ensure!(
        matches!(data.catalogue.insert_job(job).await?, InsertJob::Created(_)),
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
    let mut from = 0;
    while from < rows {
        let to = rows.min(from + step);
        let begun = Instant::now();
        synthetic::fill(&catalogue, "job_bench", from..to, now_ms).await?;
        rates.push((to - from) as f64 / begun.elapsed().as_secs_f64());
        from = to;
        progress.set(from);
    }
    progress.finish();
    catalogue.close().await;
    data.store.close().await;
    let (first, last) = (rates[0], rates[rates.len() - 1]);
    rates.sort_by(f64::total_cmp);
    let median = rates[rates.len() / 2];
    Ok(format!(
        "commits in groups: median {median:.0} a second ({first:.0} at first, {last:.0} at last)"
    ))
}

fn start(runtime: &Runtime, folder: &Path) -> Result<(Service, String), Failure> {
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
    let service = runtime
        .block_on(api::start(config))
        .map_err(|error| Failure::Other(error.into()))?;
    let server = format!("http://{}", service.address());
    Ok((service, server))
}

/// Claims one frame at a time, like a worker without cost estimates.
fn claims(server: &str) -> Result<String, Failure> {
    let client = Client::new(server, None);
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
        let begun = Instant::now();
        let lease = client.lease(&request).map_err(anyhow::Error::from)?;
        times.push(begun.elapsed());
        let token = lease.context("a frame waits and is not given")?.token;
        client.release(token, "bench").map_err(anyhow::Error::from)?;
    }
    Ok(report("claim of a frame", times))
}

/// Submissions one after the other. Each is on the disk before its response.
fn submissions(remote: &::client::Client) -> Result<String, Failure> {
    let job = json!({"dataset": "other", "count": 1000, "seed": 1,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}}});
    let job = job.to_string();
    let mut times = Vec::new();
    for _ in 0..TIMES {
        let begun = Instant::now();
        let _: JobRow = remote.post("/v1/jobs", &[], job.as_bytes())?;
        times.push(begun.elapsed());
    }
    Ok(report("submit a job", times))
}

fn pages(remote: &::client::Client, what: &str, filter: &str) -> Result<String, Failure> {
    let mut base = format!("/v1/images?dataset={DATASET}&limit=100");
    if !filter.is_empty() {
        base.push_str(&format!("&filter={}", encode(filter)));
    }
    let (mut times, mut path) = (Vec::new(), base.clone());
    for _ in 0..TIMES {
        let begun = Instant::now();
        let bytes = remote.get_bytes(&path)?;
        // Parsing on the client is not part of the measurement.
        times.push(begun.elapsed());
        let page: Page<Value> = serde_json::from_slice(&bytes).context("a page is JSON")?;
        path = page
            .next_cursor
            .map_or_else(|| base.clone(), |cursor| format!("{base}&cursor={cursor}"));
    }
    Ok(report(what, times))
}

/// Statistics of two metrics over every row.
fn count(remote: &::client::Client) -> Result<String, Failure> {
    let mut times = Vec::new();
    for _ in 0..3 {
        let begun = Instant::now();
        let path = format!(
            "/v1/datasets/{DATASET}/histogram?column=uiqm&bins=20&filter={}",
            encode("uiqm > 0.5 and uciqe > 0.3")
        );
        let _: Value = remote.get(&path)?;
        times.push(begun.elapsed());
    }
    Ok(report("count over all rows by two metrics", times))
}

fn report(name: &str, mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let ms = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize].as_secs_f64() * 1e3;
    format!(
        "{name}: p50 {:.2} ms, p99 {:.2} ms, {} times",
        ms(0.5),
        ms(0.99),
        times.len()
    )
}

/// The file system of a folder that may not exist any more.
fn disk(folder: &Path) -> String {
    let mounts = std::fs::read_to_string("/proc/mounts").unwrap_or_default();
    let parent: PathBuf = folder
        .parent()
        .unwrap_or(Path::new("/"))
        .canonicalize()
        .unwrap_or_default();
    let under = mounts.lines().filter_map(|line| {
        let mut words = line.split(' ');
        let (_, at, kind) = (words.next()?, words.next()?, words.next()?);
        parent.starts_with(at).then_some((at.len(), kind))
    });
    under
        .max()
        .map_or_else(|| "unknown file system".to_owned(), |(_, kind)| kind.to_owned())
}
