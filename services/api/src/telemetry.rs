//! What the service counts about itself, in Prometheus' text form with base units.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use axum::http::Method;
use metrics::{counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

/// From a cached read to a long-poll, in seconds.
const REQUEST_BUCKETS: [f64; 10] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 60.0];
/// From encoding a small picture to a large reference render, in seconds.
const STAGE_BUCKETS: [f64; 10] = [0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0];
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

static EXPORTER: OnceLock<PrometheusHandle> = OnceLock::new();

/// Installs the process's recorder once; every service of the process writes to it.
pub(crate) fn install() -> &'static PrometheusHandle {
    EXPORTER.get_or_init(|| {
        let builder = PrometheusBuilder::new();
        let builder = buckets(
            buckets(builder, REQUEST_SECONDS, &REQUEST_BUCKETS),
            STAGE_SECONDS,
            &STAGE_BUCKETS,
        );
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
}

pub(crate) fn request(method: &Method, route: &str, status: u16, seconds: f64) {
    // A client may invent methods; a label for each would grow without end.
    let method = match *method {
        Method::GET | Method::HEAD | Method::POST => method.as_str(),
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
pub(crate) fn committed(timings_ms: &BTreeMap<String, f64>) {
    counter!(COMMITTED).increment(1);
    for (stage, ms) in timings_ms.iter().take(MAX_STAGES) {
        histogram!(STAGE_SECONDS, "stage" => stage.clone()).record(ms / 1e3);
    }
}

pub(crate) fn failed(given_up: bool) {
    counter!(FAILED, "given_up" => if given_up { "true" } else { "false" }).increment(1);
}

pub(crate) fn granted() {
    counter!(GRANTED).increment(1);
}

pub(crate) fn strikes(count: usize) {
    counter!(STRIKES).increment(count as u64);
}

pub(crate) fn queue(queued: u64, leased: u64) {
    gauge!(QUEUED).set(queued as f64);
    gauge!(LEASED).set(leased as f64);
}
