//! Exposure that follows its metering over the frames of a sequence. A frame can still be rendered alone: earlier frames are metered
//! again, at a sixteenth of the sides and at one tolerance for any fidelity, so that the factor is known before the frame is
//! planned and is the same in its reference.

use ::camera::exposure::{lagging, metered};
use imaging::Rgb;
use spec::{Camera, Exposure, Fidelity, Frame};

use super::shutter::falloff;
use crate::context::FrameContext;

/// Ratio of the sides of the frame to those of the metered picture.
const SMALLER: usize = 16;
/// The tolerance of the metered pictures.
const TOLERANCE: f64 = 3e-4;
/// Multiple of the lag after which a metered value has a weight below one millionth.
const LAGS: f64 = 14.0;

/// The frames that determine the exposure of a frame, in order, ending with the frame.
pub(crate) fn metered_frames(frame: &Frame) -> Vec<Frame> {
    let camera = ::camera::preset::complete(&frame.camera);
    let (Some(Exposure::Auto(metering)), Some(path)) = (camera.exposure, camera.path) else {
        return Vec::new();
    };
    let reach = (LAGS * metering.lag_frames).ceil() as usize;
    let first = path.frame.saturating_sub(reach);
    let small = |position: usize| {
        let mut path = path;
        path.frame = position;
        Frame {
            camera: Camera {
                width: camera.width.div_ceil(SMALLER),
                height: camera.height.div_ceil(SMALLER),
                path: Some(path),
                motion: None,
                exposure_s: None,
                readout_s: None,
                sensor: None,
                preset: None,
                supersample: 1,
                defocus: None,
                jpeg: None,
                ..camera.clone()
            },
            artifacts: Vec::new(),
            fidelity: Fidelity::Tolerance(TOLERANCE),
            ..frame.clone()
        }
    };
    (first..=path.frame).map(small).collect()
}

/// The exposure of the next frame of a sequence, from the previous exposure and the light of its metered picture.
pub(crate) fn follow(context: &FrameContext<'_>, light: &Rgb<f32>, before: Option<f64>) -> Option<f64> {
    let exposure = context.taking.as_ref()?.parts.exposure?;
    let Exposure::Auto(metering) = exposure else {
        return None;
    };
    let now = metered(light, falloff(context), &metering);
    Some(match before {
        Some(before) => lagging(before, now, metering.lag_frames),
        None => now,
    })
}
