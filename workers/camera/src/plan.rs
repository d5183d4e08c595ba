//! What of a camera is asked for, every number known, and what of it a frame needs.
//!
//! A part is left out where its largest change stays within its share of the frame's tolerance: distortion and port where no
//! pixel moves by more than [`STILL_PX`], defocus where no circle of confusion reaches [`SHARP_PX`], a vignette by its depth
//! times the brightest light. Noise is never left out.

use imaging::geometry::Intrinsics;
use serde::Serialize;
use spec::{Camera, Exposure, Jpeg, Port, Tone, WhiteBalance};

use crate::defocus::{Focus, SHARP_PX};
use crate::geometry::{Lens, STILL_PX, Source};
use crate::preset;
use crate::sensor::Sensor;
use crate::vignette::FallOff;

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

/// The parts of a camera, resolved for a picture; a pinhole without noise has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Columns and rows of the camera's picture.
    pub size: (usize, usize),
    /// The lens behind its port, in air.
    pub lens: Lens,
    /// The picture that it looks into; none where it shows that picture as it is.
    pub source: Option<Source>,
    /// Whether distortion, port or supersampling are asked for.
    pub asks_geometry: bool,
    /// Blur out of focus.
    pub focus: Option<Focus>,
    /// Fall-off towards the corners.
    pub falloff: Option<FallOff>,
    /// Brightness.
    pub exposure: Option<Exposure>,
    /// Sensor.
    pub sensor: Option<Sensor>,
    /// White balance.
    pub balance: Option<WhiteBalance>,
    /// Curve to codes.
    pub tone: Option<Tone>,
    /// Bits of the codes: 8 or 16.
    pub bits: u8,
    /// Compression.
    pub jpeg: Option<Jpeg>,
}

/// What a camera looks into.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scenery {
    /// A scene that is rendered as large as need be.
    Rendered,
    /// A picture with its camera in the water.
    Picture(Intrinsics, (usize, usize)),
}

/// A camera that has no picture of such a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartsError {
    /// The lens folds.
    #[error(transparent)]
    Fold(#[from] crate::geometry::Fold),
    /// The source picture is beyond the limits of pictures.
    #[error(
        "the lens sees so much more than the picture's sides that the scene would need over {side} pixels a side or {pixels} in all",
        side = imaging::codec::MAX_SIDE_PX, pixels = imaging::codec::MAX_PIXELS
    )]
    TooWide,
    /// A mosaic needs two by two pixels.
    #[error("a sensor with color filters needs at least 2×2 pixels")]
    TooSmall,
    /// A picture cannot be taken from several poses.
    #[error("only a procedural scene can be seen from several poses")]
    NoPath,
    /// The sensor is not of the table.
    #[error("the sensor is not known")]
    UnknownSensor,
    /// Codes have 8 or 16 bits.
    #[error("a picture's codes have 8 or 16 bits, not {0}")]
    Bits(u8),
    /// JPEG has 8 bits.
    #[error("a picture of {0} bits cannot be compressed: JPEG has 8")]
    DeepJpeg(u8),
    /// Black is at or above the largest code.
    #[error("black is at {black}, but the largest code is {most}")]
    Black {
        /// Code of no light.
        black: u16,
        /// Largest code.
        most: f64,
    },
}

