//! Whether the veil has to depend on the direction.

use spec::Fidelity;

use super::{Form, SceneStats, Stage};
use crate::water::Water;

/// The veil stays constant where that changes no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;

/// The veil of a frame that asks for one by direction.
pub(super) fn choose(
    stats: &SceneStats,
    water: &Water,
    fidelity: Fidelity,
    tolerance: Option<f64>,
) -> Option<Stage> {
    let daylight = water.daylight().filter(|daylight| daylight.varies())?;
    let form = Form::asked_by(fidelity);
    if form == Form::Reference {
        return Some(Stage::exact(form));
    }
    let rises = daylight.gaze.rises;
    let most = |of: &dyn Fn(usize) -> f64| (0..3).map(of).fold(0.0, f64::max);
    let changed = most(&|channel| {
        let veil = water.varied_veil(channel);
        let span = stats.range_m.unwrap_or((0.0, 0.0));
        veil.map_or(0.0, |veil| veil.change(rises, span, stats.holes))
    });
    let rounding = most(&|channel| {
        let veil = water.varied_veil(channel);
        veil.map_or(0.0, |veil| veil.rounding(rises, stats.holes))
    });
    let share = tolerance.map(|whole| SKIP_SHARE * whole);
    let is_needless = share.is_some_and(|share| changed <= share);
    Some(Stage {
        form: form.when(!is_needless),
        share,
        bound: tolerance.map(|_| if is_needless { changed } else { rounding }),
    })
}
