//! The optics of the camera in f64, for frames that ask for the reference.

use ::camera::geometry::{coordinates_reference, resample_reference};
use ::camera::vignette::FallOff;
use ::camera::{defocus, exposure};
use imaging::Rgb;
use spec::Metering;

use super::Taking;
use crate::stage::Shot;

/// Geometry and defocus.
pub(super) fn gather(shot: &Shot<'_>, taking: &Taking, light: &Rgb<f32>) -> Rgb<f32> {
    let mut picture = wide(light);
    if let Some(source) = &taking.parts.source {
        let planes = [0, 1, 2].map(|channel| {
            let map = coordinates_reference(&taking.parts.lens, source, taking.parts.size, channel);
            resample_reference(&picture.planes()[channel], &map)
        });
        picture = Rgb::new(planes).expect("three planes of one map");
    }
    if let (true, Some(focus), Some(range)) = (taking.plan.defocus, taking.parts.focus, shot.range()) {
        let radii = range.map(|&meters| focus.radius_px(f64::from(meters)));
        picture = defocus::blur_reference(&picture, &radii);
    }
    let picture = narrow(&picture);
    match taking.shift_px {
        Some(shift) => super::shutter::shifted(&picture, shift),
        None => picture,
    }
}

/// The factor that meters a picture before its fall-off.
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
