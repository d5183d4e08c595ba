//! How much of a picture gates would change, before any light is computed.

use imaging::{Plane, Rgb};
use spec::Fidelity;

use super::{Plan, SceneBounds, TileGains};
use crate::chain;
use crate::forward_scatter::KernelCache;
use crate::layering::Layering;
use crate::water::{Scatter, Spread, Water};

/// Longer side of the picture that is rendered for the estimate, pixels.
const LONGER_PX: usize = 96;
/// Kernels of it.
const TERMS: usize = 3;

/// A scene that enters the water.
#[derive(Debug, Clone, Copy)]
pub struct GateScene<'a> {
    /// Light of the scene, linear.
    pub radiance: &'a Rgb<f32>,
    /// Factors of light that is still to come; `None` if the scene is lit.
    pub gains: Option<&'a TileGains>,
    /// Range along the ray in meters.
    pub range: &'a Plane<f32>,
    /// A water with occlusion-aware forward scatter.
    pub water: &'a Water,
}

/// Estimates the share of pixels, 0 to 1, that gates change by more than `least` in some channel of linear light. Every n-th pixel of the
/// frame is rendered with and without gates, n such that the longer side has about 96 pixels, with kernels narrower by n. Objects
/// narrower than n pixels are seen in part. 0 without gates and without an occlusion edge; 1 if the scene cannot be rendered.
#[must_use]
pub fn estimate_gate_change(scene: &GateScene<'_>, least: f64) -> f64 {
    let Scatter::Jaffe {
        layers: Some(most), ..
    } = scene.water.scatter
    else {
        return 0.0;
    };
    let step = scene
        .range
        .width()
        .max(scene.range.height())
        .div_ceil(LONGER_PX)
        .max(1);
    let range = subsampled(scene.range.size(), step, |x, y| scene.range.pixel(x, y));
    if Layering::find(&range, most).is_none() {
        return 0.0;
    }
    let lit = |channel: usize| {
        subsampled(scene.range.size(), step, |x, y| {
            let gain = scene.gains.map_or(1.0, |gains| gains.tile_gain(x, y)[channel]);
            gain * scene.radiance.planes()[channel].pixel(x, y)
        })
    };
    let radiance = Rgb::new([lit(0), lit(1), lit(2)]).expect("planes of one frame");
    let gated = narrowed(scene.water, step, Some(most));
    let plain = narrowed(scene.water, step, None);
    let images = [gated, plain].map(|water| render(&radiance, &range, &water));
    let [Some(gated), Some(plain)] = images else {
        return 1.0;
    };
    changed_share(&gated, &plain, least)
}

/// Every `step`-th pixel of a frame, from the middle of the first step on.
fn subsampled<T: Copy>(
    (width, height): (usize, usize),
    step: usize,
    pixel: impl Fn(usize, usize) -> T,
) -> Plane<T> {
    let middle = |i: usize, side: usize| (i * step + step / 2).min(side - 1);
    Plane::from_fn(width.div_ceil(step), height.div_ceil(step), |x, y| {
        pixel(middle(x, width), middle(y, height))
    })
}

/// The same water in front of a lens with a focal length of `step` times fewer pixels.
fn narrowed(water: &Water, step: usize, most_layers: Option<usize>) -> Water {
    let factor = 1.0 / step as f64;
    let narrow = |spread: &mut Spread| {
        spread.offset_px = spread.offset_px.map(|px| px * factor);
        spread.per_m = spread.per_m.map(|px| px * factor);
    };
    let mut water = water.clone();
    if let Scatter::Jaffe {
        spread, tail, layers, ..
    } = &mut water.scatter
    {
        narrow(spread);
        if let Some(tail) = tail {
            narrow(&mut tail.spread);
        }
        *layers = most_layers;
    }
    water
}

fn render(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> Option<Rgb<f32>> {
    let bounds = SceneBounds::measure(radiance, range, water);
    let plan = Plan::for_water(&bounds, water, Fidelity::Terms(TERMS));
    let layers = chain::water(radiance, range, water, &plan, &mut KernelCache::new());
    Some(layers.ok()?.scattered)
}

fn changed_share(one: &Rgb<f32>, other: &Rgb<f32>, least: f64) -> f64 {
    let (width, height) = one.size();
    let mut changed = 0;
    for y in 0..height {
        for x in 0..width {
            let pairs = one.pixel(x, y).into_iter().zip(other.pixel(x, y));
            let change = pairs.map(|(one, other)| f64::from((one - other).abs()));
            changed += usize::from(change.fold(0.0, f64::max) > least);
        }
    }
    changed as f64 / (width * height).max(1) as f64
}

#[cfg(test)]
mod tests;
