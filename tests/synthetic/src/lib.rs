//! Synthetic image records to fill a catalogue in tests and benchmarks: shaped and sized like those of a real job, and
//! a function of their frame.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use catalogue::{Catalogue, CatalogueError, NewJob, UnixMs};
use serde_json::json;
use spec::{ArtifactEntry, Counts, FrameRecord, Provenance};
use tokio::task::JoinSet;

/// Commits in flight, as from some dozens of workers.
const AT_ONCE: u64 = 256;
const STYLES: [&str; 3] = ["atlantic", "mediterranean", "muddy"];
const WATERS: [&str; 3] = ["jerlov-1C", "jerlov-5C", "jerlov-9C"];
const METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];

/// A job to store before its images.
#[must_use]
pub fn job(id: &str, dataset: &str, frames: u64, now_ms: u64) -> NewJob {
    let spec = json!({"dataset": dataset, "count": frames, "seed": 42, "labels": {"run": id}, "site": "shaft",
                      "scene": {"kind": "procedural", "family": "shaft", "seed": {"int": [0, 1_000_000]}}});
    NewJob {
        id: id.to_owned(),
        dataset: dataset.to_owned(),
        spec: spec.to_string(),
        spec_digest: spec::sha256(spec.to_string().as_bytes()),
        frames,
        priority: 0,
        created_at: UnixMs(now_ms),
        idempotency: None,
        charge: None,
        set: None,
        again: false,
    }
}

/// The record of a frame of such a job.
#[must_use]
pub fn record(job: &str, frame: u64) -> FrameRecord {
    let share = |salt: u64| scrambled(frame, salt) as f64 / u64::MAX as f64;
    let bands = |salt: u64| json!([share(salt), share(salt + 1), share(salt + 2)]);
    let choice = |salt: u64| scrambled(frame, salt) as usize % 3;
    let parameters = json!({
        "frame": frame, "seed": 42, "alpha": share(1), "labels": {"run": job},
        "scene": {"kind": "procedural", "family": "shaft", "seed": scrambled(frame, 2) % 1_000_000},
        "camera": {"width": 768, "height": 492, "hfov_deg": 80.0},
        "water": {"optics": {"preset": WATERS[choice(3)]}, "range_scale": 0.5 + 1.5 * share(4),
                  "style": STYLES[choice(5)]},
        "lights": [{"kind": "haze", "x": share(6), "y": 1.0, "size": 0.2, "intensity": share(7), "color": [1, 1, 1]}],
        "enhance": ["hscm"], "metrics": METRICS, "artifacts": ["rgb", "range"],
        "fidelity": {"tolerance": 3e-4}, "encode": {"format": "png"}});
    let optics = json!({"absorption_per_m": bands(10), "scattering_per_m": bands(13),
        "beam_attenuation_per_m": bands(16), "backscatter_attenuation_per_m": bands(19),
        "diffuse_attenuation_per_m": bands(22), "veiling_light": bands(25), "g_per_m": bands(28)});
    let measured = |subject: u64| -> BTreeMap<String, f64> {
        let values = METRICS
            .iter()
            .zip(100..)
            .map(|(name, salt)| ((*name).to_owned(), share(salt + 100 * subject)));
        values.collect()
    };
    let artifact = |kind: &str, salt: u64| ArtifactEntry {
        kind: kind.to_owned(),
        digest: digest_like(job, 4 * frame + salt),
        bytes: 300_000 + scrambled(frame, salt) % 100_000,
        media_type: "image/png".to_owned(),
    };
    let stages = [
        "scene", "water", "style", "haze", "enhance", "measure", "encode", "total",
    ];
    FrameRecord {
        frame,
        parameters,
        optics: optics.as_object().cloned().unwrap_or_default(),
        promise: None,
        plan: json!({"forward_scatter": {"skipped": false, "terms": 8, "bound": 2.7e-4}, "style": {"skipped": false}}),
        measurements: BTreeMap::from([("rgb".to_owned(), measured(1)), ("hscm".to_owned(), measured(2))]),
        artifacts: vec![artifact("rgb", 1), artifact("range", 2)],
        counts: Counts {
            holes: scrambled(frame, 40) % 1000,
            ..Counts::default()
        },
        timings_ms: stages
            .iter()
            .zip(50..)
            .map(|(stage, salt)| ((*stage).to_owned(), 100.0 * share(salt)))
            .collect(),
        warnings: Vec::new(),
        scene: None,
        truth: None,
        provenance: Provenance {
            code_version: env!("CARGO_PKG_VERSION").to_owned(),
            cpu_features: "avx2,fma".to_owned(),
            ..Provenance::default()
        },
    }
}

/// Concurrently stores the images of these frames of an existing job.
///
/// # Errors
/// The first error of [`Catalogue::insert_image`].
pub async fn fill(
    catalogue: &Arc<Catalogue>,
    job: &str,
    frames: Range<u64>,
    now_ms: u64,
) -> Result<(), CatalogueError> {
    let mut tasks: JoinSet<Result<(), CatalogueError>> = JoinSet::new();
    for first in frames.start..frames.end.min(frames.start + AT_ONCE) {
        let (catalogue, job, end) = (Arc::clone(catalogue), job.to_owned(), frames.end);
        tasks.spawn(async move {
            for frame in (first..end).step_by(AT_ONCE as usize) {
                catalogue
                    .insert_image(&job, &record(&job, frame), now_ms + frame)
                    .await?;
            }
            Ok(())
        });
    }
    while let Some(ended) = tasks.join_next().await {
        ended.map_err(|error| CatalogueError::Failed {
            message: error.to_string(),
        })??;
    }
    Ok(())
}

/// Names of the metrics in the records.
#[must_use]
pub fn metrics() -> Vec<String> {
    METRICS.map(str::to_owned).to_vec()
}

/// Text like a SHA-256, different for each job and number.
fn digest_like(job: &str, number: u64) -> String {
    let seed = job
        .bytes()
        .fold(number, |hash, byte| scrambled(hash, u64::from(byte)));
    (0..4)
        .map(|part| format!("{:016x}", scrambled(seed, part)))
        .collect()
}

/// Steele, Lea, Flood (2014), SplitMix64: output number `salt` of the generator that starts at `value`.
fn scrambled(value: u64, salt: u64) -> u64 {
    let mut z = value.wrapping_add(salt.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
