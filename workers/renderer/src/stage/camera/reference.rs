//! The optics of the camera in f64, for frames of reference fidelity.

use ::camera::defocus::Focus;
use ::camera::geometry::{coordinates_reference, resample_reference};
use ::camera::vignette::FallOff;
use ::camera::{defocus, exposure};
use imaging::{Plane, Rgb};
use spec::Metering;

use crate::inputs::camera::Taking;

/// Resamples a picture by the map of the lens.
pub(super) fn resample(taking: &Taking, light: &Rgb<f32>) -> Rgb<f32> {
    let Some(source) = &taking.parts.source else {
        return light.clone();
    };
    let wide = wide(light);
    let planes = [0, 1, 2].map(|channel| {
        let map = coordinates_reference(&taking.parts.lens, source, taking.parts.size, channel);
        resample_reference(&wide.planes()[channel], &map)
    });
    narrow(&Rgb::new(planes).expect("three planes of one map"))
}

/// Defocus blur.
pub(super) fn blur(picture: &Rgb<f32>, focus: &Focus, range: &Plane<f32>) -> Rgb<f32> {
    let radii = range.map(|&meters| focus.radius_px(f64::from(meters)));
    narrow(&defocus::blur_reference(&wide(picture), &radii))
}

/// The metered factor of a picture before its fall-off.
pub(super) fn metered(picture: &Rgb<f32>, falloff: Option<&FallOff>, metering: &Metering) -> f64 {
    exposure::metered_reference(&fallen(picture, falloff, 1.0), metering)
}

/// Vignette and exposure.
pub(super) fn expose(picture: &Rgb<f32>, falloff: Option<&FallOff>, gain: f64) -> Rgb<f32> {
    narrow(&fallen(picture, falloff, gain))
}

fn fallen(picture: &Rgb<f32>, falloff: Option<&FallOff>, gain: f64) -> Rgb<f64> {
    let factor = |x: usize, y: usize| gain * falloff.map_or(1.0, |falloff| falloff.factor(x, y));
    Rgb::from_fn(picture.width(), picture.height(), |x, y| {
        picture.pixel(x, y).map(|v| f64::from(v) * factor(x, y))
    })
}

fn wide(picture: &Rgb<f32>) -> Rgb<f64> {
    picture.map(|&v| f64::from(v))
}

fn narrow(picture: &Rgb<f64>) -> Rgb<f32> {
    picture.map(|&v| v as f32)
}
