//! Adversarial frames against single bounds. Most are uploaded pictures with some numbers set for the weakest point of a bound; one
//! family attacks the interpolation of forward scatter.

#[expect(
    dead_code,
    reason = "`Frame::water` is only read by the tests of the optics crate"
)]
#[path = "../../../workers/optics/tests/adversary/frames.rs"]
mod frames;

use serde_json::{Value, json};
use spec::ScatterModel;

use super::camera::draw_metering;
use super::case::{Case, Picture};
use super::knobs::{FIRST, Knobs, LAST};
use super::picture::{COURSES, DIM, LIGHTS, WHITE};
use super::random::{draw_tolerance, draw_uploaded};
use frames::{Attack, Frame};

/// The random number that selects a fixed exposure.
const FIXED: f64 = 0.3;
/// The random number that selects a metered exposure.
const METERED: f64 = 0.9;

/// A dark picture, metered at a percentile between two values of its light.
pub(super) fn draw_metered(mut knobs: Knobs) -> (Case, Knobs) {
    knobs.hold(&[
        ("camera.is_real", FIRST),
        ("camera.exposure", METERED),
        ("camera.has_defocus", LAST),
        ("picture.kind", DIM),
    ]);
    knobs.hold_one(
        "picture.light",
        &LIGHTS,
        &["dark side", "signs", "checks", "lamps", "ramp"],
    );
    let mut case = draw_uploaded(&knobs);
    if let Some(picture) = &case.picture {
        let away = knobs.whole("directed.position", 0, 4) as f64 - 2.0;
        case.job["camera"]["exposure"]["auto"]["percentile"] = json!(widest_gap(picture, away));
    }
    (case, knobs)
}

/// The percentile of the largest step between sorted values of a picture, moved by some positions.
fn widest_gap(picture: &Picture, away: f64) -> f64 {
    let mut values: Vec<f32> = picture.radiance.planes()[1].data().to_vec();
    values.sort_by(f32::total_cmp);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
    let widest = steps.max_by(|a, b| a.1.total_cmp(&b.1));
    let position = widest.map_or(0, |(below, _)| below + 1);
    ((position as f64 + away) / values.len() as f64).clamp(0.0, 1.0)
}

/// One bright pixel, or alternating light and range.
pub(super) fn draw_points(mut knobs: Knobs) -> (Case, Knobs) {
    knobs.hold(&[
        ("camera.is_real", FIRST),
        ("camera.has_defocus", LAST),
        ("picture.kind", WHITE),
    ]);
    knobs.hold_one(
        "picture.light",
        &LIGHTS,
        &["point", "signs", "dark specks", "salt and pepper"],
    );
    knobs.hold_one(
        "range.course",
        &COURSES,
        &["stripes", "needles", "noise", "step", "far specks"],
    );
    let exposure = if knobs.chance("directed.is_fixed", 0.7) {
        FIXED
    } else {
        METERED
    };
    knobs.hold(&[("camera.exposure", exposure)]);
    (draw_uploaded(&knobs), knobs)
}

/// Circles of confusion and light that change from pixel to pixel.
pub(super) fn draw_defocused(mut knobs: Knobs) -> (Case, Knobs) {
    knobs.hold(&[
        ("camera.is_real", FIRST),
        ("camera.has_defocus", FIRST),
        ("picture.kind", WHITE),
    ]);
    knobs.hold_one(
        "picture.light",
        &LIGHTS,
        &["point", "signs", "lamps", "checks", "dark side"],
    );
    knobs.hold_one(
        "range.course",
        &COURSES,
        &["stripes", "needles", "noise", "step", "slope", "wall"],
    );
    (draw_uploaded(&knobs), knobs)
}

/// Lamps close to surfaces, with metering at low percentiles.
pub(super) fn draw_lit(mut knobs: Knobs) -> (Case, Knobs) {
    knobs.hold(&[
        ("camera.is_real", FIRST),
        ("camera.has_defocus", LAST),
        ("water.has_lamps", FIRST),
    ]);
    let exposure = if knobs.chance("directed.is_fixed", 0.4) {
        FIXED
    } else {
        METERED
    };
    knobs.hold(&[("camera.exposure", exposure)]);
    if exposure == METERED {
        knobs.hold(&[
            ("metering.kind", LAST),
            ("metering.percentile", knobs.unit("directed.percentile").powi(3)),
        ]);
    }
    (draw_uploaded(&knobs), knobs)
}

