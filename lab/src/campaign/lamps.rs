//! Random lamps at positions where light and its rounding are worst: from 1 mm to 100 m off a surface, with the edge of the cone on
//! it.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use serde_json::{Value, json};

use super::knobs::Knobs;

/// Maximum lamps of a description.
const MOST_LAMPS: usize = 64;

/// The visible surfaces of a scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surfaces<'a> {
    pub(super) range: &'a Plane<f32>,
    pub(super) camera: Intrinsics,
}

impl Surfaces<'_> {
    /// The surface point of a pixel, in camera axes; 1 m away for holes.
    fn point(&self, x: usize, y: usize) -> [f64; 3] {
        let seen_m = f64::from(self.range.pixel(x, y));
        let is_hole = !seen_m.is_finite() || seen_m <= 0.0;
        let range_m = if is_hole { 1.0 } else { seen_m };
        let ray = self.camera.ray(x as f64, y as f64);
        let length = (ray.x * ray.x + ray.y * ray.y + 1.0).sqrt();
        [ray.x, ray.y, 1.0].map(|v| v / length * range_m)
    }
}

/// Draws 1 to 4 lamps, or 64.
pub(super) fn draw_lamps(knobs: &Knobs, surfaces: Surfaces<'_>) -> Vec<Value> {
    let count = match has_many_lamps(knobs) {
        true => MOST_LAMPS,
        false => knobs.whole("lamps.count", 1, 4),
    };
    let lamps = (0..count).map(|lamp| draw_lamp(knobs, &format!("lamp{lamp}"), surfaces));
    lamps.collect()
}

/// Whether a frame with lamps has [`MOST_LAMPS`].
pub(super) fn has_many_lamps(knobs: &Knobs) -> bool {
    knobs.chance("lamps.are_many", 0.08)
}

/// Draws a lamp near the surface point of a random pixel.
fn draw_lamp(knobs: &Knobs, name: &str, surfaces: Surfaces<'_>) -> Value {
    let (width, height) = surfaces.range.size();
    let (x, y) = (
        knobs.whole(&format!("{name}.x"), 0, width - 1),
        knobs.whole(&format!("{name}.y"), 0, height - 1),
    );
    let surface = surfaces.point(x, y);
    // About two of three lamps are within 5 cm.
    let is_near = knobs.chance(&format!("{name}.is_near"), 0.65);
    let (least_m, most_m) = if is_near { (1e-3, 0.05) } else { (0.05, 100.0) };
    let away_m = knobs.log(&format!("{name}.away"), least_m, most_m);
    let offset = knobs.within_rgb(&format!("{name}.offset"), -1.0, 1.0);
    let position_m = [0, 1, 2].map(|axis| (surface[axis] + offset[axis] * away_m).clamp(-999.0, 999.0));
    // Most levels make the surface about as bright as white.
    let is_wild = knobs.chance(&format!("{name}.is_wild"), 0.2);
    let (least, most) = if is_wild { (1e-4, 1e4) } else { (1e-2, 10.0) };
    let level = knobs.log(&format!("{name}.level"), least, most);
    let intensity = knobs
        .within_rgb(&format!("{name}.tint"), 0.2, 1.0)
        .map(|tint| (tint * level * away_m * away_m).min(1e6));
    let mut lamp = json!({"kind": "point", "position_m": position_m, "intensity": intensity});
    lamp["radius_m"] = match knobs.chance(&format!("{name}.is_point"), 0.3) {
        true => json!(0.0),
        false => json!(knobs.log(&format!("{name}.radius"), 1e-3, 0.5)),
    };
    if knobs.chance(&format!("{name}.is_spot"), 0.5) {
        // The reference of a narrow cone needs many nodes.
        let narrowest_deg = if has_many_lamps(knobs) { 5.0 } else { 0.5 };
        let cone_deg = knobs.log(&format!("{name}.cone"), narrowest_deg, 90.0);
        // The axis misses the surface point by about the angle of the cone.
        let (sin, cos) = (cone_deg.to_radians() * knobs.within(&format!("{name}.turn"), 0.8, 1.2)).sin_cos();
        let [dx, dy, dz] = [0, 1, 2].map(|axis| surface[axis] - position_m[axis]);
        let direction = [dx * cos - dz * sin, dy, dx * sin + dz * cos];
        let longest = direction.into_iter().map(f64::abs).fold(1e-9, f64::max);
        lamp["kind"] = json!("spot");
        lamp["direction"] = json!(direction.map(|v| v / longest));
        lamp["cone_deg"] = json!(cone_deg);
    }
    lamp
}
