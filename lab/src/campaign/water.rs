//! Random waters: presets and free coefficients, all models of forward scatter, patches, snow, sediment and skies.

use imaging::geometry::Intrinsics;
use optics::preset::presets;
use optics::snow;
use serde_json::{Value, json};
use spec::Snow;

use super::knobs::Knobs;

/// Maximum visible particles; more would slow down the reference.
const MOST_PARTICLES: f64 = 3000.0;

/// Brightness of a derived veil.
const VEIL_GAIN: f64 = 0.3;

/// Whether the description sets the veil, which then replaces that of daylight.
pub(super) fn has_veil(knobs: &Knobs) -> bool {
    knobs.chance("water.has_veil", 0.5)
}

/// Optics, scale, holes and depth of a water.
pub(super) fn draw_water(knobs: &Knobs) -> Value {
    let mut optics = json!({"phase": knobs.pick("water.phase", &["ff", "hg"])});
    if knobs.chance("scatter.is_published", 0.5) {
        optics["forward_scatter"] = draw_scatter(knobs);
    }
    let is_free = knobs.chance("water.is_free", 0.4);
    if is_free {
        optics["absorption_per_m"] = json!(knobs.log_rgb("water.absorption", 0.01, 1.0));
        optics["scattering_per_m"] = json!(knobs.log_rgb("water.scattering", 0.01, 2.0));
        if knobs.chance("water.has_fraction", 0.4) {
            optics["backscatter_fraction"] = json!(knobs.log("water.fraction", 0.002, 0.5));
        }
    } else {
        optics["preset"] = json!(knobs.pick("water.preset", presets()).name);
    }
    let has_veil = has_veil(knobs);
    if has_veil {
        match is_free {
            true => optics["veiling_light"] = json!(knobs.log_rgb("water.veil", 0.002, 0.4)),
            false => optics["veil_gain"] = json!(draw_veil_gain(knobs)),
        }
    }
    let mut water = json!({"optics": optics, "range_scale": knobs.log("water.range_scale", 0.1, 3.0)});
    // A directional veil shows open water in holes.
    if has_veil && knobs.chance("water.fills_holes", 0.5) {
        water["holes"] = json!({"range_m": knobs.within("water.hole_m", 1.0, 31.0)});
    }
    if knobs.chance("water.is_deep", 0.4) {
        water["depth_m"] = json!(60.0 * knobs.unit("water.depth").powi(2));
    }
    water
}

fn draw_veil_gain(knobs: &Knobs) -> f64 {
    let is_free = knobs.chance("water.is_veil_free", 0.3);
    if is_free {
        knobs.log("water.veil_gain", 1e-3, 3.0)
    } else {
        VEIL_GAIN
    }
}

/// A published model of forward scatter.
fn draw_scatter(knobs: &Knobs) -> Value {
    let gathers = knobs.chance("scatter.gathers", 0.35);
    let mut scatter = json!({"model": if gathers { "simplified" } else { "jaffe" }});
    if knobs.chance("scatter.is_direct", 0.2) {
        scatter["source"] = json!("direct");
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

/// Snow from a few particles to the maximum of a description or of the reference.
pub(super) fn draw_snow(knobs: &Knobs, camera: &Intrinsics, size: (usize, usize)) -> Value {
    let near_m = knobs.log("snow.near", 0.05, 2.0);
    let mut law = Snow {
        density_per_m3: 1.0,
        near_m,
        far_m: (near_m * knobs.within("snow.reach", 1.1, 21.1)).min(100.0),
        radius_m: knobs.log("snow.radius", 1e-5, 0.02),
        spectrum: knobs.within("snow.spectrum", 1.5, 6.0),
        albedo: knobs.within_rgb("snow.albedo", 0.0, 1.0),
        ..Snow::with_density(0.0)
    };
    let most = MOST_PARTICLES / snow::expected(&law, snow::solid(camera, size));
    let most = most.min(snow::MOST_COVER / snow::cover(&law, 0.0)).min(1e6);
    law.density_per_m3 = 0.999 * most * knobs.log("snow.density", 1e-4, 1.0);
    let mut snow = json!({
        "density_per_m3": law.density_per_m3, "near_m": law.near_m, "far_m": law.far_m, "radius_m": law.radius_m,
        "spectrum": law.spectrum, "albedo": law.albedo,
    });
    if knobs.chance("snow.has_aggregates", 0.2) {
        snow["aggregates"] = json!(knobs.unit("snow.aggregates"));
    }
    if knobs.chance("snow.drifts", 0.2) {
        snow["drift_m_per_s"] = json!(knobs.within_rgb("snow.drift", -1.0, 1.0));
    }
    snow
}

/// Clouds of sediment. Their edges have no bound.
pub(super) fn draw_sediment(knobs: &Knobs) -> Value {
    json!({
        "extinction_per_m": knobs.log("sediment.extinction", 0.1, 30.0),
        "cover": knobs.unit("sediment.cover"),
        "height_m": knobs.log("sediment.height", 0.05, 2.0),
        "thrusters": knobs.whole("sediment.thrusters", 0, 2),
    })
}

/// A sky. Two of three are overcast: without a sun there are no shadows or caustics, which lack a bound.
pub(super) fn draw_sky(knobs: &Knobs) -> Value {
    let is_overcast = knobs.chance("sky.is_overcast", 0.66);
    let cloud_cover = if is_overcast {
        1.0
    } else {
        knobs.unit("sky.clouds")
    };
    json!({
        "sun_elevation_deg": knobs.within("sky.elevation", 5.0, 90.0),
        "sun_azimuth_deg": knobs.within("sky.azimuth", 0.0, 360.0),
        "cloud_cover": cloud_cover,
        "wind_m_per_s": knobs.within("sky.wind", 0.0, 20.0),
    })
}
