//! Whether the veil has to depend on the direction.

use spec::Fidelity;

use super::water::VEIL_NS;
use super::{ErrorBound, SceneBounds, Stage, StageId, Variant};
use crate::water::Water;

/// The veil stays constant if that changes no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;

/// The veil of a frame that asks for one by direction.
pub(super) fn assess(
    bounds: &SceneBounds,
    water: &Water,
    fidelity: Fidelity,
    tolerance: Option<f64>,
) -> Option<Stage> {
    let daylight = water.daylight().filter(|daylight| daylight.varies())?;
    if fidelity == Fidelity::Reference {
        return Some(Stage::new(StageId::Veil, Variant::Reference));
    }
    let rises = daylight.gaze.rises;
    let span = bounds.range_m.unwrap_or((0.0, 0.0));
    let veils = || (0..3).filter_map(|channel| water.varied_veil(channel));
    let changed = veils().map(|veil| veil.change(rises, span, bounds.holes));
    let rounding = veils().map(|veil| veil.rounding(rises, bounds.holes));
    let changed = changed.fold(0.0, f64::max);
    let share = tolerance.map(|whole| SKIP_SHARE * whole);
    let is_constant = share.is_some_and(|share| changed <= share);
    let stage = Stage {
        share,
        bound: Some(ErrorBound::absolute(if is_constant {
            changed
        } else {
            rounding.fold(0.0, f64::max)
        })),
        note: is_constant.then(|| "a constant veil differs by no more than its share".to_owned()),
        ..Stage::new(
            StageId::Veil,
            Variant::Fast(if is_constant { CONSTANT } else { BY_DIRECTION }),
        )
    };
    Some(stage.costing(if is_constant { 0.0 } else { VEIL_NS }, bounds.pixels))
}

/// The constant veil, which attenuation adds.
const CONSTANT: &str = "constant";
/// The veil that depends on the direction.
pub(crate) const BY_DIRECTION: &str = "by_direction";
