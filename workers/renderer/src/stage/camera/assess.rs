//! The plan of a camera: its variants, errors and gains.

use ::camera::{defocus, exposure, geometry, movement, vignette};
use optics::plan::{ErrorBound, Gain, Stage, StageId, Variant};
use spec::{Exposure, Fidelity, Metering, WhiteBalance};

use super::Expected;
use crate::context::FrameContext;
use crate::inputs::camera::Taking;

/// Rounding of stages with non-negative weights is relative to the light; the bound is for light up to white.
const WHITE: f64 = 1.0;
/// Maximum share of a frame's tolerance for omitting the vignette.
const SHARE: f64 = 0.1;
/// Nanoseconds per pixel; `benches/frame.rs` of the camera measures them.
const GEOMETRY_NS: f64 = 9.0;
const CHROMATIC_NS: f64 = 15.0;
const BLUR_NS: f64 = 4.0;
/// Nanoseconds for each pixel of a disc.
const TAP_NS: f64 = 0.3;
const VIGNETTE_NS: f64 = 1.5;
const METERING_NS: f64 = 2.5;
const SENSOR_NS: f64 = 14.0;
const DEMOSAIC_NS: f64 = 4.0;
const JPEG_NS: f64 = 30.0;

/// The camera of a plan.
struct Camera<'a> {
    taking: &'a Taking,
    is_reference: bool,
}

impl Camera<'_> {
    fn stage(&self, id: StageId, fast: &'static str, ns: f64) -> Stage {
        let variant = if self.is_reference {
            Variant::Reference
        } else {
            Variant::Fast(fast)
        };
        Stage::new(id, variant).costing(ns, self.pixels())
    }

    fn pixels(&self) -> usize {
        self.taking.parts.size.0 * self.taking.parts.size.1
    }
}

/// The stages from the light before the camera to the exposed light; empty for a pinhole.
/// `peak` is the brightest light before the camera.
pub(crate) fn assess_optics(
    context: &FrameContext<'_>,
    expected: Option<Expected>,
    tolerance: Option<ErrorBound>,
    peak: f64,
) -> Vec<Stage> {
    let Some(taking) = &context.taking else {
        return Vec::new();
    };
    let camera = Camera {
        taking,
        is_reference: context.frame.fidelity == Fidelity::Reference,
    };
    let stages = [
        assess_movement(&camera),
        assess_geometry(&camera, peak),
        assess_defocus(&camera),
        assess_vignette(&camera, tolerance),
        expected.and_then(|expected| assess_exposure(&camera, expected, tolerance)),
    ];
    stages.into_iter().flatten().collect()
}

/// The mean of several pictures, or of shifted copies of one. The reference also averages in f32, so the rounding counts twice. The
/// plan of a frame is that of its pose; the excess of other moments is added later.
fn assess_movement(camera: &Camera<'_>) -> Option<Stage> {
    let Taking {
        moments, shift_px, ..
    } = camera.taking;
    let exposures = moments.len();
    let (variant, rounding, pictures) = match shift_px {
        _ if exposures > 1 => ("poses", movement::average_bound(exposures, WHITE), exposures),
        Some(shift) => (
            "shift",
            movement::shift_bound(*shift, WHITE),
            movement::copies(*shift),
        ),
        None => return None,
    };
    let note = format!("{exposures} pictures of the scene are taken, each at its cost");
    Some(Stage {
        note: (exposures > 1).then_some(note),
        bound: Some(ErrorBound::relative(2.0 * rounding)),
        ..Stage::new(StageId::Movement, Variant::Fast(variant))
            .costing(VIGNETTE_NS * pictures as f64, camera.pixels())
    })
}

/// Bilinear weights are non-negative, but f32 cancels between a bright pixel and its neighbor.
fn assess_geometry(camera: &Camera<'_>, peak: f64) -> Option<Stage> {
    let parts = &camera.taking.parts;
    let Some(source) = &parts.source else {
        let note = format!("no pixel moves by more than {} px", geometry::STILL_PX);
        return parts.asks_geometry.then(|| Stage {
            note: Some(note),
            ..Stage::skipped(StageId::Geometry)
        });
    };
    let ns = if parts.lens.is_chromatic() {
        CHROMATIC_NS
    } else {
        GEOMETRY_NS
    };
    Some(Stage {
        bound: Some(ErrorBound {
            absolute: geometry::sampling_bound(source, 0.0, peak),
            relative: geometry::sampling_bound(source, WHITE, 0.0),
        }),
        ..camera.stage(StageId::Geometry, "f32", ns)
    })
}

