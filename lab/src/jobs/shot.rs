//! One frame of a job, rendered and measured.

use std::collections::BTreeMap;

use cli::exit::Failure;
use imaging::{Rgb8, transfer};
use renderer::{Rendered, SceneSource};
use serde_json::{Value, json};
use spec::{Fidelity, Frame};

use super::column::{Column, Summary};
use super::view::{read_codes, view};
use crate::look;
use crate::measurement::difference;
use crate::parallel::run_all;
use crate::setup::Setup;
use crate::studio::{Studio, artifact, raster};
use serde::Deserialize;

/// A frame to render, and its measurements.
pub(super) struct Task {
    pub(super) case: String,
    pub(super) variant: String,
    pub(super) job: Value,
    pub(super) index: u64,
    pub(super) measure: Vec<Measure>,
    pub(super) runs: u64,
    pub(super) stages: Vec<String>,
    /// Artifacts on the sheet.
    pub(super) shown: Vec<String>,
}

/// The measurements of a frame.
pub(super) struct Shot {
    /// The site of the frame, which groups frames of a mix.
    pub(super) site: Option<String>,
    pub(super) columns: Vec<Column>,
    pub(super) tiles: Vec<(Vec<String>, Rgb8)>,
    picture: Option<Rgb8>,
}

/// Renders and measures all frames: one after the other if they are timed.
pub(super) fn take_all(tasks: &[Task], setup: &Setup, is_timed: bool) -> Result<Vec<Shot>, Failure> {
    // A style that cannot be read is reported once.
    drop(Studio::new(&setup.styles)?);
    let make_studio = || Studio::new(&setup.styles);
    let threads = if is_timed { Some(1) } else { None };
    let shots = run_all(
        "frames",
        threads,
        tasks,
        make_studio,
        |task, studio| match studio {
            Ok(studio) => task.take(studio),
            Err(_) => Err(Failure::input("the styles cannot be read")),
        },
    );
    shots.into_iter().collect()
}

/// Adds the differences of each frame to the same frame of the previous and of the last variant.
pub(super) fn compare(shots: &mut [Shot], variants: usize, count: usize) {
    for case in shots.chunks_mut(variants * count) {
        let pictures: Vec<Option<Rgb8>> = case.iter_mut().map(|shot| shot.picture.take()).collect();
        let last = (variants - 1) * count;
        for (place, shot) in case.iter_mut().enumerate() {
            let previous = place.checked_sub(count);
            for (name, other) in [("previous", previous), ("last", Some(last + place % count))] {
                let other = other.and_then(|other| pictures[other].as_ref());
                let pair = pictures[place].as_ref().zip(other);
                let (codes, delta_e) = pair.map_or((f64::NAN, f64::NAN), |(one, other)| {
                    let difference = difference(&transfer::decode_rgb8(one), &transfer::decode_rgb8(other));
                    (f64::from(difference.codes), difference.delta_e)
                });
                shot.columns
                    .push(Column::new(format!("codes to the {name}"), codes, Summary::Max));
                shot.columns
                    .push(Column::new(format!("ΔE to the {name}"), delta_e, Summary::Mean));
            }
        }
    }
}

impl Task {
    fn take(&self, studio: &mut Studio) -> Result<Shot, Failure> {
        let mut job = self.job.clone();
        let mut kinds = vec!["rgb".to_owned()];
        kinds.extend(self.shown.iter().cloned());
        for (measure, kind) in [
            (Measure::Photograph, "semantics"),
            (Measure::Look, "semantics.visible"),
            (Measure::Truth, "truth_report"),
        ] {
            kinds.extend(self.measure.contains(&measure).then(|| kind.to_owned()));
        }
        kinds.sort();
        kinds.dedup();
        job["artifacts"] = json!(kinds);
        job["metrics"] = json!([]);
        job["enhance"] = json!([]);
        let frame = studio.frame(&job, self.index)?;
        let (rendered, times) = self.render(studio, &frame)?;
        let mut columns = vec![Column::new("frames", 1.0, Summary::Count)];
        for measure in &self.measure {
            match measure {
                Measure::Time => columns.extend(self.list_times(&times)),
                Measure::Difference => {}
                Measure::Reference => columns.extend(measure_reference(studio, &frame)?),
                Measure::Truth => columns.extend(read_truth(&rendered)?),
                Measure::Look | Measure::Photograph => {
                    columns.extend(measure_look(&rendered, *measure)?);
                }
                Measure::Effects => columns.extend(list_effects(&rendered.record.plan)),
            }
        }
        let tile = |kind: &String| {
            let caption = [
                self.case.clone(),
                self.variant.clone(),
                kind.clone(),
                format!("frame {}", self.index),
            ];
            Ok((caption.to_vec(), view(&rendered, kind)?))
        };
        let needs_picture = self.measure.contains(&Measure::Difference);
        Ok(Shot {
            site: frame.site.as_ref().map(|site| site.name.clone()),
            columns,
            tiles: self.shown.iter().map(tile).collect::<Result<_, Failure>>()?,
            picture: match needs_picture {
                true => Some(raster(&rendered, "rgb")?.to_rgb8()),
                false => None,
            },
        })
    }

