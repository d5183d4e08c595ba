//! The haze of the lights over the styled picture.

use std::borrow::Cow;

use imaging::Rgb;
use optics::HazeLight;
use spec::Frame;

/// Lays the lights over a picture; without a light that shines it passes through uncopied.
pub(crate) fn run<'a>(frame: &Frame, styled: &'a Rgb<f32>, lights: &[HazeLight]) -> Cow<'a, Rgb<f32>> {
    if lights.iter().any(HazeLight::shines) {
        Cow::Owned(optics::haze(styled.clone(), lights, spec::haze_space(frame)))
    } else {
        Cow::Borrowed(styled)
    }
}
