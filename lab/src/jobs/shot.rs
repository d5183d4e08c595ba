//! One frame of a job, rendered and measured.

use std::collections::BTreeMap;

use anyhow::Context;
use cli::exit::Failure;
use imaging::codec::{FilePlane, Radiance, decode_plane, decode_radiance};
use imaging::{Plane, Rgb8, transfer};
use renderer::{Rendered, SceneSource};
use serde_json::{Value, json};
use spec::{Fidelity, Frame};

use super::column::{Column, Summary};
use super::description::{Measure, Task};
use crate::measurement::difference;
use crate::statistics::median;
use crate::studio::{Studio, artifact, raster};
use crate::{ibla, look};

/// Milliseconds by stage.
type Times = BTreeMap<String, f64>;

/// The measurements of a frame.
pub(super) struct Shot {
    pub(super) site: Option<String>,
    pub(super) columns: Vec<Column>,
    /// Captions and pictures of the sheet.
    pub(super) tiles: Vec<(Vec<String>, Rgb8)>,
    picture: Rgb8,
}

/// Renders and measures a frame.
pub(super) fn take(task: &Task, studio: &mut Studio) -> Result<Shot, Failure> {
    let mut job = task.job.clone();
    let mut kinds = task.shown.clone();
    kinds.push("rgb".to_owned());
    for (measure, kind) in [
        (Measure::Photograph, "semantics"),
        (Measure::Look, "semantics.visible"),
        (Measure::Truth, "truth_report"),
    ] {
        kinds.extend(task.measure.contains(&measure).then(|| kind.to_owned()));
    }
    kinds.sort();
    kinds.dedup();
    job["artifacts"] = json!(kinds);
    (job["metrics"], job["enhance"]) = (json!([]), json!([]));
    let frame = studio.frame(&job, task.index)?;
    let (rendered, times) = render(task, studio, &frame)?;
    let picture = raster(&rendered, "rgb")?.to_rgb8();
    let mut columns = vec![Column::new("frames", 1.0, Summary::Count)];
    for measure in &task.measure {
        columns.extend(match measure {
            Measure::Difference => Vec::new(),
            Measure::Time => list_times(task, &times),
            Measure::Reference => measure_reference(studio, &frame)?,
            Measure::Truth => read_truth(&rendered)?,
            Measure::Look => {
                let visible = read_labels(&rendered, "semantics.visible")?;
                list_look(look::measure_lightness(&picture, &visible))
            }
            Measure::Photograph => {
                let semantics = read_labels(&rendered, "semantics")?;
                list_look(look::measure_photograph(&picture, &semantics))
            }
            Measure::Effects => list_effects(&rendered.record.plan),
            Measure::Model => list_model(rendered.record.optics.get("model")),
            Measure::Ibla => compare_ibla(&picture)?,
        });
    }
    let tiles = task.shown.iter().map(|kind| {
        let caption = [&task.case, &task.variant, kind, &format!("frame {}", task.index)];
        Ok((caption.map(String::clone).to_vec(), view(&rendered, kind)?))
    });
    Ok(Shot {
        site: frame.site.as_ref().map(|site| site.name.clone()),
        columns,
        tiles: tiles.collect::<Result<_, Failure>>()?,
        picture,
    })
}

/// Adds the differences of each frame to the same frame of the previous and of the last variant.
pub(super) fn compare(shots: &mut [Shot], variants: usize, count: usize) {
    for case in shots.chunks_mut(variants * count) {
        let light = case.iter().map(|shot| transfer::decode_rgb8(&shot.picture));
        let light: Vec<_> = light.collect();
        for (place, shot) in case.iter_mut().enumerate() {
            let last = (variants - 1) * count + place % count;
            for (name, other) in [("previous", place.checked_sub(count)), ("last", Some(last))] {
                let other = other.map(|other| difference(&light[place], &light[other]));
                let [codes, delta_e] = other.map_or([f64::NAN; 2], |d| [f64::from(d.codes), d.delta_e]);
                let codes = Column::new(format!("codes to the {name}"), codes, Summary::Max);
                let delta_e = Column::new(format!("ΔE to the {name}"), delta_e, Summary::Mean);
                shot.columns.extend([codes, delta_e]);
            }
        }
    }
}

/// Renders a frame several times; returns the least milliseconds of each stage.
fn render(task: &Task, studio: &mut Studio, frame: &Frame) -> Result<(Rendered, Times), Failure> {
    // A slot caches its last scene; another one in between forces a new measurement.
    let between = json!({"scene": {"kind": "procedural", "family": "structure", "seed": 0}, "camera": {"width": 8, "height": 8}});
    let between = studio.frame(&between, 0)?;
    let mut rendered = studio.render(frame)?;
    let mut least = rendered.record.timings_ms.clone();
    for _ in 1..task.runs {
        studio.render(&between)?;
        rendered = studio.render(frame)?;
        for (stage, &ms) in &rendered.record.timings_ms {
            let known = least.entry(stage.clone()).or_insert(ms);
            *known = known.min(ms);
        }
    }
    Ok((rendered, least))
}

/// The sum of the wanted stages, or each stage.
fn list_times(task: &Task, times: &Times) -> Vec<Column> {
    if task.stages.is_empty() {
        let columns = times.iter().map(|(stage, &ms)| (format!("{stage}, ms"), ms));
        return columns
            .map(|(name, ms)| Column::new(name, ms, Summary::Median))
            .collect();
    }
    let stages = task.stages.iter().filter_map(|stage| times.get(stage));
    vec![Column::new("ms", stages.sum(), Summary::Median)]
}