/// A lens, a port, a fall-off and movement over alternating light.
pub(super) fn draw_lens(mut knobs: Knobs) -> (Case, Knobs) {
    knobs.hold(&[
        ("camera.is_real", FIRST),
        ("camera.has_defocus", LAST),
        ("camera.has_vignette", FIRST),
        ("vignette.is_free", FIRST),
        ("vignette.is_limit", FIRST),
        ("picture.kind", WHITE),
    ]);
    let has_distortion = knobs.chance("directed.has_distortion", 0.6);
    knobs.hold(&[("camera.has_distortion", if has_distortion { FIRST } else { LAST })]);
    let has_port = knobs.chance("directed.has_port", 0.6);
    knobs.hold(&[("camera.has_port", if has_port { FIRST } else { LAST })]);
    knobs.hold_one("picture.light", &LIGHTS, &["point", "signs", "salt and pepper"]);
    (draw_uploaded(&knobs), knobs)
}

/// A frame against the interpolation of forward scatter. Its brightest light is below white after exposure.
pub(super) fn draw_scattered(knobs: Knobs) -> (Case, Knobs) {
    let attack = draw_attack(&knobs);
    let level = knobs.log("directed.level", 0.2, 1.0);
    let gain = knobs.log("exposure.fixed", 1e-2, 1e3);
    let (width, height) = attack.size;
    let mut job = json!({
        "camera": {"width": width, "height": height, "hfov_deg": 20.0, "exposure": {"fixed": gain}},
        "water": {"optics": attacked_optics(attack.model)},
        // The attack is against the plan of white light at `attack.tolerance`; this frame is `level` times white.
        "fidelity": {"tolerance": (attack.tolerance * level).clamp(1e-7, 1.0)},
    });
    if knobs.chance("directed.is_metered", 0.25) {
        job["camera"]["exposure"] = json!({"auto": draw_metering(&knobs)});
    }
    let Some(Frame { radiance, range, .. }) = attack.frame() else {
        job["fidelity"] = draw_tolerance(&knobs);
        return (draw_uploaded(&knobs), knobs);
    };
    let radiance = radiance.map(|&v| (f64::from(v) * level / gain) as f32);
    let case = Case::new(&knobs, job, Some(Picture { radiance, range }));
    (case, knobs)
}

fn draw_attack(knobs: &Knobs) -> Attack {
    let size = (
        knobs.whole("directed.width", 20, 64),
        knobs.whole("directed.height", 20, 48),
    );
    let narrowest = knobs.log("directed.narrowest", 0.01, 3.0);
    Attack {
        model: if knobs.chance("directed.is_jaffe", 0.7) {
            ScatterModel::Jaffe
        } else {
            ScatterModel::Simplified
        },
        size,
        target: (
            knobs.whole("directed.x", 0, size.0 - 1),
            knobs.whole("directed.y", 0, size.1 - 1),
        ),
        widths_px: (
            narrowest,
            narrowest * 3.0 * knobs.log("directed.widest", 1.0, 3000.0),
        ),
        tolerance: knobs.log("directed.tolerance", 3e-5, 3e-2),
        brighter: knobs.chance("directed.is_brighter", 0.5),
    }
}

/// The water of such a frame, with kernel scales as ranges.
fn attacked_optics(model: ScatterModel) -> Value {
    let gathers = model == ScatterModel::Simplified;
    let attenuation = [if gathers { 0.0 } else { 1000.0 }; 3];
    let (zero, one) = ([0.0; 3], [1.0; 3]);
    json!({
        "beam_attenuation_per_m": attenuation,
        "veiling_light": zero,
        "forward_scatter": {
            "model": if gathers { "simplified" } else { "jaffe" },
            "g_per_m": zero, "spread_px_per_m": one, "spread_offset_px": zero,
        },
    })
}
