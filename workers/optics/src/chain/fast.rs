//! The chain in f32 with the fast forward scatter.

use imaging::{Plane, Rgb, vectorized};
use spec::ScatterSource;

use super::layers::Band;
use crate::attenuation::{self, Channel, masked};
use crate::daylight;
use crate::forward_scatter::{
    self, KernelCache, Kernels, Source, gated_channels, gather_channels, scatter_channels, widest_px,
};
use crate::layering::Layering;
use crate::plan::Variant;
use crate::water::{Scatter, Spread, Tail, Water};

/// Data shared by all channels of a frame.
pub(super) struct Frame<'a> {
    pub(super) range: &'a Plane<f32>,
    /// The largest valid range in meters, where holes take their kernel from.
    pub(super) farthest: Option<f32>,
    pub(super) water: &'a Water,
    /// Attenuation is left out.
    pub(super) clear: bool,
    /// The veil depends on the direction.
    pub(super) veil: bool,
    /// Layers whose gates stop spread light; `None` without gates.
    pub(super) gates: Option<&'a Layering>,
}

/// All bands together, so that planes of two of them may share a transform.
pub(super) fn bands(
    frame: &Frame<'_>,
    radiance: &Rgb<f32>,
    steps: [&Variant; 3],
    cache: &mut KernelCache,
) -> [Band<f32>; 3] {
    let mut bands = [0, 1, 2].map(|c| attenuated(frame, &radiance.planes()[c], c, steps[c], cache));
    match &frame.water.scatter {
        Scatter::None => {}
        Scatter::Jaffe { spread, tail, .. } => {
            if let Some(layering) = frame.gates {
                gated(frame, layering, radiance, steps, &mut bands, cache);
            } else {
                let light = bands.each_ref().map(|band| &band.forward);
                let (places, channels) = match tail {
                    Some(tail) => channels_of_two(frame, (spread, tail), light, steps, cache),
                    None => channels(frame, spread, light, steps, cache),
                };
                for (c, spread) in places.into_iter().zip(scatter_channels(channels, cache)) {
                    let light = std::mem::replace(&mut bands[c].forward, spread);
                    cache.buffers.give([light.into_data()]);
                }
            }
            for (band, step) in bands.iter_mut().zip(&steps) {
                if **step != Variant::Skip {
                    accumulate(band.image.data_mut(), band.forward.data());
                }
            }
        }
        Scatter::Simplified { spread } => {
            let images = bands.each_ref().map(|band| &band.image);
            let (places, channels) = channels(frame, spread, images, steps, cache);
            for (c, gathered) in places.into_iter().zip(gather_channels(channels, cache)) {
                let Band { image, forward, .. } = &mut bands[c];
                let attenuated = std::mem::replace(image, gathered);
                combine(image.data(), attenuated.data(), forward.data_mut(), |i, a| i - a);
                cache.buffers.give([attenuated.into_data()]);
            }
        }
    }
    bands
}

/// Occlusion-aware forward scatter in the layered channels.
fn gated(
    frame: &Frame<'_>,
    layering: &Layering,
    radiance: &Rgb<f32>,
    steps: [&Variant; 3],
    bands: &mut [Band<f32>; 3],
    cache: &mut KernelCache,
) {
    let sources = (0..3).filter_map(|channel| match steps[channel] {
        Variant::Layered(kernels) => Some(Source {
            channel,
            radiance: &radiance.planes()[channel],
            kernels,
        }),
        _ => None,
    });
    let sources: Vec<_> = sources.collect();
    let nearest = layering.cuts_m[0];
    let arriving = gated_channels(frame.range, &sources, frame.water, layering, cache);
    for (source, arriving) in sources.iter().zip(arriving) {
        let Band { direct, forward, .. } = &mut bands[source.channel];
        let light = std::mem::replace(forward, arriving);
        cache.buffers.give([light.into_data()]);
        // `forward` holds all arriving light but the direct light of the nearest layer.
        let pixels = forward.data_mut().iter_mut().zip(direct.data());
        for ((forward, direct), &z) in pixels.zip(frame.range.data()) {
            let is_behind = f64::from(z) > nearest;
            *forward = (*forward - if is_behind { *direct } else { 0.0 }).max(0.0);
        }
    }
}

