//! Exposure that follows its metering over the frames of a sequence. A frame can still be rendered alone: what was metered before
//! is metered again, at a sixteenth of the sides.

use ::camera::exposure::{lagging, metered};
use imaging::Rgb;
use spec::{Camera, Exposure, Frame};

use super::shutter::falloff;
use crate::stage::Shot;

/// A small picture for metering: its sides over those of the frame.
const SMALLER: usize = 16;
/// What was metered this many times the lag before counts for less than a millionth.
const LAGS: f64 = 14.0;

/// The frames whose metering a frame depends on, in their order, itself the last.
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
                rolling: None,
                sensor: None,
                preset: None,
                supersample: None,
                defocus: None,
                jpeg: None,
                ..camera.clone()
            },
            artifacts: Vec::new(),
            ..frame.clone()
        }
    };
    (first..=path.frame).map(small).collect()
}

/// The exposure of the next frame of a sequence, from that before it and the light of its small picture.
pub(crate) fn followed(shot: &Shot<'_>, light: &Rgb<f32>, before: Option<f64>) -> Option<f64> {
    let exposure = shot.taking.as_ref()?.parts.exposure?;
    let Exposure::Auto(metering) = exposure else {
        return None;
    };
    let now = metered(light, falloff(shot), &metering);
    Some(match before {
        Some(before) => lagging(before, now, metering.lag_frames),
        None => now,
    })
}
