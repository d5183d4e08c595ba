//! Forward scatter that near objects stop, in f32.
//!
//! ```text
//! S_l = DCT[ m J T ] + Σ_k H_k · DCT[ l_k m J w ]          a layer's light as it would arrive alone
//! Y = max(0, DCT⁻¹[ P_{l+1} / A(G_l) ]) (1 − m_l)          taken back to the gate, and what passes it
//! P_l = S_l + A(G_l) · DCT[ Y ]                            from the farthest layer to the nearest
//! ```
//!
//! with `A(Z) = T + w ((1−m) H(γ₁) + m H(γ₂))`, what becomes of a spectrum on a path of Z. T at the gate drops out of the middle two lines,
//! so that only A/T, which is never small, is divided by.

use imaging::fft::Complex;
use imaging::{Plane, vectorized};

use super::channel::{Channel, folded};
use super::chebyshev::{accumulate, back, line, zeros};
use super::layer::{Divided, Layer};
use super::{KernelCache, Kernels, widest_px};
use crate::attenuation::{exp_negative, scattered_share};
use crate::layering::Layering;
use crate::water::{Scatter, Water};

/// Nothing passes a gate behind which the beam has this many attenuation lengths.
pub(crate) const OPAQUE_GATE: f64 = 20.0;

/// One channel that is gated.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    /// Its place among red, green, blue.
    pub(crate) channel: usize,
    /// Light of the scene.
    pub(crate) radiance: &'a Plane<f32>,
    /// Kernels of each layer.
    pub(crate) kernels: &'a [Kernels],
}

