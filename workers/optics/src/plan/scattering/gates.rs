//! Whether near objects must occlude spread light from behind.

use spec::Fidelity;

use crate::layering::Layering;
use crate::plan::terms::largest_share;
use crate::plan::{ErrorBound, SceneBounds, Stage, StageId, Variant};
use crate::water::{Scatter, Water};

/// Gates are omitted if their effect is at most this part of the tolerance.
const SKIP_SHARE: f64 = 0.25;

/// The gates of a frame that requests them.
pub(crate) fn assess(
    bounds: &SceneBounds,
    water: &Water,
    fidelity: Fidelity,
    tolerance: Option<f64>,
) -> Option<Stage> {
    let Scatter::Jaffe { layers: Some(_), .. } = water.scatter else {
        return None;
    };
    if fidelity == Fidelity::Reference {
        return Some(Stage::new(StageId::Occlusion, Variant::Reference));
    }
    let Some(layering) = &bounds.layering else {
        return Some(Stage {
            note: Some("nothing occludes anything".to_owned()),
            ..Stage::skipped(StageId::Occlusion)
        });
    };
    let share = tolerance.map(|whole| SKIP_SHARE * whole);
    let stopped = (0..3).map(|channel| stopped(bounds, water, channel, layering));
    let stopped = stopped.fold(0.0, f64::max);
    let stage = if share.is_some_and(|share| stopped <= share) {
        Stage {
            bound: Some(ErrorBound::absolute(stopped)),
            note: Some("the light that gates would stop is within its share".to_owned()),
            ..Stage::skipped(StageId::Occlusion)
        }
    } else {
        let gates: Vec<String> = (layering.gates_m.iter())
            .map(|gate| format!("{gate:.3} m"))
            .collect();
        Stage {
            terms: Some(layering.count()),
            note: Some(format!("gates at {}", gates.join(", "))),
            ..Stage::new(StageId::Occlusion, Variant::Gated(layering.clone()))
        }
    };
    Some(Stage { share, ..stage })
}

/// Upper bound of the light of one channel that gates can move: all spread light from behind the first gate. Without gates it
/// reaches the objects in front as if they were absent, and occluded surfaces add none around them.
fn stopped(bounds: &SceneBounds, water: &Water, channel: usize, layering: &Layering) -> f64 {
    let Scatter::Jaffe { g, .. } = water.scatter else {
        return 0.0;
    };
    let c = water.direct_attenuation[channel];
    let behind = layering.spans_m.iter().skip(1).flatten().map(|&(near, far)| {
        let light = brightest(bounds, water, channel, (near, far));
        light * largest_share(g[channel].min(c), c, near, far)
    });
    behind.sum()
}

/// The most light of one channel between two ranges, before the water.
pub(crate) fn brightest(bounds: &SceneBounds, water: &Water, channel: usize, (near, far): (f64, f64)) -> f64 {
    let bins = bounds
        .bins
        .iter()
        .filter(|bin| bin.meters.1 >= near && bin.meters.0 <= far);
    let light = bins.map(|bin| f64::from(bin.brightest[channel]));
    light.fold(0.0, f64::max) * water.radiance_gain[channel]
}
