//! Cost estimates: typical figures at first, then means of the frames rendered here.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use spec::{ArtifactKind, Frame, FrameRecord};

/// Nanoseconds per pixel of each stage on one core of a server processor, 768×492, before any measurement; per lamp
/// for lamps.
const TYPICAL_NS: [(&str, f64); 16] = [
    ("scene", 90.0),
    ("plan", 2.0),
    ("turbidity", 20.0),
    ("lamps", 50.0),
    ("snow", 15.0),
    ("water", 300.0),
    ("style", 110.0),
    ("haze", 5.0),
    ("camera", 20.0),
    ("encode", 5.0),
    ("enhance", 20.0),
    ("metrics", 50.0),
    ("flow", 32.0),
    ("disparity", 32.0),
    ("right", 500.0),
    ("files", 75.0),
];
/// Bytes per pixel of each artifact kind: PNG of synthetic scenes, float32 NPY of the linear layers.
const TYPICAL_BYTES: [(&str, f64); 14] = [
    ("range", 0.6),
    ("instances", 0.02),
    ("snow_mask", 0.1),
    ("preview", 0.04),
    ("raw", 2.0),
    ("valid", 0.02),
    ("direct", 12.0),
    ("forward_scatter", 12.0),
    ("backscatter", 12.0),
    ("transmittance", 12.0),
    ("flow", 12.0),
    ("disparity", 12.0),
    ("truth", 24.0),
    ("clean", 1.0),
];
/// Bytes per pixel of other kinds: images.
const PICTURE_BYTES: f64 = 0.5;
/// Bytes of a frame's rows.
const ROW_BYTES: f64 = 6000.0;
/// Weight of the newest frame in the running means.
const NEWEST: f64 = 0.05;
/// Maximum learned kinds; a record with more is not worth the memory.
const MAX_KINDS: usize = 64;

/// Costs learned from rendered frames.
#[derive(Default)]
pub(crate) struct Costs(Mutex<Learned>);

#[derive(Default)]
struct Learned {
    stage_ns: BTreeMap<&'static str, f64>,
    kind_bytes: BTreeMap<String, f64>,
}

/// A frame of a job and its number of pixels.
pub(crate) struct Sized<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) pixels: f64,
}

/// The mean cost of some frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cost {
    /// Seconds of one slot.
    pub(crate) seconds: f64,
    pub(crate) bytes: f64,
}

impl Costs {
    /// Learns from a rendered frame.
    pub(crate) fn learn(&self, record: &FrameRecord) {
        let camera = &record.parameters["camera"];
        let (Some(width), Some(height)) = (camera["width"].as_f64(), camera["height"].as_f64()) else {
            return;
        };
        let pixels = (width * height).max(1.0);
        let lights = record.parameters["lights"].as_array();
        let lamps = lights
            .into_iter()
            .flatten()
            .filter(|light| light["kind"] != "haze")
            .count();
        let lamps = (lamps as f64).max(1.0);
        let mut learned = self.learned();
        for (stage, typical) in TYPICAL_NS {
            let units = if stage == "lamps" { lamps } else { 1.0 };
            // A skipped stage takes almost no time, which is not its cost.
            let ms = record.timings_ms.get(stage).copied().unwrap_or(0.0);
            let ns = ms * 1e6 / pixels / units;
            if ns > typical / 100.0 {
                mix(learned.stage_ns.entry(stage), ns);
            }
        }
        for artifact in &record.artifacts {
            if learned.kind_bytes.len() < MAX_KINDS || learned.kind_bytes.contains_key(&artifact.kind) {
                let kind = learned.kind_bytes.entry(artifact.kind.clone());
                mix(kind, artifact.bytes as f64 / pixels);
            }
        }
    }

