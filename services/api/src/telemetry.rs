//! What the service counts about itself, in Prometheus' text form with base units.

use std::sync::OnceLock;

use axum::http::Method;
use catalogue::COMMIT_OPERATIONS;
use metrics::{counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};
use spec::FrameRecord;
use store::StoreStats;

/// From a cached read to a long-poll, in seconds.
const REQUEST_BUCKETS: [f64; 10] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 60.0];
/// From encoding a small picture to a large reference render, in seconds.
const STAGE_BUCKETS: [f64; 10] = [0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0];
/// From a thumbnail to the linear layers of a large frame.
const COMMIT_BUCKETS: [f64; 8] = [1e4, 3e4, 1e5, 3e5, 1e6, 1e7, 1e8, 5e8];
/// From one alone to a full transaction.
const OPERATIONS_BUCKETS: [f64; 10] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0];
/// A frame has about a dozen stages; a record that claims more is not worth a label for each.
const MAX_STAGES: usize = 32;

const REQUESTS: &str = "fathom_requests_total";
const REQUEST_SECONDS: &str = "fathom_request_seconds";
const SHED: &str = "fathom_requests_shed_total";
const COMMITTED: &str = "fathom_frames_committed_total";
const FAILED: &str = "fathom_frames_failed_total";
const GRANTED: &str = "fathom_leases_granted_total";
const STRIKES: &str = "fathom_lease_strikes_total";
const STAGE_SECONDS: &str = "fathom_stage_seconds";
const QUEUED: &str = "fathom_frames_queued";
const LEASED: &str = "fathom_frames_leased";
const ATTEMPTS: &str = "fathom_attempts_total";
const EXPIRED: &str = "fathom_leases_expired_total";
const QUEUE_AGE: &str = "fathom_queue_age_seconds";
const COMMIT_BYTES: &str = "fathom_commit_bytes";
const WAL_BYTES: &str = "fathom_wal_bytes";
const STORE_BYTES: &str = "fathom_store_bytes";
const STORE_BLOBS: &str = "fathom_store_blobs";
const STORE_PACKS: &str = "fathom_store_packs";

static EXPORTER: OnceLock<PrometheusHandle> = OnceLock::new();

/// Installs the process's recorder once; every service of the process writes to it.
pub(crate) fn install() -> &'static PrometheusHandle {
    EXPORTER.get_or_init(|| {
        let builder = PrometheusBuilder::new();
        let builder = buckets(builder, REQUEST_SECONDS, &REQUEST_BUCKETS);
        let builder = buckets(builder, STAGE_SECONDS, &STAGE_BUCKETS);
        let builder = buckets(builder, COMMIT_BYTES, &COMMIT_BUCKETS);
        let builder = buckets(builder, COMMIT_OPERATIONS, &OPERATIONS_BUCKETS);
        let recorder = builder.build_recorder();
        let handle = recorder.handle();
        if metrics::set_global_recorder(recorder).is_err() {
            tracing::warn!("this process already has a metrics recorder; /metrics stays empty");
        }
        describe();
        handle
    })
}

fn buckets(builder: PrometheusBuilder, name: &str, buckets: &[f64]) -> PrometheusBuilder {
    builder
        .set_buckets_for_metric(Matcher::Full(name.to_owned()), buckets)
        .expect("the bucket lists are not empty")
}

fn describe() {
    describe_counter!(REQUESTS, "Answered requests by method, route and status");
    describe_histogram!(REQUEST_SECONDS, "Time from a request's head to its answer's head");
    describe_counter!(
        SHED,
        "Requests answered 503 because all places of their kind were taken"
    );
    describe_counter!(COMMITTED, "Frames whose image was stored");
    describe_counter!(
        FAILED,
        "Attempts at frames that failed, by whether the frame is given up"
    );
    describe_counter!(GRANTED, "Leases given to workers");
    describe_counter!(
        STRIKES,
        "Frames that were alone on a lease that ended without an answer"
    );
    describe_histogram!(STAGE_SECONDS, "Time of a stage of a frame, from its record");
    describe_gauge!(QUEUED, "Frames of open jobs that wait for a worker");
    describe_gauge!(LEASED, "Frames that a worker holds");
    describe_counter!(ATTEMPTS, "Frames given to workers, each time that they were");
    describe_counter!(EXPIRED, "Leases that ran out without a word of their worker");
    describe_gauge!(QUEUE_AGE, "Seconds since the oldest open job was submitted");
    describe_histogram!(COMMIT_BYTES, "Bytes of the artifacts of a committed frame");
    describe_histogram!(
        COMMIT_OPERATIONS,
        "Images, jobs and changes of state that shared a transaction of the catalogue"
    );
    describe_gauge!(WAL_BYTES, "Bytes of the catalogue's write-ahead log");
    describe_gauge!(STORE_BYTES, "Bytes of the artifacts that can be read");
    describe_gauge!(
        STORE_BLOBS,
        "Artifacts that can be read, shared ones counted once"
    );
    describe_gauge!(STORE_PACKS, "Files that hold them");
}

pub(crate) fn request(method: &Method, route: &str, status: u16, seconds: f64) {
    // A client may invent methods; a label for each would grow without end.
    let method = match *method {
        Method::GET | Method::HEAD | Method::POST | Method::DELETE => method.as_str(),
        _ => "other",
    };
    let labels = [
        ("method", method.to_owned()),
        ("route", route.to_owned()),
        ("status", status.to_string()),
    ];
    counter!(REQUESTS, &labels).increment(1);
    histogram!(REQUEST_SECONDS, "route" => route.to_owned()).record(seconds);
}

pub(crate) fn shed(budget: &'static str) {
    counter!(SHED, "budget" => budget).increment(1);
}

/// A committed frame and its stages.
pub(crate) fn committed(record: &FrameRecord) {
    counter!(COMMITTED).increment(1);
    let bytes: u64 = record.artifacts.iter().map(|artifact| artifact.bytes).sum();
    histogram!(COMMIT_BYTES).record(bytes as f64);
    for (stage, ms) in record.timings_ms.iter().take(MAX_STAGES) {
        histogram!(STAGE_SECONDS, "stage" => stage.clone()).record(ms / 1e3);
    }
}

pub(crate) fn failed(given_up: bool) {
    counter!(FAILED, "given_up" => if given_up { "true" } else { "false" }).increment(1);
}

/// A lease given out, with this many frames.
pub(crate) fn granted(frames: usize) {
    counter!(GRANTED).increment(1);
    counter!(ATTEMPTS).increment(frames as u64);
}

/// Leases that ran out.
pub(crate) fn expired(leases: usize) {
    counter!(EXPIRED).increment(leases as u64);
}

pub(crate) fn strikes(count: usize) {
    counter!(STRIKES).increment(count as u64);
}

pub(crate) fn queue(queued: u64, leased: u64, age_ms: u64) {
    gauge!(QUEUE_AGE).set(age_ms as f64 / 1e3);
    gauge!(QUEUED).set(queued as f64);
    gauge!(LEASED).set(leased as f64);
}

pub(crate) fn stored(stats: &StoreStats, wal_bytes: u64) {
    gauge!(WAL_BYTES).set(wal_bytes as f64);
    gauge!(STORE_BYTES).set(stats.bytes as f64);
    gauge!(STORE_BLOBS).set(stats.blobs as f64);
    gauge!(STORE_PACKS).set(stats.packs as f64);
}
