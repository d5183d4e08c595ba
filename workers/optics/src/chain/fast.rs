//! The chain in f32 with the fast forward scatter.

use imaging::Plane;
use imaging::simd::vectorised;

use super::Band;
use crate::attenuation::{self, Channel, masked};
use crate::forward_scatter::{KernelCache, Nodes, gather, scatter, widest_px};
use crate::plan::ScatterStep;
use crate::water::{Scatter, ScatterSource, Spread, Water};

/// What all channels of a frame share.
pub(super) struct Frame<'a> {
    pub(super) range: &'a Plane<f32>,
    /// The largest valid range in metres, where holes take their kernel from.
    pub(super) farthest: Option<f32>,
    pub(super) water: &'a Water,
    /// Attenuation is left out.
    pub(super) clear: bool,
}

pub(super) fn band(
    frame: &Frame<'_>,
    radiance: &Plane<f32>,
    channel: usize,
    step: &ScatterStep,
    cache: &mut KernelCache,
) -> Band<f32> {
    let Frame { range, water, .. } = frame;
    // Where the plan leaves attenuation out, the path has no length for it.
    let clear = frame.clear.then_some(0.0);
    let coefficients = Channel {
        gain: water.radiance_gain[channel] as f32,
        direct: clear.unwrap_or(water.direct_attenuation[channel] as f32),
        backscatter: clear.unwrap_or(water.backscatter_attenuation[channel] as f32),
        veil: water.veiling_light[channel] as f32,
    };
    let [mut direct, mut veil, mut image, mut forward] = [(); 4].map(|()| empty(range, cache));
    vectorised(
        #[inline(always)]
        || {
            attenuation::direct(radiance.data(), range.data(), coefficients, direct.data_mut());
            attenuation::veil(range.data(), coefficients, veil.data_mut());
            combine(direct.data(), veil.data(), image.data_mut(), |d, b| d + b);
        },
    );
    match (&water.scatter, step) {
        (Scatter::Jaffe { g, source, spread }, ScatterStep::Pointwise | ScatterStep::Interpolated(_)) => {
            // G may exceed c by the rounding of a derived sum; then nothing is scattered forward.
            let excess = (water.direct_attenuation[channel] - g[channel]).max(0.0) as f32;
            let (source, gain) = match source {
                ScatterSource::Radiance => (radiance, coefficients.gain),
                ScatterSource::Direct => (&direct, 1.0),
            };
            let numbers = [gain, g[channel] as f32, excess];
            vectorised(
                #[inline(always)]
                || attenuation::spread_light(source.data(), range.data(), numbers, forward.data_mut()),
            );
            if let Some((nodes, gamma)) = kernels(frame, spread, channel, step, cache) {
                let spread = scatter(&forward, &gamma, nodes, cache);
                let light = std::mem::replace(&mut forward, spread);
                cache.buffers.give([light, gamma].map(Plane::into_data));
            }
            accumulate(image.data_mut(), forward.data());
        }
        (Scatter::Simplified { spread }, ScatterStep::Interpolated(_)) => {
            if let Some((nodes, gamma)) = kernels(frame, spread, channel, step, cache) {
                let gathered = gather(&image, &gamma, nodes, cache);
                let attenuated = std::mem::replace(&mut image, gathered);
                combine(image.data(), attenuated.data(), forward.data_mut(), |i, a| i - a);
                cache.buffers.give([attenuated, gamma].map(Plane::into_data));
            } else {
                forward.data_mut().fill(0.0);
            }
        }
        _ => forward.data_mut().fill(0.0),
    }
    Band {
        direct,
        forward,
        veil,
        image,
    }
}

/// The kernels of an interpolated step and each pixel's scale; none for another step, or where a frame of holes has no
/// scale at all.
fn kernels<'a>(
    frame: &Frame<'_>,
    spread: &Spread,
    channel: usize,
    step: &'a ScatterStep,
    cache: &mut KernelCache,
) -> Option<(&'a Nodes, Plane<f32>)> {
    let (ScatterStep::Interpolated(nodes), Some(farthest)) = (step, frame.farthest) else {
        return None;
    };
    let mut gamma = empty(frame.range, cache);
    vectorised(
        #[inline(always)]
        || scales(frame.range, *spread, channel, farthest, gamma.data_mut()),
    );
    Some((nodes, gamma))
}

#[inline(always)]
fn scales(range: &Plane<f32>, spread: Spread, channel: usize, farthest: f32, gamma: &mut [f32]) {
    let widest = widest_px(range.width(), range.height());
    for (gamma, &z) in gamma.iter_mut().zip(range.data()) {
        let (valid, z) = masked(z);
        let metres = if valid { z } else { farthest };
        *gamma = spread.gamma(channel, f64::from(metres), widest) as f32;
    }
}

/// A plane of the range's size with any content.
fn empty(range: &Plane<f32>, cache: &mut KernelCache) -> Plane<f32> {
    let data = cache.buffers.take(range.data().len());
    Plane::new(range.width(), range.height(), data).expect("one sample for each pixel of the range")
}

#[inline(always)]
fn combine(a: &[f32], b: &[f32], to: &mut [f32], combine: impl Fn(f32, f32) -> f32) {
    for (to, (&a, &b)) in to.iter_mut().zip(a.iter().zip(b)) {
        *to = combine(a, b);
    }
}

fn accumulate(sum: &mut [f32], term: &[f32]) {
    sum.iter_mut().zip(term).for_each(|(sum, &term)| *sum += term);
}