    /// The mean over these frames.
    pub(crate) fn mean(&self, frames: &[Sized<'_>]) -> Cost {
        let learned = self.learned();
        let count = frames.len().max(1) as f64;
        let seconds: f64 = frames.iter().map(|sized| learned.seconds(sized)).sum();
        let bytes: f64 = frames.iter().map(|sized| learned.bytes(sized)).sum();
        Cost {
            seconds: seconds / count,
            bytes: bytes / count,
        }
    }

    fn learned(&self) -> MutexGuard<'_, Learned> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Learned {
    fn seconds(&self, Sized { frame, pixels }: &Sized<'_>) -> f64 {
        let stages = TYPICAL_NS.iter().filter(|(stage, _)| runs(frame, stage));
        let ns = stages.map(|(stage, typical)| {
            let units = if *stage == "lamps" { frame.lamp_count() } else { 1 };
            self.stage_ns.get(stage).unwrap_or(typical) * units as f64
        });
        ns.sum::<f64>() * pixels / 1e9 + traced_seconds(frame, *pixels)
    }

    fn bytes(&self, Sized { frame, pixels }: &Sized<'_>) -> f64 {
        let kinds = frame.artifacts.iter().map(ToString::to_string);
        kinds
            .map(|kind: String| {
                self.kind_bytes
                    .get(&kind)
                    .copied()
                    .unwrap_or_else(|| typical_bytes(&kind))
            })
            .sum::<f64>()
            * pixels
            + ROW_BYTES
    }
}

/// Whether the stage runs for this frame.
fn runs(frame: &Frame, stage: &str) -> bool {
    let water = &frame.water;
    match stage {
        "flow" => frame.artifacts.contains(&ArtifactKind::Flow),
        "disparity" => frame.artifacts.contains(&ArtifactKind::Disparity),
        "right" => frame.artifacts.contains(&ArtifactKind::RgbRight),
        "water" => water.optics.is_some(),
        "lamps" => frame.has_lamps(),
        "snow" => water.snow.is_some_and(|snow| snow.density_per_m3 > 0.0),
        "turbidity" => {
            water.optics.is_some() && water.turbidity.is_some_and(|patches| patches.contrast > 0.0)
        }
        "style" => water.style.is_some() && frame.alpha > 0.0,
        "haze" => !frame.haze().is_empty(),
        "enhance" => !frame.enhance.is_empty(),
        "metrics" => !frame.metrics.is_empty(),
        _ => true,
    }
}

fn typical_bytes(kind: &str) -> f64 {
    let known = TYPICAL_BYTES.iter().find(|(known, _)| *known == kind);
    known.map_or(PICTURE_BYTES, |(_, bytes)| *bytes)
}

/// Maximum nominal time of the Monte Carlo paths; 0 without an artifact that needs them.
fn traced_seconds(frame: &Frame, pixels: f64) -> f64 {
    let most = frame.truth.unwrap_or_default().most_paths(pixels as u64);
    match most {
        Ok((paths, _)) if frame.is_traced() => spec::truth::seconds(pixels as u64, paths),
        _ => 0.0,
    }
}

fn mix<K: Ord>(mean: std::collections::btree_map::Entry<'_, K, f64>, newest: f64) {
    mean.and_modify(|mean| *mean += NEWEST * (newest - *mean))
        .or_insert(newest);
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use spec::{ArtifactEntry, Counts, Job, Provenance};

    use super::*;

    fn job(more: serde_json::Value) -> Job {
        let mut body = json!({"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                              "camera": {"width": 100, "height": 50, "hfov_deg": 80}});
        body.as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        let library = style::Library::embedded().unwrap();
        Job::parse(
            body.to_string().as_bytes(),
            &renderer::vocabulary(&library, false),
        )
        .unwrap()
    }

    fn cost(costs: &Costs, job: &Job) -> Cost {
        let frame = job.resolve(0).unwrap();
        costs.mean(&[Sized {
            frame: &frame,
            pixels: 5000.0,
        }])
    }

    #[test]
    fn more_work_costs_more_and_measurements_replace_typical_figures() {
        let costs = Costs::default();
        let plain = cost(&costs, &job(json!({})));
        let water = cost(
            &costs,
            &job(json!({"water": {"optics": "jerlov-3C", "style": "muddy"}})),
        );
        assert!(water.seconds > plain.seconds && water.bytes == plain.bytes);
        let lamp = json!({"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]});
        let seconds = |water: serde_json::Value, lamps: usize| {
            let lights = vec![lamp.clone(); lamps];
            cost(&costs, &job(json!({"water": water, "lights": lights}))).seconds
        };
        let suspended = [
            seconds(json!({"optics": "jerlov-3C"}), 0),
            seconds(json!({"optics": "jerlov-3C", "snow": {"density_per_m3": 10}}), 0),
            seconds(json!({"optics": "jerlov-3C", "turbidity": {"contrast": 0.5}}), 0),
            seconds(json!({"optics": "jerlov-3C"}), 1),
            seconds(json!({"optics": "jerlov-3C"}), 4),
        ];
        assert!(
            suspended.windows(2).all(|pair| pair[0] < pair[1]),
            "{suspended:?}"
        );
        let layers = cost(&costs, &job(json!({"artifacts": ["rgb", "direct"]})));
        assert!(layers.bytes > plain.bytes + 5000.0 * 11.0);
        costs.learn(&FrameRecord {
            frame: 0,
            parameters: json!({"camera": {"width": 10, "height": 10}}),
            optics: serde_json::Map::new(),
            promise: None,
            plan: json!([]),
            measurements: BTreeMap::new(),
            artifacts: vec![ArtifactEntry {
                kind: "rgb".to_owned(),
                digest: String::new(),
                bytes: 300,
                media_type: String::new(),
            }],
            counts: Counts::default(),
            timings_ms: BTreeMap::from([("scene".to_owned(), 1000.0), ("water".to_owned(), 0.0)]),
            warnings: Vec::new(),
            scene: None,
            truth: None,
            provenance: Provenance::default(),
        });
        let learned = cost(&costs, &job(json!({})));
        assert!(learned.seconds > 50.0 && learned.seconds < 51.0, "{learned:?}");
        assert_eq!(learned.bytes, 15_000.0 + ROW_BYTES);
    }
}
