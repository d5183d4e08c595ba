//! The haze of the lights over the styled picture.

use std::borrow::Cow;

use imaging::Rgb;
use spec::Haze;

/// Lays the lights over a picture; without a light that shines it passes through uncopied.
pub(crate) fn run<'a>(styled: &'a Rgb<f32>, lights: &[Haze]) -> Cow<'a, Rgb<f32>> {
    if lights.iter().any(Haze::shines) {
        Cow::Owned(optics::haze(styled.clone(), lights))
    } else {
        Cow::Borrowed(styled)
    }
}