/// The largest error of the exposed light, and its share of the bound of the plan.
fn measure_reference(studio: &mut Studio, frame: &Frame) -> Result<Vec<Column>, Failure> {
    let planned = studio.linear(frame, frame.fidelity, &SceneSource::Local)?;
    let exact = studio.linear(frame, Fidelity::Reference, &SceneSource::Local)?;
    let error = difference(&planned.radiance, &exact.radiance);
    let bound = planned.plan.promise().map_or(f64::NAN, |promise| promise.bound);
    Ok(vec![
        Column::new("largest error", error.max, Summary::Max),
        Column::new("rms error", error.rmse, Summary::Mean),
        Column::new("error / bound", error.max / bound, Summary::Max),
    ])
}

/// The bias of the mean light of all channels against Monte Carlo, relative to the truth.
fn read_truth(rendered: &Rendered) -> Result<Vec<Column>, Failure> {
    let report: Value =
        serde_json::from_slice(artifact(rendered, "truth_report")?).context("the report of the truth")?;
    let parts = ["smooth", "edges"].map(|part| report["chain"]["all"][part].as_array());
    let blocks: Vec<&Value> = parts.into_iter().flatten().flatten().collect();
    let [truth, model] = ["truth", "model"].map(|field| {
        let pairs = blocks.iter().map(|block| [&block["blocks"], &block[field]]);
        let terms = pairs.filter_map(|[count, value]| Some(count.as_f64()? * value.as_f64()?));
        terms.sum::<f64>()
    });
    let rms = blocks.iter().filter_map(|block| block["relative_rms"].as_f64());
    let bias = 100.0 * (model / truth - 1.0);
    let is_near = f64::from(u8::from(bias.abs() <= 10.0));
    Ok(vec![
        Column::new("absolute bias, %", bias.abs(), Summary::Median),
        Column::new("bias, %", bias, Summary::Median),
        Column::new("within 10 %", is_near, Summary::Share),
        Column::new("rms of blocks, %", 100.0 * median(rms), Summary::Median),
    ])
}

fn read_labels(rendered: &Rendered, kind: &str) -> Result<Plane<u16>, Failure> {
    match decode_plane(artifact(rendered, kind)?).map_err(anyhow::Error::from)? {
        FilePlane::Codes(codes) => Ok(codes),
        FilePlane::Wide(_) | FilePlane::Floats(_) => {
            Err(anyhow::anyhow!("{kind} does not have codes of 16 bits").into())
        }
    }
}

fn list_look(values: look::Values) -> Vec<Column> {
    let columns = values.into_iter().map(|(name, value)| {
        let is_share = name == look::BRIGHTER;
        let summary = if is_share { Summary::Share } else { Summary::Spread };
        Column::new(name, value.unwrap_or(f64::NAN), summary)
    });
    columns.collect()
}

/// Whether the plan added each effect with an estimated change; frames without the effect do not count.
fn list_effects(plan: &Value) -> Vec<Column> {
    let stages = plan.as_array().into_iter().flatten();
    let effects = stages.filter_map(|stage| {
        let (name, note) = (stage["stage"].as_str()?, stage["note"].as_str()?);
        let is_added = note.starts_with("changes ");
        let is_estimated = is_added || note.contains(", would change ");
        is_estimated.then(|| Column::new(name, f64::from(u8::from(is_added)), Summary::Share))
    });
    effects.collect()
}

/// The share of the light with a measured model error, and that error.
fn list_model(model: Option<&Value>) -> Vec<Column> {
    let [covered, bias, rms] = ["covered", "bias", "rms"]
        .map(|name| 100.0 * model.and_then(|model| model[name].as_f64()).unwrap_or(f64::NAN));
    let is_covered = f64::from(u8::from(covered >= 90.0));
    vec![
        Column::new("covered, %", covered, Summary::Spread),
        Column::new("covered by 90 %", is_covered, Summary::Share),
        Column::new("model bias, %", bias, Summary::Median),
        Column::new("model rms, %", rms, Summary::Median),
    ]
}

fn compare_ibla(picture: &Rgb8) -> Result<Vec<Column>, Failure> {
    let found = ibla::compare(picture).map_err(anyhow::Error::from)?;
    let is_kept = f64::from(u8::from(found.is_kept));
    Ok(vec![
        Column::new("same candidates", is_kept, Summary::Share),
        Column::new("median distance", found.distance, Summary::Median),
        Column::new("95th percentile", found.distance, Summary::High),
        Column::new("largest", found.distance, Summary::Max),
        Column::new("matting, ms", found.ms[0], Summary::Median),
        Column::new("guided, ms", found.ms[1], Summary::Median),
    ])
}

/// An artifact as a picture; linear light is encoded.
fn view(rendered: &Rendered, kind: &str) -> Result<Rgb8, Failure> {
    match decode_radiance(artifact(rendered, kind)?).map_err(anyhow::Error::from)? {
        Radiance::Encoded(raster) => Ok(raster.to_rgb8()),
        Radiance::Linear(light) => Ok(transfer::encode_rgb8(&light).0),
    }
}
