//! Random waters: presets and free coefficients, all forms of forward scatter, patches, snow and daylight without shadows.

use imaging::geometry::Intrinsics;
use optics::preset::presets;
use optics::snow;
use serde_json::{Value, json};
use spec::Snow;

use super::knobs::Knobs;

/// Most particles in view. The reference is slow with more.
const MOST_PARTICLES: f64 = 3000.0;

/// Optics, scale, holes and depth of a water.
pub(super) fn draw_water(knobs: &Knobs) -> Value {
    let is_free = knobs.chance("water.is_free", 0.4);
    let mut optics = json!({"forward_scatter": draw_scatter(knobs)});
    if is_free {
        optics["absorption_per_m"] = json!(knobs.log_rgb("water.absorption", 0.01, 1.0));
        optics["scattering_per_m"] = json!(knobs.log_rgb("water.scattering", 0.01, 2.0));
        optics["veiling_light"] = json!(knobs.log_rgb("water.veil", 0.002, 0.4));
    } else {
        optics["preset"] = json!(knobs.pick("water.preset", presets()).name);
        if knobs.chance("water.is_veil_free", 0.3) {
            optics["veil_gain"] = json!(knobs.log("water.veil_gain", 1e-3, 3.0));
        }
    }
    let mut water = json!({"optics": optics, "range_scale": knobs.log("water.range_scale", 0.1, 3.0)});
    if knobs.chance("water.fills_holes", 0.3) {
        water["holes"] = json!({"range_m": knobs.within("water.hole_m", 1.0, 31.0)});
    }
    if !is_free && knobs.chance("water.is_deep", 0.4) {
        water["depth_m"] = json!(60.0 * knobs.unit("water.depth").powi(2));
        water["ambient"] = json!(knobs.pick("water.ambient", &["absolute", "exposed"]));
    }
    water
}

fn draw_scatter(knobs: &Knobs) -> Value {
    let gathers = knobs.chance("scatter.gathers", 0.35);
    let mut scatter = json!({"model": if gathers { "simplified" } else { "jaffe" }});
    if knobs.chance("scatter.is_direct", 0.2) {
        scatter["source"] = json!("direct");
    }
    if !gathers && knobs.chance("scatter.is_gated", 0.3) {
        scatter["occlusion"] = json!("gated");
        scatter["layers"] = json!(knobs.whole("scatter.layers", 1, 4));
    }
    if !gathers && knobs.chance("scatter.is_double", 0.25) {
        scatter["spread"] = json!("two");
        scatter["law"] = json!(knobs.pick("scatter.law", &["ff", "hg"]));
        return scatter;
    }
    if knobs.chance("scatter.is_free", 0.6) {
        scatter["spread_px_per_m"] = json!(knobs.log_rgb("scatter.spread", 0.01, 3.0));
        if knobs.chance("scatter.has_offset", 0.5) {
            scatter["spread_offset_px"] = json!(knobs.log_rgb("scatter.offset", 0.02, 2.0));
        }
    }
    scatter
}

/// Patches of turbidity.
pub(super) fn draw_patches(knobs: &Knobs) -> Value {
    json!({
        "contrast": knobs.within("patches.contrast", 0.05, 0.95),
        "scale_m": knobs.log("patches.scale", 0.1, 100.0),
    })
}

/// Snow from a few particles to the most that a description or the reference can have.
pub(super) fn draw_snow(knobs: &Knobs, camera: &Intrinsics, size: (usize, usize)) -> Value {
    let near_m = knobs.log("snow.near", 0.05, 2.0);
    let mut law = Snow {
        density_per_m3: 1.0,
        near_m,
        far_m: (near_m * knobs.within("snow.reach", 1.1, 21.1)).min(100.0),
        radius_m: knobs.log("snow.radius", 1e-5, 0.02),
        radius_spread: knobs.unit("snow.spread"),
        albedo: knobs.within_rgb("snow.albedo", 0.0, 1.0),
        ..Snow::of(0.0)
    };
    let most = MOST_PARTICLES / snow::expected(&law, snow::solid(camera, size));
    let most = most.min(snow::MOST_COVER / snow::cover(&law, 0.0)).min(1e6);
    law.density_per_m3 = 0.999 * most * knobs.log("snow.density", 1e-4, 1.0);
    let mut snow = json!({
        "density_per_m3": law.density_per_m3, "near_m": law.near_m, "far_m": law.far_m, "radius_m": law.radius_m,
        "radius_spread": law.radius_spread, "albedo": law.albedo,
    });
    if knobs.chance("snow.has_discs", 0.3) {
        snow["discs"] = json!("lens");
    }
    snow
}

/// Daylight by the depth or slope of surfaces, without shadows.
pub(super) fn draw_daylight(knobs: &Knobs, is_albedo: bool) -> Value {
    let mut above = json!({"veil": knobs.pick("above.veil", &["constant", "field", "physical"])});
    if knobs.chance("above.is_absolute", 0.5) {
        above["level"] = json!("absolute");
    }
    if knobs.chance("above.is_free", 0.4) {
        above["p"] = json!(knobs.within_rgb("above.p", 0.0, 3.0));
        above["q"] = json!(knobs.within_rgb("above.q", -1.0, 1.0));
    }
    if is_albedo {
        above["surfaces"] = json!("normal");
        above["sun_share"] = json!(knobs.unit("above.sun_share"));
        above["sun"] = json!({
            "elevation_deg": knobs.within("above.elevation", 5.0, 90.0),
            "azimuth_deg": knobs.within("above.azimuth", 0.0, 360.0),
            "shadow": "none",
        });
    } else if knobs.chance("above.is_deep", 0.5) {
        above["surfaces"] = json!("depth");
    }
    above
}
