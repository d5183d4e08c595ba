//! The haze of the lights over the styled picture.

use std::borrow::Cow;

use imaging::Rgb;
use optics::plan::Form;

use super::{Shot, camera};

/// Adds the haze to a picture, which is returned uncopied where no light shines.
pub(crate) fn run<'a>(shot: &Shot<'_>, styled: &'a Rgb<f32>) -> Cow<'a, Rgb<f32>> {
    let haze = camera::haze_behind(shot.frame, shot.taking.is_some());
    match shot.plan.haze.form {
        Form::Skip => Cow::Borrowed(styled),
        Form::Fast | Form::Reference if haze.is_empty() => Cow::Borrowed(styled),
        Form::Fast | Form::Reference => Cow::Owned(optics::haze(styled.clone(), &haze)),
    }
}
