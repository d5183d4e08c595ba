//! Focus and exposure of the camera for drawing particles.

use ::camera::Parts;
use ::camera::defocus::Focus;
use ::camera::preset::EXPOSURE_S;
use optics::setting::Setting;
use optics::snow::{self, Flake, Seeing};
use spec::{Frame, Snow};

use super::movement::BLUR_SAMPLES;

/// The focus, time and exposure for drawing particles.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shutter {
    /// The focus of the lens, and the number of rendered pixels per camera pixel.
    focus: Option<(Focus, f64)>,
    exposure_s: f64,
    time_s: f64,
}

impl Shutter {
    /// The shutter of a frame's camera, `later` frames after the frame's time.
    pub(crate) fn new(frame: &Frame, parts: Option<&Parts>, later: f64) -> Self {
        let camera = ::camera::preset::complete(&frame.camera);
        // Each picture of a motion blur gets an equal part of the exposure.
        let exposure_s = match (camera.exposure_s, camera.path) {
            (Some(exposure_s), Some(_)) => exposure_s / BLUR_SAMPLES as f64,
            (Some(exposure_s), None) => exposure_s,
            (None, _) => EXPOSURE_S,
        };
        let scale = |parts: &Parts| {
            let shown = parts.lens.camera.focal_px * parts.lens.magnification();
            parts.source.map_or(1.0, |source| source.camera.focal_px / shown)
        };
        Self {
            focus: parts.and_then(|parts| Some((parts.focus?, scale(parts)))),
            exposure_s,
            time_s: match camera.path {
                Some(path) => (path.frame as f64 + later) / camera.frames_per_s,
                None => frame.stream_s.unwrap_or(0.0),
            },
        }
    }

    /// The particles in view, the farthest first.
    pub(crate) fn flakes(&self, setting: &Setting, law: &Snow, size: (usize, usize)) -> Vec<Flake> {
        let blur_px = |range_m: f64| {
            self.focus
                .map_or(0.0, |(focus, scale)| scale * focus.radius_px(range_m))
        };
        let seeing = Seeing {
            blur_px: &blur_px,
            exposure_s: self.exposure_s,
            time_s: self.time_s,
        };
        snow::flakes(&setting.eye, law, setting.world, size, &seeing)
    }
}
