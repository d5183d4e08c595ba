//! Attenuation, veil, occlusion and forward scatter: the variants that a tolerance needs.

use spec::{Fidelity, ScatterSource};

use super::terms::{PILED_UP, ScatterNeed, largest_share};
use super::{ErrorBound, Gain, SceneBounds, Stage, StageId, Variant, gates, levels, scatter, veil};
use crate::layering::Layering;
use crate::water::{Scatter, Water};

/// Attenuation is omitted if its effect is at most this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;
/// Minimum share of the tolerance reserved for forward scatter.
const LEAST_SHARE: f64 = 0.125;
/// Nanoseconds per pixel, fitted to 32 frames of all sites at 768×492 on one core of an AMD EPYC with AVX-512, while other programs
/// used the caches: attenuation, each transformed channel of a layer, each of its kernels, and each gate of a channel.
const ATTENUATION_NS: f64 = 3.0;
const CHANNEL_NS: f64 = 14.0;
const KERNEL_NS: f64 = 2.7;
const GATE_NS: f64 = 17.0;

/// The stages of the water for the absolute error that they may make together; `None` for kernels of a given number and for
/// the reference.
#[must_use]
pub fn assess_water(
    bounds: &SceneBounds,
    water: &Water,
    fidelity: Fidelity,
    share: Option<f64>,
) -> Vec<Stage> {
    let mut attenuation = assess_attenuation(bounds, water, fidelity, share);
    let mut stages = Vec::new();
    let mut used = used_by(&attenuation, share);
    let veil = veil::assess(bounds, water, fidelity);
    used += veil.as_ref().map_or(0.0, |stage| used_by(stage, share));
    let mut gates = gates::assess(bounds, water, fidelity, share);
    used += gates.as_ref().map_or(0.0, |stage| used_by(stage, share));
    let scatter = assess_scatter(
        bounds,
        water,
        fidelity,
        &Shares {
            gates: gates.as_ref(),
            share,
            used,
        },
    );
    if let Some(gates) = &mut gates
        && matches!(gates.variant, Variant::Gated(_))
        && scatter.iter().all(|stage| stage.variant.kernels().is_none())
    {
        // All light stays on its pixel, so gates have no effect.
        gates.variant = Variant::Skip;
        gates.note = Some("no light leaves its pixel".to_owned());
    }
    attenuation.gain = water_gain(bounds, water);
    stages.push(attenuation);
    stages.extend(veil);
    stages.extend(gates);
    stages.extend(scatter);
    stages
}

/// Gain of errors of the light on surfaces: direct transmittance of the nearest surface, and spread light that may pile up.
#[must_use]
pub fn water_gain(bounds: &SceneBounds, water: &Water) -> Gain {
    let Some((nearest, farthest)) = bounds.range_m else {
        return Gain::ONE;
    };
    let gains = (0..3).map(|channel| {
        let c = water.direct_attenuation[channel];
        let direct = (-c * nearest).exp();
        let spread = match water.scatter {
            Scatter::None | Scatter::Simplified { .. } => 0.0,
            Scatter::Jaffe {
                source: ScatterSource::Direct,
                ..
            } => PILED_UP * direct,
            Scatter::Jaffe { g, .. } => PILED_UP * largest_share(g[channel].min(c), c, nearest, farthest),
        };
        (direct + spread) * water.radiance_gain[channel]
    });
    Gain::factor(gains.fold(0.0, f64::max))
}

fn used_by(stage: &Stage, share: Option<f64>) -> f64 {
    match share {
        Some(_) => stage.bound.unwrap_or_default().up_to_white(),
        None => 0.0,
    }
}

/// Attenuation. Its bound is the rounding of all of the water, and its effect if it is left out.
fn assess_attenuation(bounds: &SceneBounds, water: &Water, fidelity: Fidelity, share: Option<f64>) -> Stage {
    if fidelity == Fidelity::Reference {
        return Stage::new(StageId::Attenuation, Variant::Reference);
    }
    let lost = [0, 1, 2].map(|channel| levels::attenuation_effect(bounds, water, channel));
    let lost = lost.into_iter().fold(0.0, f64::max);
    let rounding = levels::rounding(bounds, water);
    let is_clear = share.is_some_and(|whole| lost <= SKIP_SHARE * whole);
    let stage = Stage {
        bound: Some(if is_clear {
            rounding.plus(ErrorBound::absolute(lost))
        } else {
            rounding
        }),
        ..Stage::new(
            StageId::Attenuation,
            if is_clear {
                Variant::Skip
            } else {
                Variant::Fast("f32")
            },
        )
    };
    stage.costing(ATTENUATION_NS, bounds.pixels)
}

/// Error budget of forward scatter.
struct Shares<'a> {
    gates: Option<&'a Stage>,
    share: Option<f64>,
    /// By the other stages of the water.
    used: f64,
}

fn assess_scatter(
    bounds: &SceneBounds,
    water: &Water,
    fidelity: Fidelity,
    shares: &Shares<'_>,
) -> [Stage; 3] {
    let layering = shares.gates.and_then(|stage| match &stage.variant {
        Variant::Gated(layering) => Some(layering),
        _ => None,
    });
    [0, 1, 2].map(|channel| {
        let own = shares
            .share
            .map(|whole| (whole - shares.used).max(LEAST_SHARE * whole));
        let need = ScatterNeed {
            bounds,
            water,
            channel,
            layering,
        };
        let (variant, bound) = scatter::choose(&need, fidelity, own.unwrap_or(0.0));
        let ns = scatter_ns(&variant, layering);
        let stage = Stage {
            terms: variant.kernels(),
            share: own,
            bound: Some(ErrorBound::absolute(own.and(bound).unwrap_or(0.0))),
            ..Stage::new(StageId::ForwardScatter(channel as u8), variant)
        };
        stage.costing(ns, bounds.pixels)
    })
}

/// Expected cost of the gates of a frame of this many layers, ns per pixel.
#[must_use]
pub fn occlusion_ns(layers: usize) -> f64 {
    3.0 * (CHANNEL_NS + GATE_NS) * layers.saturating_sub(1) as f64
}

fn scatter_ns(variant: &Variant, layering: Option<&Layering>) -> f64 {
    let Some(terms) = variant.kernels() else {
        return 0.0;
    };
    let layers = layering.map_or(1.0, |layering| layering.count() as f64);
    CHANNEL_NS * layers + KERNEL_NS * terms as f64 + GATE_NS * (layers - 1.0)
}
