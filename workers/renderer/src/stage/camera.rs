//! The camera: port, lens and exposure before the style, the sensor after it.

mod assess;
mod develop;
mod lag;
mod metering;
mod reference;
mod shutter;

pub(crate) use assess::{assess_electronics, assess_optics};
pub(crate) use develop::{Developed, develop};
pub(crate) use lag::{follow, metered_frames};
pub(crate) use metering::{Expected, expect_factor, thin_frame, thin_scene};
pub(crate) use shutter::{expose, gather};

use std::borrow::Cow;

use imaging::Rgb;
use optics::medium::Surroundings;
use spec::{Exposure, Frame, Haze, HazeSpace, Metering};

/// The haze in front of a camera. Without a camera, and in code space, haze is applied after the style.
pub(crate) fn haze_before(frame: &Frame) -> Vec<Haze> {
    let is_linear = |haze: &Haze| haze.space == HazeSpace::Linear;
    frame.haze().into_iter().filter(is_linear).collect()
}

/// The haze applied after the style.
pub(crate) fn haze_behind(frame: &Frame, has_camera: bool) -> Vec<Haze> {
    let comes = |haze: &Haze| !has_camera || haze.space == HazeSpace::Display;
    frame.haze().into_iter().filter(comes).collect()
}

/// Completes an unspecified exposure: it is metered if lamps are the only light of a scene of reflectance.
pub(crate) fn complete(frame: &Frame) -> Cow<'_, Frame> {
    let camera = ::camera::preset::complete(&frame.camera);
    let mut completed = Cow::Borrowed(frame);
    let surroundings = Surroundings::of_frame(frame);
    let is_lamplit =
        surroundings.has_lamps && surroundings.is_reflectance && surroundings.is_night(frame.water.depth_m);
    if is_lamplit && camera.exposure.is_none() {
        completed.to_mut().camera.exposure = Some(Exposure::Auto(Metering::default()));
    }
    completed
}

/// Errors of exposed light hidden by the noise of the sensor: a third of its smallest noise; 0 without a sensor.
pub(crate) fn hidden_error(frame: &Frame) -> f64 {
    let camera = ::camera::preset::complete(&frame.camera);
    let sensor = camera
        .sensor
        .as_ref()
        .and_then(|sensor| ::camera::preset::sensor(sensor, camera.exposure_s));
    sensor.map_or(0.0, |sensor| sensor.tolerance().min(1.0))
}

/// A running average of pictures, each added to some rows.
pub(crate) struct Average {
    sums: Rgb<f32>,
}

impl Average {
    pub(crate) fn new((width, height): (usize, usize)) -> Self {
        Self {
            sums: Rgb::from_fn(width, height, |_, _| [0.0; 3]),
        }
    }

    /// Adds rows of a picture with a weight.
    pub(crate) fn add(&mut self, picture: &Rgb<f32>, rows: &std::ops::Range<usize>, weight: f64) {
        let width = picture.width();
        let part = rows.start * width..rows.end * width;
        for (sums, plane) in self.sums.planes_mut().into_iter().zip(picture.planes()) {
            let pairs = sums[part.clone()].iter_mut().zip(&plane.data()[part.clone()]);
            pairs.for_each(|(sum, &v)| *sum += weight as f32 * v);
        }
    }

    pub(crate) fn finish(self) -> Rgb<f32> {
        self.sums
    }
}
