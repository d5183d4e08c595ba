//! What of a camera a frame needs.
//!
//! A part is left out where its largest change stays within its share of the frame's tolerance: distortion and port where no
//! pixel moves by more than [`STILL_PX`], defocus where no circle of confusion reaches [`SHARP_PX`], a vignette by its depth
//! times the brightest light. Noise is never left out.

use serde::Serialize;
use spec::{Exposure, WhiteBalance};

use crate::defocus::SHARP_PX;
use crate::geometry::STILL_PX;
use crate::parts::Parts;

/// Share of a frame's tolerance that a vignette may change and still be left out.
const SHARE: f64 = 0.1;
/// Nanoseconds a pixel of the parts: expected from what each does to a pixel. `benches/frame.rs` measures them.
const GEOMETRY_NS: f64 = 9.0;
const CHROMATIC_NS: f64 = 15.0;
const BLUR_NS: f64 = 4.0;
/// Of each pixel of a disc.
const TAP_NS: f64 = 0.3;
const VIGNETTE_NS: f64 = 1.5;
const METERING_NS: f64 = 2.5;
const SENSOR_NS: f64 = 14.0;
const DEMOSAIC_NS: f64 = 4.0;
const JPEG_NS: f64 = 30.0;

/// One line of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// The part.
    pub stage: &'static str,
    /// What is done.
    pub variant: &'static str,
    /// The error in linear light that it may make.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// The error that it may add.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// Expected milliseconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost_ms: Option<f64>,
    /// What to know about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// What is known of a frame before its camera works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given {
    /// The largest error in linear light that the frame asks for.
    pub tolerance: Option<f64>,
    /// Whether every part runs in f64.
    pub is_reference: bool,
    /// The brightest light before the camera.
    pub peak: f64,
    /// The largest circle of confusion in px.
    pub blur_px: f64,
    /// Pictures that are taken for the frame: of movement and of rows.
    pub exposures: usize,
}

/// What of a camera runs for a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Whether the defocus runs.
    pub defocus: bool,
    /// Whether the vignette runs.
    pub vignette: bool,
    /// Whether all runs in f64.
    pub is_reference: bool,
    /// The parts that are asked for, line by line.
    pub steps: Vec<Step>,
}

impl Plan {
    /// Chooses for a frame.
    #[must_use]
    pub fn new(parts: &Parts, given: &Given) -> Self {
        let pixels = (parts.size.0 * parts.size.1) as f64;
        let share = given.tolerance.map(|tolerance| tolerance * SHARE);
        let change = parts
            .falloff
            .map_or(0.0, |falloff| falloff.strength(parts.size) * given.peak);
        let mut plan = Self {
            defocus: parts.focus.is_some() && given.blur_px >= SHARP_PX,
            vignette: parts.falloff.is_some() && !share.is_some_and(|share| change <= share),
            is_reference: given.is_reference,
            steps: Vec::new(),
        };
        let form = |runs: bool| match (runs, given.is_reference) {
            (false, _) => "skip",
            (true, true) => "reference",
            (true, false) => "f32",
        };
        let cost = |runs: bool, ns: f64| {
            let ms = if runs { ns * pixels / 1e6 } else { 0.0 };
            (!given.is_reference || !runs).then(|| (ms * 100.0).round() / 100.0)
        };
        let step = |stage, variant, runs, ns| Step {
            stage,
            variant,
            share: None,
            bound: None,
            cost_ms: cost(runs, ns),
            note: None,
        };
        let mut steps = Vec::new();
        if given.exposures > 1 {
            let note = format!(
                "{} pictures of the scene are taken, each at its cost",
                given.exposures
            );
            steps.push(Step {
                note: Some(note),
                ..step(
                    "camera.movement",
                    "poses",
                    true,
                    VIGNETTE_NS * given.exposures as f64,
                )
            });
        }
        if parts.asks_geometry {
            let runs = parts.source.is_some();
            let ns = if parts.lens.is_chromatic() {
                CHROMATIC_NS
            } else {
                GEOMETRY_NS
            };
            let still = format!("no pixel moves by more than {STILL_PX} px");
            steps.push(Step {
                note: (!runs).then_some(still),
                ..step("camera.geometry", form(runs), runs, ns)
            });
        }
        if parts.focus.is_some() {
            let taps = std::f64::consts::PI * given.blur_px * given.blur_px;
            steps.push(Step {
                note: Some(format!("circles of confusion of up to {:.2} px", given.blur_px)),
                ..step(
                    "camera.defocus",
                    form(plan.defocus),
                    plan.defocus,
                    BLUR_NS + TAP_NS * taps,
                )
            });
        }
        if parts.falloff.is_some() {
            steps.push(Step {
                share,
                bound: (!plan.vignette).then_some(change),
                ..step("camera.vignette", form(plan.vignette), plan.vignette, VIGNETTE_NS)
            });
        }
        if let Some(exposure) = parts.exposure {
            let (variant, ns) = match exposure {
                Exposure::Fixed(_) => ("fixed", 0.0),
                Exposure::Auto(_) => ("auto", METERING_NS),
            };
            steps.push(step("camera.exposure", variant, true, ns));
        }
        if let Some(sensor) = &parts.sensor {
            let planes = if sensor.cfa == spec::Cfa::None { 3.0 } else { 1.0 };
            let noise = format!(
                "noise of white {:.2e}, of black {:.2e}",
                sensor.noise_at(1.0),
                sensor.noise_at(0.0)
            );
            let variant = if given.is_reference {
                "reference"
            } else {
                "emva1288"
            };
            steps.push(Step {
                note: Some(noise),
                ..step("camera.sensor", variant, true, SENSOR_NS * planes)
            });
            let demosaics = sensor.cfa != spec::Cfa::None;
            steps.push(step(
                "camera.demosaic",
                if demosaics { "bilinear" } else { "skip" },
                demosaics,
                DEMOSAIC_NS,
            ));
        }
        if parts.balance.is_some_and(|balance| balance != WhiteBalance::Off) {
            steps.push(step("camera.white_balance", "gains", true, VIGNETTE_NS));
        }
        if parts.jpeg.is_some() {
            steps.push(step("camera.jpeg", "blocks", true, JPEG_NS));
        }
        plan.steps = steps;
        plan
    }
}
