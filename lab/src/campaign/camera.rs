//! Random cameras: exposure, fall-off, lens and port, defocus, tone and movement.

use serde_json::{Value, json};

use super::knobs::Knobs;

/// A pinhole camera with these sides.
pub(super) fn draw_pinhole(knobs: &Knobs, (width, height): (usize, usize)) -> Value {
    json!({"width": width, "height": height, "hfov_deg": knobs.log("camera.hfov", 5.0, 150.0)})
}

/// Adds the parts of a real camera except movement.
pub(super) fn add_parts(knobs: &Knobs, camera: &mut Value) {
    if let Some(exposure) = draw_exposure(knobs) {
        camera["exposure"] = exposure;
    }
    if knobs.chance("camera.has_vignette", 0.4) {
        camera["vignette"] = draw_vignette(knobs);
    }
    if knobs.chance("camera.has_distortion", 0.25) {
        camera["distortion"] = draw_distortion(knobs);
    }
    if knobs.chance("camera.has_port", 0.25) {
        camera["port"] = draw_port(knobs);
    }
    if knobs.chance("camera.has_defocus", 0.35) {
        camera["defocus"] = json!({
            "aperture_m": knobs.log("defocus.aperture", 1e-4, 0.1),
            "focus_m": knobs.log("defocus.focus", 0.05, 100.0),
        });
    }
    if knobs.chance("camera.has_tone", 0.4) {
        camera["tone"] = match knobs.chance("tone.is_linear", 0.5) {
            true => json!("linear"),
            false => json!({"gamma": knobs.log("tone.gamma", 0.2, 5.0)}),
        };
    }
}

/// A fixed factor from 0.01 to 1000, metering, or none.
fn draw_exposure(knobs: &Knobs) -> Option<Value> {
    match knobs.unit("camera.exposure") {
        kind if kind < 0.15 => None,
        kind if kind < 0.55 => Some(json!({"fixed": knobs.log("exposure.fixed", 1e-2, 1e3)})),
        _ => Some(json!({"auto": draw_metering(knobs)})),
    }
}

/// Metering at any percentile.
pub(super) fn draw_metering(knobs: &Knobs) -> Value {
    let percentile = match knobs.unit("metering.kind") {
        kind if kind < 0.1 => 0.01,
        kind if kind < 0.2 => 0.999,
        _ => knobs.within("metering.percentile", 0.01, 0.999),
    };
    json!({"target": knobs.log("metering.target", 0.01, 4.0), "percentile": percentile})
}

fn draw_vignette(knobs: &Knobs) -> Value {
    let mut vignette = json!({"v": knobs.unit("vignette.v")});
    if knobs.chance("vignette.is_free", 0.6) {
        // A third reach the limits of the description, where light can increase towards the corners.
        let reach = [0.3, 1.0][usize::from(knobs.chance("vignette.is_limit", 0.33))];
        let v2 = knobs.within("vignette.term", -1.2 * reach, 1.2 * reach);
        vignette["v2"] = json!(v2.clamp(-1.0, 1.0));
    }
    vignette
}

fn draw_distortion(knobs: &Knobs) -> Value {
    let [k1, k2, k3] = knobs.within_rgb("distortion.radial", -0.15, 0.15);
    let [p1, p2, _] = knobs.within_rgb("distortion.tangential", -0.02, 0.02);
    json!({"k1": k1, "k2": k2 / 4.0, "k3": k3 / 16.0, "p1": p1, "p2": p2})
}

fn draw_port(knobs: &Knobs) -> Value {
    if knobs.chance("port.is_dome", 0.25) {
        return json!({"kind": "dome", "radius_m": knobs.log("port.radius", 0.02, 1.0)});
    }
    json!({"kind": "flat"})
}

/// Adds the movement of an uploaded picture.
pub(super) fn add_shift(knobs: &Knobs, camera: &mut Value) {
    let [x, y, _] = knobs.within_rgb("motion.shift", -12.0, 12.0);
    camera["motion"] = json!({"x_px": x, "y_px": y});
}

/// Adds a path past a procedural scene, with a few moments per frame, or lagging metering.
pub(super) fn add_path(knobs: &Knobs, camera: &mut Value) {
    let frames = knobs.whole("path.frames", 2, 40);
    camera["path"] = json!({
        "frames": frames,
        "frame": knobs.whole("path.frame", 0, frames - 1),
        "sway_m": knobs.within("path.sway", 0.0, 0.1),
        "sway_deg": knobs.within("path.turn", 0.0, 4.0),
    });
    if knobs.chance("path.moves", 0.5) {
        camera["exposure_s"] = json!(knobs.log("motion.exposure", 1e-3, 0.3));
    } else if knobs.chance("path.rolls", 0.4) {
        camera["readout_s"] = json!(knobs.within("rolling.readout", 0.0, 0.2));
    }
    if knobs.chance("path.lags", 0.5) {
        let mut metering = draw_metering(knobs);
        metering["lag_frames"] = json!(knobs.log("metering.lag", 0.1, 3.0));
        camera["exposure"] = json!({"auto": metering});
    }
}
