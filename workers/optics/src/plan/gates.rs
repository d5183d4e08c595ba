//! Whether near objects have to stop the spread light of what is behind them.

use spec::Fidelity;

use super::scatter::largest_share;
use super::{SceneStats, Stage};
use crate::layering::Layering;
use crate::water::{Scatter, Water};

/// Gates are left out where that changes no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.25;

/// Gates of a frame.
#[derive(Debug, Clone, PartialEq)]
pub enum GateStep {
    /// Nothing hides anything, or what is stopped stays within its share.
    Skip,
    /// The gates of these layers.
    Gated(Layering),
    /// As the reference finds them, in f64.
    Reference,
}

impl GateStep {
    /// The layers, where their gates stop light.
    #[must_use]
    pub fn layering(&self) -> Option<&Layering> {
        match self {
            Self::Gated(layering) => Some(layering),
            Self::Skip | Self::Reference => None,
        }
    }
}

/// The gates of a frame that asks for them.
pub(super) fn choose(
    stats: &SceneStats,
    water: &Water,
    fidelity: Fidelity,
    tolerance: Option<f64>,
) -> Option<Stage<GateStep>> {
    let Scatter::Jaffe { layers: Some(_), .. } = water.scatter else {
        return None;
    };
    if fidelity == Fidelity::REFERENCE {
        return Some(Stage::exact(GateStep::Reference));
    }
    let Some(layering) = &stats.layering else {
        return Some(Stage::exact(GateStep::Skip));
    };
    let share = tolerance.map(|whole| SKIP_SHARE * whole);
    let stopped = (0..3).map(|channel| stopped(stats, water, channel, layering));
    let stopped = stopped.fold(0.0, f64::max);
    Some(if share.is_some_and(|share| stopped <= share) {
        Stage {
            form: GateStep::Skip,
            share,
            bound: Some(stopped),
        }
    } else {
        Stage {
            form: GateStep::Gated(layering.clone()),
            share,
            bound: None,
        }
    })
}

/// The most light of one channel that gates can move: all that is spread from behind the first. Without gates it falls on what is
/// before them as if nothing stood there, and what is hidden sends none around it.
fn stopped(stats: &SceneStats, water: &Water, channel: usize, layering: &Layering) -> f64 {
    let Scatter::Jaffe { g, .. } = water.scatter else {
        return 0.0;
    };
    let c = water.direct_attenuation[channel];
    let behind = layering.spans_m.iter().skip(1).flatten().map(|&(near, far)| {
        let light = brightest(stats, water, channel, (near, far));
        light * largest_share(g[channel].min(c), c, near, far)
    });
    behind.sum()
}

/// The most light of one channel between two ranges, before the water.
pub(super) fn brightest(stats: &SceneStats, water: &Water, channel: usize, (near, far): (f64, f64)) -> f64 {
    let bins = stats
        .bins
        .iter()
        .filter(|bin| bin.meters.1 >= near && bin.meters.0 <= far);
    let light = bins.map(|bin| f64::from(bin.brightest[channel]));
    light.fold(0.0, f64::max) * water.radiance_gain[channel]
}