fn assess_defocus(camera: &Camera<'_>) -> Option<Stage> {
    camera.taking.parts.focus?;
    let blur_px = camera.taking.most_blur_px;
    let note = Some(format!("circles of confusion of up to {blur_px:.2} px"));
    if blur_px < defocus::SHARP_PX {
        return Some(Stage {
            note,
            ..Stage::skipped(StageId::Defocus)
        });
    }
    let taps = std::f64::consts::PI * blur_px * blur_px;
    Some(Stage {
        bound: Some(ErrorBound::relative(defocus::rounding_bound(blur_px, WHITE))),
        note,
        ..camera.stage(StageId::Defocus, "f32", BLUR_NS + TAP_NS * taps)
    })
}

fn assess_vignette(camera: &Camera<'_>, tolerance: Option<ErrorBound>) -> Option<Stage> {
    let parts = &camera.taking.parts;
    let falloff = parts.falloff.as_ref()?;
    let change = falloff.strength(parts.size);
    let share = tolerance.map(|tolerance| SHARE * tolerance.absolute);
    if share.is_some_and(|share| change <= share) {
        return Some(Stage {
            share,
            bound: Some(ErrorBound::relative(change)),
            ..Stage::skipped(StageId::Vignette)
        });
    }
    Some(Stage {
        share,
        bound: Some(ErrorBound::relative(vignette::rounding_bound(
            Some(falloff),
            1.0,
            WHITE,
        ))),
        gain: Gain::factor(falloff.limits(parts.size).largest),
        ..camera.stage(StageId::Vignette, "f32", VIGNETTE_NS)
    })
}

fn assess_exposure(camera: &Camera<'_>, expected: Expected, tolerance: Option<ErrorBound>) -> Option<Stage> {
    let parts = &camera.taking.parts;
    let variant = match parts.exposure? {
        Exposure::Fixed(_) => "fixed",
        Exposure::Auto(_) => "auto",
    };
    let rounding = vignette::rounding_bound(parts.falloff.as_ref(), expected.gain, WHITE);
    let stage = match expected.metering {
        None => Stage {
            bound: Some(ErrorBound::relative(rounding)),
            gain: Gain::factor(expected.gain),
            note: Some(format!("a factor of {:.3}", expected.gain)),
            ..Stage::new(StageId::Exposure, Variant::Fast(variant))
        },
        Some(metering) => Stage {
            bound: Some(ErrorBound::relative(rounding + exposure::luminance_rounding())),
            gain: metered_gain(expected.gain, &metering, tolerance.unwrap_or_default()),
            note: Some(format!(
                "a factor of at most {:.3}, from a thinned picture",
                expected.gain
            )),
            ..Stage::new(StageId::Exposure, Variant::Fast(variant)).costing(METERING_NS, camera.pixels())
        },
    };
    Some(stage)
}

/// The gain of a metered exposure: an error of the light moves the metered luminance and with it the factor. Of light up to
/// white, `|L g - L' g'| <= g e (1 + 1/t)` for an absolute error e, and twice any relative error; the quotient of both factors is at
/// most `1/(1 - e g/t)`.
fn metered_gain(gain: f64, metering: &Metering, tolerance: ErrorBound) -> Gain {
    let error = tolerance.bound_sample(metering.target);
    let quotient = 1.0 / (1.0 - (error / metering.target).min(0.5));
    Gain {
        absolute: quotient * exposure::metered_slope(gain, metering, WHITE),
        relative: 2.0 * quotient,
    }
}

/// The stages from the exposed light to codes; empty for a pinhole.
pub(crate) fn assess_electronics(context: &FrameContext<'_>) -> Vec<Stage> {
    let Some(taking) = &context.taking else {
        return Vec::new();
    };
    let camera = Camera {
        taking,
        is_reference: context.frame.fidelity == Fidelity::Reference,
    };
    let parts = &taking.parts;
    let mut stages = Vec::new();
    if let Some(sensor) = &parts.sensor {
        let demosaics = sensor.cfa != spec::Cfa::None;
        let planes = if demosaics { 1.0 } else { 3.0 };
        let noise = format!(
            "noise of white {:.2e}, of black {:.2e}",
            sensor.noise_at(1.0),
            sensor.noise_at(0.0)
        );
        stages.push(Stage {
            note: Some(noise),
            ..camera.stage(StageId::Sensor, "emva1288", SENSOR_NS * planes)
        });
        stages.push(if demosaics {
            Stage::new(StageId::Demosaic, Variant::Fast("bilinear")).costing(DEMOSAIC_NS, camera.pixels())
        } else {
            Stage::skipped(StageId::Demosaic)
        });
    }
    if parts.balance.is_some_and(|balance| balance != WhiteBalance::Off) {
        let gains = Stage::new(StageId::WhiteBalance, Variant::Fast("gains"));
        stages.push(gains.costing(VIGNETTE_NS, camera.pixels()));
    }
    if parts.jpeg.is_some() {
        let blocks = Stage::new(StageId::Jpeg, Variant::Fast("blocks"));
        stages.push(blocks.costing(JPEG_NS, camera.pixels()));
    }
    stages
}