    /// Renders a frame several times; returns the least milliseconds of each stage.
    fn render(
        &self,
        studio: &mut Studio,
        frame: &Frame,
    ) -> Result<(Rendered, BTreeMap<String, f64>), Failure> {
        // A slot caches its last scene; another one in between forces a new measurement.
        let between = json!({"scene": {"kind": "procedural", "family": "structure", "seed": 0},
                             "camera": {"width": 8, "height": 8}, "metrics": []});
        let between = studio.frame(&between, 0)?;
        let mut rendered = studio.render(frame)?;
        let mut least = rendered.record.timings_ms.clone();
        for _ in 1..self.runs {
            studio.render(&between)?;
            rendered = studio.render(frame)?;
            for (stage, &ms) in &rendered.record.timings_ms {
                let known = least.entry(stage.clone()).or_insert(ms);
                *known = known.min(ms);
            }
        }
        Ok((rendered, least))
    }

    fn list_times(&self, times: &BTreeMap<String, f64>) -> Vec<Column> {
        if !self.stages.is_empty() {
            let stages = self.stages.iter().filter_map(|stage| times.get(stage));
            return vec![Column::new("ms", stages.sum(), Summary::Median)];
        }
        let stages = times.iter();
        stages
            .map(|(stage, &ms)| Column::new(format!("{stage}, ms"), ms, Summary::Median))
            .collect()
    }
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
        Column::new("bound", bound, Summary::Max),
        Column::new("error / bound", error.max / bound, Summary::Max),
    ])
}

/// The bias of the mean light of all channels against Monte Carlo, relative to the truth.
fn read_truth(rendered: &Rendered) -> Result<Vec<Column>, Failure> {
    let report: Value = serde_json::from_slice(artifact(rendered, "truth_report")?)
        .map_err(|error| Failure::Other(error.into()))?;
    let parts = &report["chain"]["all"];
    let blocks = ["smooth", "edges"].map(|part| parts[part].as_array().into_iter().flatten());
    let blocks: Vec<&Value> = blocks.into_iter().flatten().collect();
    let sum = |field: &str| -> f64 {
        let terms = blocks
            .iter()
            .filter_map(|block| Some(block["blocks"].as_f64()? * block[field].as_f64()?));
        terms.sum()
    };
    let bias = 100.0 * (sum("model") / sum("truth") - 1.0);
    let rms = median_of(&blocks, "relative_rms");
    Ok(vec![
        Column::new("median bias, %", bias, Summary::Median),
        Column::new("median absolute bias, %", bias.abs(), Summary::Median),
        Column::new(
            "within 10 %",
            f64::from(u8::from(bias.abs() <= 10.0)),
            Summary::Share,
        ),
        Column::new("rms of blocks, %", 100.0 * rms, Summary::Median),
    ])
}

fn median_of(blocks: &[&Value], field: &str) -> f64 {
    crate::statistics::median(blocks.iter().filter_map(|block| block[field].as_f64()))
}

fn measure_look(rendered: &Rendered, measure: Measure) -> Result<Vec<Column>, Failure> {
    let picture = raster(rendered, "rgb")?.to_rgb8();
    let labels = |kind| read_codes(artifact(rendered, kind)?);
    let values = match measure {
        Measure::Photograph => look::photograph(&picture, &labels("semantics")?),
        _ => look::lightness(&picture, &labels("semantics.visible")?),
    };
    let values = values.into_iter();
    Ok(values
        .map(|(name, value)| {
            let is_share = name.starts_with("structures brighter");
            let summary = if is_share { Summary::Share } else { Summary::Spread };
            Column::new(name, value.unwrap_or(f64::NAN), summary)
        })
        .collect())
}

/// Whether the plan added each effect with an estimated change; frames without the effect do not count.
fn list_effects(plan: &Value) -> Vec<Column> {
    let stages = plan.as_array().into_iter().flatten();
    let effect = |stage: &Value| {
        let note = stage["note"].as_str()?;
        let is_estimated = note.starts_with("changes ") || note.contains(", would change ");
        let is_added = f64::from(u8::from(note.starts_with("changes ")));
        is_estimated.then(|| {
            Column::new(
                stage["stage"].as_str().unwrap_or_default(),
                is_added,
                Summary::Share,
            )
        })
    };
    stages.filter_map(effect).collect()
}

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Measure {
    /// Milliseconds of the stages.
    Time,
    /// Differences of the codes to the previous and to the last variant.
    Difference,
    /// Error of the exposed light against the f64 reference.
    Reference,
    /// Bias against Monte Carlo.
    Truth,
    /// Statistics of the picture.
    Look,
    /// Features of photographs: spread, clipping, entropy, spectrum, grain.
    Photograph,
    /// Effects that the plan added.
    Effects,
}