/// The attenuated light, the veil, and the light to spread.
fn attenuated(
    frame: &Frame<'_>,
    radiance: &Plane<f32>,
    channel: usize,
    step: &Variant,
    cache: &mut KernelCache,
) -> Band<f32> {
    let Frame { range, water, .. } = frame;
    // If the plan omits attenuation, its path has length 0.
    let clear = frame.clear.then_some(0.0);
    let coefficients = Channel {
        gain: water.radiance_gain[channel] as f32,
        direct: clear.unwrap_or(water.direct_attenuation[channel] as f32),
        backscatter: clear.unwrap_or(water.backscatter_attenuation[channel] as f32),
        veil: water.veiling_light[channel] as f32,
    };
    // Attenuation omits a constant veil if a directional veil replaces it.
    let varied = frame.veil.then(|| water.varied_veil(channel)).flatten();
    let coefficients = Channel {
        veil: if varied.is_some() { 0.0 } else { coefficients.veil },
        ..coefficients
    };
    let [mut direct, mut veil, mut image, mut forward] = [(); 4].map(|()| empty(range, cache));
    let layers = attenuation::Attenuated {
        direct: direct.data_mut(),
        veil: veil.data_mut(),
        image: image.data_mut(),
    };
    attenuation::attenuate(radiance.data(), range.data(), coefficients, layers);
    if let (Some(varied), Some(daylight)) = (varied, water.daylight()) {
        daylight::veil(range, &varied, &daylight.gaze, veil.data_mut());
        accumulate(image.data_mut(), veil.data());
    }
    match (&water.scatter, step) {
        (
            Scatter::Jaffe { g, source, .. },
            Variant::Pointwise | Variant::Interpolated(_) | Variant::Layered(_),
        ) => {
            // G may exceed c by the rounding of a derived sum; the forward scatter is 0 then.
            let excess = (water.direct_attenuation[channel] - g[channel]).max(0.0) as f32;
            let (source, gain) = match source {
                ScatterSource::Radiance => (radiance, coefficients.gain),
                ScatterSource::Direct => (&direct, 1.0),
            };
            let numbers = [gain, g[channel] as f32, excess];
            vectorized!(attenuation::spread_light(
                source.data(),
                range.data(),
                numbers,
                forward.data_mut()
            ));
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

/// The channels whose step is interpolated, each with its kernels. `None` if a frame of holes has no kernel scale.
fn channels<'a>(
    frame: &Frame<'_>,
    spread: &Spread,
    light: [&Plane<f32>; 3],
    steps: [&'a Variant; 3],
    cache: &mut KernelCache,
) -> (Vec<usize>, Vec<forward_scatter::Channel<'a>>) {
    let (mut places, mut channels) = (Vec::new(), Vec::new());
    for (c, light) in light.into_iter().enumerate() {
        let (Variant::Interpolated(nodes), Some(farthest)) = (steps[c], frame.farthest) else {
            continue;
        };
        let mut gamma = empty(frame.range, cache);
        vectorized!(scales(frame.range, *spread, c, farthest, gamma.data_mut()));
        channels.push(forward_scatter::Channel::new(light, &gamma, nodes, cache).part_of(places.len()));
        places.push(c);
        cache.buffers.give([gamma.into_data()]);
    }
    (places, channels)
}

/// The same for two kernels in each path, each with its part of the light.
fn channels_of_two<'a>(
    frame: &Frame<'_>,
    (narrow, tail): (&Spread, &Tail),
    light: [&Plane<f32>; 3],
    steps: [&'a Variant; 3],
    cache: &mut KernelCache,
) -> (Vec<usize>, Vec<forward_scatter::Channel<'a>>) {
    let (mut places, mut channels) = (Vec::new(), Vec::new());
    for (c, light) in light.into_iter().enumerate() {
        let Variant::Layered(layers) = steps[c] else {
            continue;
        };
        let Some(Kernels {
            narrow: near,
            wide,
            narrow_coarse,
            wide_coarse,
        }) = layers.first()
        else {
            continue;
        };
        let widest = widest_px(frame.range.width(), frame.range.height());
        let range = finite(frame.range, cache);
        let [mut own, mut beyond] = [(); 2].map(|()| empty(frame.range, cache));
        own.data_mut().copy_from_slice(light.data());
        vectorized!(tail.split(c, range.data(), own.data_mut(), beyond.data_mut()));
        let parts = [
            (near, narrow, own, *narrow_coarse),
            (wide, &tail.spread, beyond, *wide_coarse),
        ];
        for (nodes, spread, part, coarse) in parts {
            if let Some(nodes) = nodes {
                let mut gamma = empty(frame.range, cache);
                vectorized!(spread.scales(c, widest, range.data(), gamma.data_mut()));
                let channel = forward_scatter::Channel::new(&part, &gamma, nodes, cache);
                channels.push(channel.on_coarse_rows(coarse).part_of(places.len()));
                cache.buffers.give([gamma.into_data()]);
            }
            cache.buffers.give([part.into_data()]);
        }
        cache.buffers.give([range.into_data()]);
        places.push(c);
    }
    (places, channels)
}

/// The range with 0 at holes, which send no light.
fn finite(range: &Plane<f32>, cache: &mut KernelCache) -> Plane<f32> {
    let mut finite = empty(range, cache);
    let to = finite.data_mut();
    vectorized!({
        for (to, &z) in to.iter_mut().zip(range.data()) {
            let (valid, z) = masked(z);
            *to = if valid { z } else { 0.0 };
        }
    });
    finite
}

#[inline(always)]
fn scales(range: &Plane<f32>, spread: Spread, channel: usize, farthest: f32, gamma: &mut [f32]) {
    let widest = widest_px(range.width(), range.height());
    for (gamma, &z) in gamma.iter_mut().zip(range.data()) {
        let (valid, z) = masked(z);
        let meters = if valid { z } else { farthest };
        *gamma = spread.gamma(channel, f64::from(meters), widest) as f32;
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
