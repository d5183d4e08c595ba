//! Marine snow in a plan.

use spec::Snow;

use super::shares::Shares;
use super::{Form, Given, Stage, levels};
use crate::{lamp, snow};

/// The snow; left out where it is expected to change less than its share.
pub(super) fn fall(given: &Given<'_>, shares: &Shares) -> Stage {
    let Some(law) = &given.setting.snow else {
        return Stage::exact(Form::Skip);
    };
    let form = Form::asked_by(given.frame.fidelity);
    let form = form.when(form == Form::Reference || !is_needless(given, law, shares.snow));
    Stage {
        form,
        share: Some(shares.snow),
        bound: match form {
            Form::Skip => Some(shares.snow),
            Form::Fast => Some(shares.snow + shares.snow_rounding),
            Form::Reference => None,
        },
    }
}

fn is_needless(given: &Given<'_>, law: &Snow, share: f64) -> bool {
    let Given { frame, setting, .. } = given;
    // The clearest patch lets the most through.
    let clearest = 1.0 - frame.water.turbidity.map_or(0.0, |patches| patches.contrast);
    let least = setting.attenuation().into_iter().fold(f64::INFINITY, f64::min) * clearest;
    let lamps = setting.lighting.as_ref().map_or([0.0; 3], lamp::most_white);
    let gain = setting.gain();
    let colors = [0, 1, 2].map(|i| law.albedo[i] * (gain[i] + lamps[i]));
    let contrast = colors.into_iter().fold(levels::brightest_behind(given), f64::max);
    snow::is_needless(law, setting.size.0 * setting.size.1, least, contrast, share)
}
