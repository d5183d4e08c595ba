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
/// All parts of a camera.
const REAL: (&str, f64) = ("camera.is_real", FIRST);
/// No defocus.
const SHARP: (&str, f64) = ("camera.has_defocus", LAST);

/// Holds the choice of a pattern of light, and of a pattern of range unless there are none.
fn hold_patterns(knobs: &mut Knobs, lights: &[&str], courses: &[&str]) {
    knobs.hold_one("picture.light", &LIGHTS, lights);
    if !courses.is_empty() {
        knobs.hold_one("range.course", &COURSES, courses);
    }
}

/// Holds a fixed exposure in this share of the frames, and metering in the others.
fn hold_exposure(knobs: &mut Knobs, share: f64) -> f64 {
    let is_fixed = knobs.chance("directed.is_fixed", share);
    let exposure = if is_fixed { FIXED } else { METERED };
    knobs.hold(&[("camera.exposure", exposure)]);
    exposure
}

/// A dark picture, metered at a percentile between two values of its light.
pub(super) fn draw_metered(knobs: &mut Knobs) -> Case {
    knobs.hold(&[REAL, ("camera.exposure", METERED), SHARP, ("picture.kind", DIM)]);
    hold_patterns(knobs, &["side", "signs", "checks", "lamps", "ramp"], &[]);
    let mut case = draw_uploaded(knobs);
    if let Some(picture) = &case.picture {
        let away = knobs.whole("directed.position", 0, 4) as f64 - 2.0;
        case.job["camera"]["exposure"]["auto"]["percentile"] = json!(widest_gap(picture, away));
    }
    case
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
pub(super) fn draw_points(knobs: &mut Knobs) -> Case {
    knobs.hold(&[REAL, SHARP, ("picture.kind", WHITE)]);
    let lights = ["point", "signs", "specks", "salt"];
    let courses = ["stripes", "needles", "noise", "step", "far"];
    hold_patterns(knobs, &lights, &courses);
    hold_exposure(knobs, 0.7);
    draw_uploaded(knobs)
}

/// Circles of confusion and light that change from pixel to pixel.
pub(super) fn draw_defocused(knobs: &mut Knobs) -> Case {
    knobs.hold(&[REAL, ("camera.has_defocus", FIRST), ("picture.kind", WHITE)]);
    let lights = ["point", "signs", "lamps", "checks", "side"];
    let courses = ["stripes", "needles", "noise", "step", "slope", "wall"];
    hold_patterns(knobs, &lights, &courses);
    draw_uploaded(knobs)
}

/// Lamps close to surfaces, with metering at low percentiles.
pub(super) fn draw_lit(knobs: &mut Knobs) -> Case {
    knobs.hold(&[REAL, SHARP, ("water.has_lamps", FIRST)]);
    if hold_exposure(knobs, 0.4) == METERED {
        let percentile = knobs.unit("directed.percentile").powi(3);
        knobs.hold(&[("metering.kind", LAST), ("metering.percentile", percentile)]);
    }
    draw_uploaded(knobs)
}

/// A lens, a port, a fall-off and movement over alternating light.
pub(super) fn draw_lens(knobs: &mut Knobs) -> Case {
    knobs.hold(&[REAL, SHARP, ("picture.kind", WHITE)]);
    knobs.hold(&["camera.has_vignette", "vignette.is_free", "vignette.is_limit"].map(|name| (name, FIRST)));
    for (part, chance) in [
        ("camera.has_distortion", "directed.has_distortion"),
        ("camera.has_port", "directed.has_port"),
    ] {
        let has_part = knobs.chance(chance, 0.6);
        knobs.hold(&[(part, if has_part { FIRST } else { LAST })]);
    }
    hold_patterns(knobs, &["point", "signs", "salt"], &[]);
    draw_uploaded(knobs)
}

/// A frame against the interpolation of forward scatter. Its brightest light is below white after exposure.
pub(super) fn draw_scattered(knobs: &mut Knobs) -> Case {
    let attack = draw_attack(knobs);
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
        job["camera"]["exposure"] = json!({"auto": draw_metering(knobs)});
    }
    let Some(Frame { radiance, range, .. }) = attack.frame() else {
        job["fidelity"] = draw_tolerance(knobs);
        return draw_uploaded(knobs);
    };
    let radiance = radiance.map(|&v| (f64::from(v) * level / gain) as f32);
    Case::new(knobs, job, Some(Picture { radiance, range }))
}

fn draw_attack(knobs: &Knobs) -> Attack {
    let width = knobs.whole("directed.width", 20, 64);
    let height = knobs.whole("directed.height", 20, 48);
    let narrowest = knobs.log("directed.narrowest", 0.01, 3.0);
    let widest = narrowest * 3.0 * knobs.log("directed.widest", 1.0, 3000.0);
    let is_jaffe = knobs.chance("directed.is_jaffe", 0.7);
    let (x, y) = (
        knobs.whole("directed.x", 0, width - 1),
        knobs.whole("directed.y", 0, height - 1),
    );
    Attack {
        model: [ScatterModel::Simplified, ScatterModel::Jaffe][usize::from(is_jaffe)],
        size: (width, height),
        target: (x, y),
        widths_px: (narrowest, widest),
        tolerance: knobs.log("directed.tolerance", 3e-5, 3e-2),
        brighter: knobs.chance("directed.is_brighter", 0.5),
    }
}

/// The water of such a frame, with kernel scales as ranges.
fn attacked_optics(model: ScatterModel) -> Value {
    let (name, attenuation) = match model {
        ScatterModel::Simplified => ("simplified", 0.0),
        _ => ("jaffe", 1000.0),
    };
    let (attenuation, zero, one) = ([attenuation; 3], [0.0; 3], [1.0; 3]);
    json!({
        "beam_attenuation_per_m": attenuation, "veiling_light": zero,
        "forward_scatter": {"model": name, "g_per_m": zero, "spread_px_per_m": one, "spread_offset_px": zero},
    })
}