impl Parts {
    /// The parts of a camera before a scene; those of its preset included.
    ///
    /// # Errors
    /// [`PartsError`].
    pub fn resolve(camera: &Camera, scenery: Scenery) -> Result<Self, PartsError> {
        let camera = preset::complete(camera);
        let asks_geometry = camera.distortion.is_some()
            || matches!(camera.port, Some(Port::Flat { .. }))
            || camera.supersample.is_some_and(|factor| factor > 1);
        let (size, air) = match scenery {
            Scenery::Rendered => {
                let (width, height) = (camera.width, camera.height);
                let focal_px = camera.focal_px(width);
                ((width, height), Intrinsics::centered(focal_px, width, height))
            }
            Scenery::Picture(water, size) => (size, water),
        };
        let mut lens = Lens::new(air, camera.distortion, camera.port);
        if let Scenery::Picture(..) = scenery {
            lens.camera.focal_px /= lens.magnification();
        }
        let source = if asks_geometry {
            source(&lens, size, &camera, scenery)?
        } else {
            None
        };
        let sensor = match &camera.sensor {
            Some(law) => Some(checked(
                preset::sensor(law).ok_or(PartsError::UnknownSensor)?,
                size,
            )?),
            None => None,
        };
        Ok(Self {
            size,
            source,
            asks_geometry,
            focus: camera
                .defocus
                .map(|law| Focus::new(law, lens.camera.focal_px, camera.port)),
            falloff: camera.vignette.map(|law| FallOff::new(law, lens.camera, size)),
            exposure: camera.exposure,
            sensor,
            balance: camera.white_balance,
            tone: camera.tone,
            bits: checked_bits(&camera)?,
            jpeg: camera.jpeg,
            lens,
        })
    }

    /// Whether nothing is asked for.
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        !self.asks_geometry
            && self.focus.is_none()
            && self.falloff.is_none()
            && self.exposure.is_none()
            && self.is_electronic_free()
            && self.jpeg.is_none()
    }

    /// Whether nothing happens between exposed light and codes but today's curve.
    fn is_electronic_free(&self) -> bool {
        self.sensor.is_none() && self.balance.is_none() && self.tone.is_none() && self.bits == 8
    }
}

fn checked_bits(camera: &Camera) -> Result<u8, PartsError> {
    match camera.bits.unwrap_or(8) {
        8 => Ok(8),
        16 if camera.jpeg.is_some() => Err(PartsError::DeepJpeg(16)),
        16 => Ok(16),
        other => Err(PartsError::Bits(other)),
    }
}

fn checked(sensor: Sensor, (width, height): (usize, usize)) -> Result<Sensor, PartsError> {
    if f64::from(sensor.black_dn) >= sensor.most_dn() {
        return Err(PartsError::Black {
            black: sensor.black_dn,
            most: sensor.most_dn(),
        });
    }
    if sensor.cfa != spec::Cfa::None && (width < 2 || height < 2) {
        return Err(PartsError::TooSmall);
    }
    Ok(sensor)
}

/// The picture that the lens looks into; none where no pixel moves.
fn source(
    lens: &Lens,
    size: (usize, usize),
    camera: &Camera,
    scenery: Scenery,
) -> Result<Option<Source>, PartsError> {
    lens.check(size)?;
    let supersample = camera.supersample.unwrap_or(1);
    match scenery {
        Scenery::Rendered if supersample == 1 && is_still(lens, lens.camera, size) => Ok(None),
        Scenery::Rendered => match Source::around(lens, size, supersample) {
            Some(source) => Ok(Some(source)),
            None => Err(PartsError::TooWide),
        },
        Scenery::Picture(water, _) if is_still(lens, water, size) => Ok(None),
        Scenery::Picture(water, size) => Ok(Some(Source { size, camera: water })),
    }
}

/// Whether no pixel of the border, where a lens moves most, looks elsewhere than a pinhole's.
fn is_still(lens: &Lens, pinhole: Intrinsics, (width, height): (usize, usize)) -> bool {
    let walk = |side: usize| (0..=32).map(move |i| i * (side - 1) / 32);
    walk(height)
        .flat_map(|y| walk(width).map(move |x| (x, y)))
        .all(|(x, y)| {
            let air = lens.camera.ray(x as f64, y as f64);
            let Some(ideal) = lens.undistorted(air.x, air.y) else {
                return false;
            };
            (0..3).all(|channel| {
                let (u, v) = lens.in_water(ideal, channel);
                let moved =
                    |u: f64, center: f64, at: usize| (center + pinhole.focal_px * u - at as f64).abs();
                moved(u, pinhole.cx, x).max(moved(v, pinhole.cy, y)) <= STILL_PX
            })
        })
}

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
