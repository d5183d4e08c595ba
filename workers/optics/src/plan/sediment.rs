//! Clouds of sediment in a plan.

use super::shares::sediment_share;
use super::{Form, Given, Stage, levels};
use crate::lamp;
use crate::sediment::{Clouds, FAR_M};

/// The clouds; left out where they can change no pixel by more than their share: where none is in view, or all are too thin.
/// Drawn, they have no bound: the edge of a cloud may be anywhere between the rays that are followed.
pub(super) fn drift(given: &Given<'_>) -> Option<Stage> {
    let clouds = given.setting.sediment.as_ref()?;
    let form = Form::asked_by(given.frame.fidelity);
    if form == Form::Reference {
        return Some(Stage::exact(form));
    }
    let share = sediment_share(given.frame);
    let effect = effect(given, clouds);
    let is_needless = effect <= share;
    Some(Stage {
        form: form.when(!is_needless),
        share: Some(share),
        bound: is_needless.then_some(effect),
    })
}

/// The most that clouds change of a pixel: its light, or what a cloud sends back of all light that there may be.
fn effect(given: &Given<'_>, clouds: &Clouds) -> f64 {
    let setting = given.setting;
    let (gain, above) = (setting.gain(), setting.daylight_at(setting.up.map(|v| FAR_M * v)));
    let lamps = setting.lighting.as_ref().map_or([0.0; 3], lamp::most_white);
    let color = clouds.albedo();
    let colors = [0, 1, 2].map(|i| color[i] * (gain[i] * above[i] + lamps[i]));
    let contrast = colors.into_iter().fold(levels::brightest_behind(given), f64::max);
    given.cloud_opacity * contrast
}
