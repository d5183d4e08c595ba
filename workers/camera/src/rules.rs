//! Consistency rules within a camera, for the check of descriptions.

use imaging::geometry::Intrinsics;
use spec::{Camera, CameraRules, Fault};

use crate::parts::{Parts, PartsError, Scenery};
use crate::preset;

/// The rules of cameras.
pub const RULES: CameraRules = CameraRules { faults, readout_s };

/// The readout time of a camera, from its preset if it has one.
fn readout_s(camera: &Camera) -> f64 {
    preset::complete(camera).readout_s.unwrap_or(0.0)
}

/// The faults of a camera; `renders` is true if a scene is rendered for it.
fn faults(camera: &Camera, renders: bool) -> Vec<Fault> {
    let scenery = if renders {
        Scenery::Rendered
    } else {
        // An uploaded picture has its own size and focal length; use the described values as a stand-in.
        let (width, height) = (camera.width, camera.height);
        let water = Intrinsics::centered(camera.focal_px(width), width, height);
        Scenery::Picture(water, (width, height))
    };
    let Err(error) = Parts::resolve(camera, scenery) else {
        return Vec::new();
    };
    let path = match error {
        PartsError::Fold(_) | PartsError::TooWide => vec!["distortion"],
        PartsError::NoPath => vec!["path"],
        PartsError::TooSmall => vec!["sensor", "cfa"],
        PartsError::UnknownSensor => vec!["sensor", "preset"],
        PartsError::Bits(_) | PartsError::DeepJpeg(_) => vec!["bits"],
        PartsError::Black { .. } => vec!["sensor", "black_dn"],
    };
    vec![Fault {
        message: format!("`camera.{}`: {error}", path.join(".")),
        path,
        missing: false,
    }]
}
