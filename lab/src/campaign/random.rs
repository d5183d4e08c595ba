//! Random frames: water alone, uploaded pictures, procedural scenes, and frames of sequences.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use serde_json::{Value, json};

use super::camera::{add_parts, add_path, add_shift, draw_pinhole};
use super::case::Case;
use super::knobs::{FIRST, Knobs, LAST};
use super::lamps::{Surfaces, draw_lamps, has_many_lamps};
use super::picture::{BRIGHT, LIGHTS, Limits, WHITE, draw_picture, draw_sides};
use super::water::{draw_patches, draw_sediment, draw_sky, draw_snow, draw_water, has_veil};

/// Water alone, in all sizes.
const WATER: Limits = Limits::new((1, 64), 4096);
/// Uploaded pictures. The reference runs one transform for each distinct range.
const PICTURES: Limits = Limits::new((20, 64), 1000);
/// Frames with patches. The reference runs one transform for each pixel.
const PATCHES: Limits = Limits::new((12, 32), 400);
/// Frames with many lamps, whose light the reference sums at each pixel.
const MANY_LAMPS: Limits = Limits::new((8, 16), 150);
/// Procedural scenes, before supersampling. Their ranges are all distinct.
const PROCEDURAL: Limits = Limits::new((20, 48), 1000);
/// Frames on a path, which are rendered several times.
const SEQUENCES: Limits = Limits::new((12, 32), 400);

/// A tolerance from 3e-6 to 3e-2.
pub(super) fn draw_tolerance(knobs: &Knobs) -> Value {
    json!({"tolerance": knobs.log("tolerance", 3e-6, 3e-2)})
}

/// A bright picture in water alone, with one kernel per path length: the frames whose cheapest sufficient plan is searched.
pub(super) fn draw_water_alone(knobs: &mut Knobs) -> Case {
    knobs.hold(&[
        ("picture.kind", WHITE),
        ("scatter.is_published", FIRST),
        ("water.has_veil", FIRST),
        ("water.is_veil_free", LAST),
        ("water.is_deep", LAST),
    ]);
    knobs.hold_one("picture.light", &LIGHTS, &LIGHTS[..BRIGHT]);
    let picture = draw_picture(knobs, WATER);
    let mut camera = draw_pinhole(knobs, picture.range.size());
    // Focal lengths of full-size pictures make the kernels as wide as there.
    let half = picture.range.width() as f64 / 2.0 / knobs.log("camera.focal", 60.0, 900.0);
    camera["hfov_deg"] = json!((2.0 * half.atan().to_degrees()).max(1.0));
    let job = json!({
        "camera": camera,
        "water": draw_water(knobs),
        "fidelity": draw_tolerance(knobs),
    });
    Case::new(knobs, job, Some(picture))
}

/// An uploaded picture with a camera.
pub(super) fn draw_uploaded(knobs: &mut Knobs) -> Case {
    let limits = choose_limits(knobs, PICTURES);
    let picture = draw_picture(knobs, limits);
    let mut job =
        json!({"camera": draw_pinhole(knobs, picture.range.size()), "fidelity": draw_tolerance(knobs)});
    if knobs.chance("camera.is_real", 0.9) {
        add_parts(knobs, &mut job["camera"]);
    }
    if knobs.chance("camera.shifts", 0.15) {
        add_shift(knobs, &mut job["camera"]);
    }
    if knobs.chance("camera.has_up", 0.2) {
        job["camera"]["up"] = json!(knobs.within_rgb("camera.up", -1.0, 1.0));
    }
    fill(knobs, &mut job, &picture.range);
    Case::new(knobs, job, Some(picture))
}

