//! The veil of daylight, which depends on the direction.

use spec::Fidelity;

use super::{SceneBounds, Stage, StageId, Variant};
use crate::water::Water;

/// The veil that depends on the direction.
pub(crate) const BY_DIRECTION: &str = "by_direction";

/// The veil of a frame in daylight.
pub(super) fn assess(bounds: &SceneBounds, water: &Water, fidelity: Fidelity) -> Option<Stage> {
    let daylight = water.daylight()?;
    if fidelity == Fidelity::Reference {
        return Some(Stage::new(StageId::Veil, Variant::Reference));
    }
    let rises = daylight.gaze.rises;
    let roundings =
        (0..3).filter_map(|channel| Some(water.varied_veil(channel)?.rounding(rises, bounds.holes)));
    let stage = Stage {
        bound: roundings.max_by(|one, other| one.up_to_white().total_cmp(&other.up_to_white())),
        ..Stage::new(StageId::Veil, Variant::Fast(BY_DIRECTION))
    };
    Some(stage.costing(VEIL_NS, bounds.pixels))
}

pub(super) const VEIL_NS: f64 = 20.0;
