//! Rates of rendering without a service: stages and slots, memory, kernels, and the lower bound set by memory traffic.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use lab::speed::{cache_use, copy_gb_per_s, miss_ms, traffic};
use renderer::Engine;
use serde_json::{Value, json};
use spec::Job;
use style::Library;

use super::RenderArguments;
use crate::machine;

const SIZE: (usize, usize) = (768, 492);
const STAGES: [&str; 6] = ["plan", "water", "haze", "encode", "metrics", "files"];
/// Tolerances of the jobs, by name.
const TOLERANCES: [(&str, f64); 2] = [("3e-4", 3e-4), ("1/255", 1.0 / 255.0)];
/// Frames rendered before the measurement, to fill buffers and caches.
const WARM_UP: usize = 8;

/// One job on a number of slots.
struct Measured {
    frames_per_s: f64,
    /// Median milliseconds by stage; `total` is the frame.
    ms: BTreeMap<String, f64>,
    /// Kernels of the three channels together.
    kernels: Vec<usize>,
    /// Processor time per frame, ms. Other programs disturb it less than wall-clock time.
    cpu_ms: f64,
    /// Share of the slots' time outside all stages: writing files, distributing frames, idle slots at the end.
    outside: f64,
    faults_per_frame: f64,
    peak_mb: f64,
}

/// Resource usage of this process so far.
struct Process {
    faults: u64,
    cpu_ms: f64,
}

/// Runs the command.
pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut text = format!(
        "# Speed of rendering\n\nWritten by `fathom-lab bench render`: {}. {} frames of {}x{} RGB for each row.\n\n## Slots\n\nA \
         procedural structure in `jerlov-1C`, no style, the default metrics, PNG; each slot prepares the scene and its kernels once.\n\n| tolerance | slots | \
         frames/s | times one slot | CPU ms a frame | times one slot by CPU | outside the stages | page faults a frame | peak memory |\n\
         |---|---|---|---|---|---|---|---|---|\n",
        machine::describe(),
        arguments.frames,
        SIZE.0,
        SIZE.1
    );
    let mut by_stage = String::new();
    for (name, tolerance) in TOLERANCES {
        let mut alone = None;
        let mut slots = vec![1, 2, cores];
        slots.retain(|&slots| slots <= cores);
        slots.dedup();
        for slots in slots {
            let measured = measure(arguments, tolerance, slots)?;
            let one: f64 = alone
                .as_ref()
                .map_or(measured.frames_per_s, |m: &Measured| m.frames_per_s);
            let total = measured.ms.get("total").copied().unwrap_or(f64::NAN);
            let cpu_one = alone.as_ref().map_or(measured.cpu_ms, |m: &Measured| m.cpu_ms);
            let _ = writeln!(
                text,
                "| {name} | {slots} | {:.1} | {:.2} | {:.1} | {:.2} | {:.1} % | {:.0} | {} |",
                measured.frames_per_s,
                measured.frames_per_s / one,
                measured.cpu_ms,
                slots as f64 * cpu_one / measured.cpu_ms,
                100.0 * measured.outside,
                measured.faults_per_frame,
                // The peak of a process never falls, so the second job would report that of the first.
                if name == TOLERANCES[0].0 {
                    format!("{:.0} MB", measured.peak_mb)
                } else {
                    "-".to_owned()
                }
            );
            println!(
                "{name} {slots} slots: {:.1} frames/s, {total:.1} ms a frame",
                measured.frames_per_s
            );
            if slots == cores {
                let first = alone.as_ref().unwrap_or(&measured);
                by_stage.push_str(&stages_table(name, first, &measured, cores));
            }
            alone.get_or_insert(measured);
        }
    }
    text.push_str(&by_stage);
    text.push_str(&kernels(arguments.frames as usize));
    files::write(&arguments.out.join("speed.md"), text.as_bytes())?;
    println!("{}", arguments.out.join("speed.md").display());
    Ok(())
}

/// Milliseconds of each stage on one slot and on all, with the time needed to move its bytes.
fn stages_table(name: &str, one: &Measured, all: &Measured, cores: usize) -> String {
    let samples = SIZE.0 * SIZE.1;
    let rates = [1, cores].map(|threads| copy_gb_per_s(samples, threads));
    let mut text = format!(
        "\n## Stages at {name}\n\nMilliseconds, median. The last columns are what a plain copy of as many bytes takes, \
         the floor of a frame that does nothing but move them; of forward scatter every frequency is counted, also those that are left \
         out. A copy runs at {:.1} GB/s on \
         one core and {:.1} GB/s on each of {cores}, over a dozen planes. Kernels of the three channels: {:?}.\n\n| stage | 1 slot \
         | {cores} slots | MB moved | floor, 1 slot | floor, {cores} slots |\n|---|---|---|---|---|---|\n",
        rates[0], rates[1], one.kernels
    );
    let scattered: f64 = one
        .kernels
        .iter()
        .map(|&kernels| traffic::forward_scatter(kernels))
        .sum();
    for stage in STAGES {
        let planes = match stage {
            "plan" => traffic::PLAN,
            "water" => traffic::ATTENUATION + scattered,
            "encode" => traffic::ENCODE,
            "metrics" => traffic::METRICS,
            "files" => traffic::FILES,
            _ => 0.0,
        };
        let bytes = planes * (samples * size_of::<f32>()) as f64;
        let ms = |measured: &Measured| measured.ms.get(stage).copied().unwrap_or(0.0);
        let _ = writeln!(
            text,
            "| {stage} | {:.2} | {:.2} | {:.0} | {:.2} | {:.2} |",
            ms(one),
            ms(all),
            bytes / 1e6,
            bytes / rates[0] / 1e6,
            bytes / rates[1] / 1e6
        );
    }
    text
}

