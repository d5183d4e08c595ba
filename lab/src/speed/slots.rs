//! Jobs on a number of slots.

use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use renderer::{Engine, local};
use serde_json::{Value, json};
use spec::Job;
use style::Library;

use crate::row;
use crate::statistics::median;
use crate::table::Table;

const STAGES: [&str; 5] = ["plan", "water", "encode", "metrics", "files"];
/// Frames rendered before the measurement, to fill buffers and caches.
const WARM_UP: usize = 8;

/// One job on a number of slots.
struct Speed {
    frames_per_s: f64,
    /// Processor time per frame, ms. Other programs disturb it less than wall-clock time.
    cpu_ms: f64,
    /// Share of the slots' time outside all stages: writing files, distributing frames, idle slots at the end.
    outside: f64,
    faults_per_frame: f64,
    /// Peak of the process, which never falls.
    peak_mb: f64,
    /// Median milliseconds of [`STAGES`].
    stages: [f64; 5],
}

/// Frames of two tolerances on one slot, two and all.
pub(super) fn measure(frames: usize) -> Result<[Table; 2], Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counts = vec![1, 2, cores];
    counts.retain(|&slots| slots <= cores);
    counts.dedup();
    let columns = [
        "tolerance",
        "slots",
        "frames/s",
        "times one slot",
        "CPU ms per frame",
        "times one slot by CPU",
        "outside the stages, %",
        "page faults per frame",
        "peak memory, MB",
    ];
    let mut slots_table = Table::new("slots", columns);
    let mut stages_table = Table::new("stages", ["tolerance", "slots"].into_iter().chain(STAGES));
    for (name, tolerance) in [("3e-4", 3e-4), ("1/255", 1.0 / 255.0)] {
        let mut first = None;
        for &slots in &counts {
            let speed = measure_job(frames, tolerance, slots)?;
            let [one_rate, one_cpu] = *first.get_or_insert([speed.frames_per_s, speed.cpu_ms]);
            slots_table.push(row![
                name,
                slots,
                speed.frames_per_s,
                speed.frames_per_s / one_rate,
                speed.cpu_ms,
                slots as f64 * one_cpu / speed.cpu_ms,
                100.0 * speed.outside,
                speed.faults_per_frame,
                speed.peak_mb,
            ]);
            let mut row = row![name, slots];
            row.extend(speed.stages.map(|ms| json!(ms)));
            stages_table.push(row);
        }
    }
    Ok([slots_table, stages_table])
}

fn measure_job(frames: usize, tolerance: f64, slots: usize) -> Result<Speed, Failure> {
    let library = Library::embedded().context("the embedded style models")?;
    let description = json!({
        "count": frames, "seed": 5, "scene": {"kind": "procedural", "family": "structure", "seed": 7},
        "camera": {"width": 768, "height": 492, "hfov_deg": 80},
        "water": {"optics": "jerlov-1C"}, "fidelity": {"tolerance": tolerance}, "artifacts": ["rgb"]
    });
    let vocabulary = renderer::vocabulary(&library, false);
    let job = Job::parse(description.to_string().as_bytes(), &vocabulary).context("the job")?;
    let engine = Arc::new(Engine::new(library, None));
    let folder = std::env::temp_dir().join(format!("fathom-speed-{}-{slots}", std::process::id()));
    let before = read_usage();
    let summary = local::render_job(&job, &engine, &folder, slots, |_| ());
    let after = read_usage();
    let text = std::fs::read_to_string(folder.join("records.jsonl"));
    std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    let summary = summary.map_err(Failure::input)?;
    let text = text.context("the records of the job")?;
    let records: Vec<Value> = text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect();
    let stages = records
        .iter()
        .filter_map(|record| record["timings_ms"].as_object())
        .flatten();
    let busy_ms: f64 = stages
        .filter(|(stage, _)| *stage != "total")
        .filter_map(|(_, ms)| ms.as_f64())
        .sum();
    let warm = &records[WARM_UP.min(records.len() / 2)..];
    let (seconds, count) = (
        summary.elapsed.as_secs_f64().max(1e-9),
        summary.frames.max(1) as f64,
    );
    Ok(Speed {
        frames_per_s: count / seconds,
        cpu_ms: (after.cpu_ms - before.cpu_ms) / count,
        outside: 1.0 - busy_ms / (seconds * 1e3 * slots as f64),
        faults_per_frame: (after.faults - before.faults) / count,
        peak_mb: after.peak_mb,
        stages: STAGES.map(|stage| {
            median(
                warm.iter()
                    .filter_map(|record| record["timings_ms"][stage].as_f64()),
            )
        }),
    })
}

/// Resource usage of this process so far.
struct Usage {
    faults: f64,
    cpu_ms: f64,
    peak_mb: f64,
}

/// Minor page faults, processor time and peak memory of this process; 0 if the system does not report them.
fn read_usage() -> Usage {
    const TICK_MS: f64 = 10.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The fields after the program name, which may contain spaces: state, six numbers, minor faults, three numbers, user ticks and
    // system ticks.
    let fields: Vec<f64> = stat
        .rsplit_once(')')
        .map_or("", |(_, fields)| fields)
        .split_whitespace()
        .map(|field| field.parse().unwrap_or(0.0))
        .collect();
    let field = |index: usize| fields.get(index).copied().unwrap_or(0.0);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = peak.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    Usage {
        faults: field(7),
        cpu_ms: (field(11) + field(12)) * TICK_MS,
        peak_mb: kib.unwrap_or(0.0) * 1024.0 / 1e6,
    }
}