/// A procedural scene with a camera.
pub(super) fn draw_procedural(knobs: &mut Knobs) -> Case {
    let supersample = match knobs.chance("camera.is_supersampled", 0.15) {
        true => knobs.whole("camera.supersample", 2, 3),
        false => 1,
    };
    let limits = choose_limits(knobs, PROCEDURAL);
    let (least, most) = limits.sides_px;
    let sides_px = (least / supersample, most / supersample);
    let limits = Limits::new(sides_px, limits.pixels / (supersample * supersample));
    let (mut job, range) = draw_place(knobs, limits);
    if knobs.chance("camera.is_real", 0.9) {
        add_parts(knobs, &mut job["camera"]);
    }
    if supersample > 1 {
        job["camera"]["supersample"] = json!(supersample);
    }
    fill(knobs, &mut job, &range);
    Case::new(knobs, job, None)
}

/// A frame on a path: motion blur, rolling readout, lagging metering.
pub(super) fn draw_sequence(knobs: &mut Knobs) -> Case {
    let (mut job, range) = draw_place(knobs, SEQUENCES);
    add_parts(knobs, &mut job["camera"]);
    add_path(knobs, &mut job["camera"]);
    fill(knobs, &mut job, &range);
    Case::new(knobs, job, None)
}

/// A procedural scene with a pinhole camera, and its ranges.
fn draw_place(knobs: &Knobs, limits: Limits) -> (Value, Plane<f32>) {
    let size = draw_sides(knobs, limits);
    let family = knobs.pick("scene.family", scenes::FAMILIES);
    let seed = knobs.whole("scene.seed", 0, 1000);
    let mut camera = draw_pinhole(knobs, size);
    camera["hfov_deg"] = json!(knobs.within("camera.hfov", 30.0, 100.0));
    let seen = scenes::procedural(family, seed as u64, size.0, size.1, intrinsics(&camera, size));
    let range = seen.ok().and_then(|scene| scene.range);
    let range = range.unwrap_or_else(|| Plane::filled(size.0, size.1, 1.0));
    let scene = json!({"kind": "procedural", "family": family, "seed": seed});
    let job = json!({"scene": scene, "camera": camera, "fidelity": draw_tolerance(knobs)});
    (job, range)
}

fn has_patches(knobs: &Knobs) -> bool {
    knobs.chance("water.has_patches", 0.2)
}

/// Smaller pictures where the reference is slow.
fn choose_limits(knobs: &Knobs, usual: Limits) -> Limits {
    match (has_many_lamps(knobs), has_patches(knobs)) {
        (true, _) => MANY_LAMPS,
        (false, true) => PATCHES,
        (false, false) => usual,
    }
}

/// Adds water, its contents and lamps, except to a few frames in air.
fn fill(knobs: &Knobs, job: &mut Value, range: &Plane<f32>) {
    if !knobs.chance("water.is_there", 0.96) {
        job["scene"]["lighting"] = json!("in_air");
        return;
    }
    let camera = intrinsics(&job["camera"], range.size());
    let mut water = draw_water(knobs);
    if has_patches(knobs) {
        water["turbidity"] = draw_patches(knobs);
    }
    if knobs.chance("water.has_snow", 0.25) {
        water["snow"] = draw_snow(knobs, &camera, range.size());
    }
    if knobs.chance("water.has_sediment", 0.05) {
        water["sediment"] = draw_sediment(knobs);
    }
    let has_veil = has_veil(knobs);
    if !has_veil && knobs.chance("water.has_sky", 0.5) {
        job["daylight"] = draw_sky(knobs);
    }
    let has_lamps = knobs.chance("water.has_lamps", 0.4);
    if has_lamps {
        job["lights"] = json!(draw_lamps(knobs, Surfaces { range, camera }));
    }
    // Without lamps, an explicit veil is all the light of the water.
    let is_reflectance = (has_lamps || !has_veil) && knobs.chance("scene.is_reflectance", 0.6);
    job["scene"]["lighting"] = json!(if is_reflectance { "water" } else { "in_air" });
    job["water"] = water;
}

/// The pinhole of a description.
fn intrinsics(camera: &Value, (width, height): (usize, usize)) -> Intrinsics {
    let half_deg = camera["hfov_deg"].as_f64().unwrap_or(80.0) / 2.0;
    Intrinsics::centered(width as f64 / 2.0 / half_deg.to_radians().tan(), width, height)
}
