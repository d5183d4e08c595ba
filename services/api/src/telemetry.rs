//! Telemetry of the service, in Prometheus' text format with base units.

use std::sync::LazyLock;

use axum::http::Method;
use prometheus::{
    Gauge, Histogram, HistogramVec, IntCounter, IntCounterVec, IntGauge, TextEncoder, register_gauge,
    register_histogram, register_histogram_vec, register_int_counter, register_int_counter_vec,
    register_int_gauge,
};
use spec::FrameRecord;
use store::StoreStats;

/// From a cached read to a long poll, in seconds.
const REQUEST_BUCKETS: [f64; 10] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 60.0];
/// From encoding a small image to a large reference render, in seconds.
const STAGE_BUCKETS: [f64; 10] = [0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0];
/// From a thumbnail to the linear layers of a large frame.
const COMMIT_BUCKETS: [f64; 8] = [1e4, 3e4, 1e5, 3e5, 1e6, 1e7, 1e8, 5e8];
/// A frame has about a dozen stages; a record with more does not get a label for each.
const MAX_STAGES: usize = 32;

/// Declares the metrics of [`Telemetry`]: field, type, and registration.
macro_rules! telemetry {
    ($($field:ident: $Metric:ident = $register:ident($($argument:expr),+);)*) => {
        struct Telemetry {
            $($field: $Metric,)*
        }

        impl Telemetry {
            fn register() -> prometheus::Result<Self> {
                Ok(Self {
                    $($field: $register!($($argument),+)?,)*
                })
            }
        }
    };
}

/// Shared by every service of the process.
static TELEMETRY: LazyLock<Telemetry> =
    LazyLock::new(|| Telemetry::register().expect("the names are valid and differ"));

telemetry! {
    requests: IntCounterVec = register_int_counter_vec("fathom_requests_total",
        "Requests by method, route and status", &["method", "route", "status"]);
    request_seconds: HistogramVec = register_histogram_vec("fathom_request_seconds",
        "Time from the head of a request to the head of its response", &["route"], REQUEST_BUCKETS.to_vec());
    shed: IntCounterVec = register_int_counter_vec("fathom_requests_shed_total",
        "Requests rejected with 503 at the concurrency limit of their kind", &["budget"]);
    checked: IntCounterVec = register_int_counter_vec("fathom_frames_checked_total", "Spot-checked frames, by outcome", &["outcome"]);
    committed: IntCounter = register_int_counter("fathom_frames_committed_total", "Frames whose image was stored");
    commit_bytes: Histogram = register_histogram("fathom_commit_bytes",
        "Bytes of the artifacts of a committed frame", COMMIT_BUCKETS.to_vec());
    stage_seconds: HistogramVec = register_histogram_vec("fathom_stage_seconds",
        "Time of a stage of a frame, from its record", &["stage"], STAGE_BUCKETS.to_vec());
    failed: IntCounterVec = register_int_counter_vec("fathom_frames_failed_total",
        "Failed attempts, by whether the frame is quarantined", &["given_up"]);
    granted: IntCounter = register_int_counter("fathom_leases_granted_total", "Leases granted to workers");
    attempts: IntCounter = register_int_counter("fathom_attempts_total", "Frames leased to workers, repeats included");
    expired: IntCounter = register_int_counter("fathom_leases_expired_total", "Leases that expired without a heartbeat");
    strikes: IntCounter = register_int_counter("fathom_lease_strikes_total", "Single-frame leases that ended without a result");
    queued: IntGauge = register_int_gauge("fathom_frames_queued", "Queued frames of open jobs");
    leased: IntGauge = register_int_gauge("fathom_frames_leased", "Leased frames");
    queue_age_seconds: Gauge = register_gauge("fathom_queue_age_seconds", "Seconds since the oldest open job was submitted");
    wal_bytes: IntGauge = register_int_gauge("fathom_wal_bytes", "Bytes of the catalogue's write-ahead log");
    store_bytes: IntGauge = register_int_gauge("fathom_store_bytes", "Bytes of the stored artifacts");
    store_blobs: IntGauge = register_int_gauge("fathom_store_blobs", "Stored artifacts, shared ones counted once");
    store_packs: IntGauge = register_int_gauge("fathom_store_packs", "Pack files");
}

/// All metrics, including those of the catalogue.
///
/// # Errors
/// A metric that cannot be written.
pub(crate) fn render() -> prometheus::Result<String> {
    TextEncoder::new().encode_to_string(&prometheus::gather())
}

pub(crate) fn request(method: &Method, route: &str, status: u16, seconds: f64) {
    // A client may invent methods; a label for each would grow without limit.
    let method = match *method {
        Method::GET | Method::HEAD | Method::POST | Method::DELETE => method.as_str(),
        _ => "other",
    };
    let labels = [method, route, &status.to_string()];
    TELEMETRY.requests.with_label_values(&labels).inc();
    TELEMETRY
        .request_seconds
        .with_label_values(&[route])
        .observe(seconds);
}

pub(crate) fn shed(budget: &'static str) {
    TELEMETRY.shed.with_label_values(&[budget]).inc();
}

/// Counts a spot check.
pub(crate) fn checked(outcome: &'static str) {
    TELEMETRY.checked.with_label_values(&[outcome]).inc();
}

/// Counts a committed frame and its stages.
pub(crate) fn committed(record: &FrameRecord) {
    TELEMETRY.committed.inc();
    let bytes: u64 = record.artifacts.iter().map(|artifact| artifact.bytes).sum();
    TELEMETRY.commit_bytes.observe(bytes as f64);
    for (stage, ms) in record.timings_ms.iter().take(MAX_STAGES) {
        TELEMETRY
            .stage_seconds
            .with_label_values(&[stage])
            .observe(ms / 1e3);
    }
}

pub(crate) fn failed(given_up: bool) {
    let given_up = if given_up { "true" } else { "false" };
    TELEMETRY.failed.with_label_values(&[given_up]).inc();
}

/// Counts a lease and its frames.
pub(crate) fn granted(frames: usize) {
    TELEMETRY.granted.inc();
    TELEMETRY.attempts.inc_by(frames as u64);
}

pub(crate) fn expired(leases: usize) {
    TELEMETRY.expired.inc_by(leases as u64);
}

pub(crate) fn strikes(count: usize) {
    TELEMETRY.strikes.inc_by(count as u64);
}

pub(crate) fn queue(queued: u64, leased: u64, age_ms: u64) {
    TELEMETRY.queue_age_seconds.set(age_ms as f64 / 1e3);
    TELEMETRY.queued.set(queued as i64);
    TELEMETRY.leased.set(leased as i64);
}

pub(crate) fn stored(stats: &StoreStats, wal_bytes: u64) {
    TELEMETRY.wal_bytes.set(wal_bytes as i64);
    TELEMETRY.store_bytes.set(stats.bytes as i64);
    TELEMETRY.store_blobs.set(stats.blobs as i64);
    TELEMETRY.store_packs.set(stats.packs as i64);
}