/// Usage of the kernel cache.
fn kernels(frames: usize) -> String {
    let mut text = "\n## Kernels\n\nTransfer functions are kept by (kernel scale, frame size) within 64 MiB for each slot, the least \
                    recently used first out. Spans of scales are rounded outwards, so that similar frames share them. A slope from 1 to \
                    15 m; the range is scaled by 0.2 to 2.\n\n| job | frames | hits | misses | hit rate | most memory | ms of the water \
                    stage, median |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for used in cache_use(SIZE, frames) {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.0} % | {:.0} MB | {:.1} |",
            used.job,
            used.frames,
            used.hits,
            used.misses,
            100.0 * used.hits as f64 / (used.hits + used.misses).max(1) as f64,
            used.bytes as f64 / 1e6,
            used.ms
        );
    }
    text.push_str("\n| kernel scale, px | a miss, ms |\n|---|---|\n");
    for (gamma, ms) in miss_ms(SIZE, 15) {
        let _ = writeln!(text, "| {gamma} | {ms:.2} |");
    }
    text
}

fn measure(arguments: &RenderArguments, tolerance: f64, slots: usize) -> Result<Measured, Failure> {
    let library = Library::embedded().context("the embedded style models")?;
    let vocabulary = renderer::vocabulary(&library, false);
    let spec = json!({
        "count": arguments.frames, "seed": 5, "scene": {"kind": "procedural", "family": "structure", "seed": 7},
        "camera": {"width": SIZE.0, "height": SIZE.1, "hfov_deg": 80},
        "water": {"optics": "jerlov-1C"}, "fidelity": {"tolerance": tolerance}, "artifacts": ["rgb"]
    });
    let job = Job::parse(spec.to_string().as_bytes(), &vocabulary).context("the description of the job")?;
    let engine = Arc::new(Engine::new(library, None));
    let folder = std::env::temp_dir().join(format!("fathom-bench-{}-{slots}", std::process::id()));
    let before = process();
    let summary = renderer::local::render_job(&job, &engine, &folder, slots, |_| ());
    let after = process();
    let records = std::fs::read_to_string(folder.join("records.jsonl"));
    remove(&folder)?;
    let summary = summary.map_err(Failure::input)?;
    let records = records.context("the records of the job")?;
    let records = records
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let all: Vec<Value> = records.collect();
    let inside = |record: &Value| -> f64 {
        let stages = record["timings_ms"].as_object().into_iter().flatten();
        stages
            .filter(|(stage, _)| *stage != "total")
            .filter_map(|(_, ms)| ms.as_f64())
            .sum()
    };
    let busy: f64 = all.iter().map(inside).sum();
    let records = &all[WARM_UP.min(all.len() / 2)..];
    let median = |stage: &str| {
        let mut all: Vec<f64> = records
            .iter()
            .filter_map(|r| r["timings_ms"][stage].as_f64())
            .collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let plan = records
        .first()
        .and_then(|record| record["plan"].as_array())
        .cloned()
        .unwrap_or_default();
    let kernels = plan
        .iter()
        .filter_map(|note| Some(note["terms"].as_u64()? as usize))
        .collect();
    let of = |stage: &str| (stage.to_owned(), median(stage));
    Ok(Measured {
        frames_per_s: summary.frames as f64 / summary.elapsed.as_secs_f64().max(1e-9),
        ms: STAGES.into_iter().chain(["total"]).map(of).collect(),
        kernels,
        cpu_ms: (after.cpu_ms - before.cpu_ms) / summary.frames.max(1) as f64,
        outside: 1.0 - busy / (summary.elapsed.as_secs_f64() * 1e3 * slots as f64),
        faults_per_frame: after.faults.saturating_sub(before.faults) as f64 / summary.frames.max(1) as f64,
        peak_mb: peak_mb(),
    })
}

fn remove(folder: &PathBuf) -> Result<(), Failure> {
    Ok(std::fs::remove_dir_all(folder).with_context(|| format!("cannot remove {}", folder.display()))?)
}

/// Minor page faults and processor time of this process; 0 if the system does not report them.
fn process() -> Process {
    const TICK_MS: f64 = 10.0;
    let text = std::fs::read_to_string(Path::new("/proc/self/stat")).unwrap_or_default();
    // The fields after the program name, which may contain spaces: state, six numbers, minor faults, three numbers, user ticks and
    // system ticks.
    let behind = text.rsplit_once(')').map_or("", |(_, behind)| behind);
    let fields: Vec<&str> = behind.split_whitespace().collect();
    let field = |index: usize| fields.get(index).and_then(|f| f.parse::<u64>().ok()).unwrap_or(0);
    Process {
        faults: field(7),
        cpu_ms: (field(11) + field(12)) as f64 * TICK_MS,
    }
}

/// Peak memory of this process, megabytes.
fn peak_mb() -> f64 {
    let text = std::fs::read_to_string(Path::new("/proc/self/status")).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kib.unwrap_or(0.0) * 1024.0 / 1e6
}