/// What arrives of each channel, but for the direct light of the nearest layer, which nothing can stop. Never negative.
pub(crate) fn gated_channels(
    range: &Plane<f32>,
    sources: &[Source<'_>],
    water: &Water,
    layering: &Layering,
    cache: &mut KernelCache,
) -> Vec<Plane<f32>> {
    let size = range.size();
    let depth = folded(range, cache);
    let light = sources.iter().map(|source| {
        let mut light = folded(source.radiance, cache);
        let gain = water.radiance_gain[source.channel] as f32;
        light.iter_mut().for_each(|v| *v *= gain);
        light
    });
    let divided = Divided::new(size, depth, light.collect(), layering);
    let mut spectra = zeros(sources.len(), size, cache);
    for l in (0..layering.count()).rev() {
        // A layer without a pixel hides nothing and shows nothing.
        let Some(layer) = divided.layer(l, cache) else {
            continue;
        };
        if l + 1 < layering.count() {
            let gates = sources
                .iter()
                .map(|source| Gate::new(source.channel, water, layering.gates_m[l], size, cache));
            let gates: Vec<Option<Gate>> = gates.collect();
            pass(&mut spectra, gates, &layer.mask, size, cache);
        }
        if l > 0 {
            add_direct(&layer, sources, water, size, &mut spectra, cache);
        }
        let mut channels = Vec::new();
        for (sum, source) in sources.iter().enumerate() {
            let parts = spread(source.channel, &layer, &layer.light[sum], water, size, cache);
            let nodes = [&source.kernels[l].narrow, &source.kernels[l].wide];
            for (part, nodes) in parts.into_iter().zip(nodes) {
                match (part, nodes) {
                    (Some([light, gamma]), Some(nodes)) => {
                        channels.push(Channel::folded(light, gamma, nodes, size).part_of(sum));
                    }
                    (part, _) => cache.buffers.give(part.into_iter().flatten()),
                }
            }
        }
        accumulate(&channels, size, &mut spectra, cache);
        cache
            .buffers
            .give(channels.into_iter().flat_map(Channel::into_buffers));
        cache.buffers.give(layer.into_buffers());
    }
    let planes = back(&spectra, size, cache);
    cache.buffers.give(spectra);
    cache
        .buffers
        .give([divided.range].into_iter().chain(divided.light));
    planes
}

/// A/T of one channel at the range of a gate, column by column.
struct Gate(Vec<f32>);

impl Gate {
    /// None where nothing passes.
    fn new(
        channel: usize,
        water: &Water,
        gate_m: f64,
        (width, height): (usize, usize),
        cache: &mut KernelCache,
    ) -> Option<Self> {
        if water.direct_attenuation[channel] * gate_m > OPAQUE_GATE {
            return None;
        }
        let at = water.arrival(channel, gate_m, widest_px(width, height))?;
        let mut response = cache.buffers.take(width * height);
        response.fill(1.0);
        let ratio = at.spread / at.direct;
        for (gamma, share) in at.gammas.into_iter().zip([1.0 - at.wide, at.wide]) {
            let (weight, kernel) = ((share * ratio) as f32, cache.transfer(gamma, width, height));
            if weight == 0.0 {
                continue;
            }
            for p in 0..kernel.columns() {
                let column = &mut response[line(p, height)];
                let kernel = kernel.column(p).unwrap_or_default();
                vectorized!({
                    for (to, h) in column.iter_mut().zip(kernel) {
                        *to += weight * h;
                    }
                });
            }
        }
        Some(Self(response))
    }
}

/// Takes light back to a gate, stops what the mask covers, and lets the rest go on. None of what has no gate passes.
fn pass(
    spectra: &mut [Vec<f32>],
    gates: Vec<Option<Gate>>,
    mask: &[f32],
    size: (usize, usize),
    cache: &mut KernelCache,
) {
    let mut open: Vec<(&mut Vec<f32>, Vec<f32>)> = Vec::new();
    for (spectrum, gate) in spectra.iter_mut().zip(gates) {
        match gate {
            Some(Gate(response)) => open.push((spectrum, response)),
            None => spectrum.fill(0.0),
        }
    }
    let (width, height) = size;
    let mut passed = zeros(2, size, cache);
    for pair in open.chunks_mut(2) {
        let transform = cache.transform(size);
        transform.inverse(
            |p, column| {
                let band = line(p, height);
                column.fill(Complex::default());
                for (part, (spectrum, response)) in pair.iter().enumerate() {
                    let (values, response) = (&spectrum[band.clone()], &response[band.clone()]);
                    match part {
                        0 => vectorized!(quotients(values, response, column, |to, v| to.re = v)),
                        _ => vectorized!(quotients(values, response, column, |to, v| to.im = v)),
                    }
                }
            },
            width,
            |place, row| {
                let pixels = line(place, width);
                let covers = &mask[pixels.clone()];
                for (part, passed) in passed.iter_mut().enumerate() {
                    let to = &mut passed[pixels.clone()];
                    match part {
                        0 => vectorized!(uncovered(row, covers, to, |v| v.re)),
                        _ => vectorized!(uncovered(row, covers, to, |v| v.im)),
                    }
                }
            },
        );
        transform.forward(
            |place, row| {
                let pixels = line(place, width);
                let lights = passed[0][pixels.clone()].iter().zip(&passed[1][pixels]);
                row.iter_mut()
                    .zip(lights)
                    .for_each(|(to, (&one, &other))| *to = Complex::new(one, other));
            },
            width,
            |p, column| {
                let band = line(p, height);
                for (part, (spectrum, response)) in pair.iter_mut().enumerate() {
                    let (to, response) = (&mut spectrum[band.clone()], &response[band.clone()]);
                    match part {
                        0 => vectorized!(products(column, response, to, |v| v.re)),
                        _ => vectorized!(products(column, response, to, |v| v.im)),
                    }
                }
            },
        );
    }
    cache.buffers.give(passed);
    cache.buffers.give(open.into_iter().map(|(_, response)| response));
}

#[inline(always)]
fn quotients(values: &[f32], by: &[f32], to: &mut [Complex<f32>], set: impl Fn(&mut Complex<f32>, f32)) {
    for (to, (value, by)) in to.iter_mut().zip(values.iter().zip(by)) {
        set(to, value / by);
    }
}

#[inline(always)]
fn uncovered(row: &[Complex<f32>], covers: &[f32], to: &mut [f32], part: impl Fn(Complex<f32>) -> f32) {
    for (to, (&value, cover)) in to.iter_mut().zip(row.iter().zip(covers)) {
        let value = part(value);
        *to = if value > 0.0 { value } else { 0.0 } * (1.0 - cover);
    }
}

#[inline(always)]
fn products(column: &[Complex<f32>], by: &[f32], to: &mut [f32], part: impl Fn(Complex<f32>) -> f32) {
    for (to, (&value, by)) in to.iter_mut().zip(column.iter().zip(by)) {
        *to = part(value) * by;
    }
}

/// Adds what arrives of a layer on its own ray.
fn add_direct(
    layer: &Layer,
    sources: &[Source<'_>],
    water: &Water,
    size: (usize, usize),
    spectra: &mut [Vec<f32>],
    cache: &mut KernelCache,
) {
    let (width, height) = size;
    let rows = |part: usize| {
        let source = sources.get(part)?;
        Some((
            water.direct_attenuation[source.channel] as f32,
            &layer.light[part],
        ))
    };
    for first in (0..sources.len()).step_by(2) {
        let [one, other] = [rows(first), rows(first + 1)];
        let pair = &mut spectra[first..(first + 2).min(sources.len())];
        cache.transform(size).forward(
            |place, row| {
                let pixels = line(place, width);
                let (mask, range) = (&layer.mask[pixels.clone()], &layer.range[pixels.clone()]);
                row.fill(Complex::default());
                if let Some((c, light)) = one {
                    vectorized!(arriving(mask, range, &light[pixels.clone()], c, row, |to, v| {
                        to.re = v
                    }));
                }
                if let Some((c, light)) = other {
                    vectorized!(arriving(mask, range, &light[pixels.clone()], c, row, |to, v| {
                        to.im = v
                    }));
                }
            },
            width,
            |p, column| {
                let band = line(p, height);
                for (part, spectrum) in pair.iter_mut().enumerate() {
                    let to = spectrum[band.clone()].iter_mut().zip(column);
                    to.for_each(|(to, value)| *to += if part == 0 { value.re } else { value.im });
                }
            },
        );
    }
}

#[inline(always)]
fn arriving(
    mask: &[f32],
    range: &[f32],
    light: &[f32],
    attenuation: f32,
    row: &mut [Complex<f32>],
    set: impl Fn(&mut Complex<f32>, f32),
) {
    for (to, ((&mask, &z), &light)) in row.iter_mut().zip(mask.iter().zip(range).zip(light)) {
        set(to, mask * light * exp_negative(attenuation * z));
    }
}

/// The light of a layer that each of its kernels spreads, with the scales of that kernel.
fn spread(
    c: usize,
    layer: &Layer,
    light: &[f32],
    water: &Water,
    (width, height): (usize, usize),
    cache: &mut KernelCache,
) -> [Option<[Vec<f32>; 2]>; 2] {
    let Scatter::Jaffe { g, spread, tail, .. } = water.scatter else {
        unreachable!("only the Jaffe–McGlamery form is gated");
    };
    let widest = widest_px(width, height);
    let (g, excess) = (g[c] as f32, (water.direct_attenuation[c] - g[c]).max(0.0) as f32);
    let [mut narrow, mut gamma] = [(); 2].map(|()| cache.buffers.take(light.len()));
    let [mask, range] = [&layer.mask, &layer.range].map(Vec::as_slice);
    vectorized!({
        for (to, ((&mask, &z), &light)) in narrow.iter_mut().zip(mask.iter().zip(range).zip(light)) {
            *to = mask * light * scattered_share(g, excess, z);
        }
    });
    vectorized!(spread.scales(c, widest, range, &mut gamma));
    let wide = tail.map(|tail| {
        let [mut wide, mut gamma] = [(); 2].map(|()| cache.buffers.take(light.len()));
        vectorized!(tail.split(c, range, &mut narrow, &mut wide));
        vectorized!(tail.spread.scales(c, widest, range, &mut gamma));
        [wide, gamma]
    });
    [Some([narrow, gamma]), wide]
}
