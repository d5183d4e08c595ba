//! Forward scatter that near objects stop, in f32.
//!
//! ```text
//! S_l = DCT[ m J T ] + Σ_k H_k · DCT[ l_k m J w ]          a layer's light as it would arrive alone
//! Y = max(0, DCT⁻¹[ P_{l+1} / A(G_l) ]) (1 − m_l)          taken back to the gate, and what passes it
//! P_l = S_l + A(G_l) · DCT[ Y ]                            from the farthest layer to the nearest
//! ```
//!
//! `A(Z) = T + w ((1−m) H(γ₁) + m H(γ₂))` is the response of a path of Z. Behind a gate the spectra hold P/T(G), and the light of each
//! transform is in units of the [`Gate`]. A/T is at least 1 and all transforms are of light of order 1, so that the division does not
//! amplify their rounding.

use imaging::fft::Complex;
use imaging::{Plane, vectorized};

use super::channel::{Channel, folded};
use super::chebyshev::{accumulate, back, line, zeros};
use super::gate::Gate;
use super::layer::{Divided, Layer};
use super::pass::{Opening, pass};
use super::{KernelCache, Kernels, widest_px};
use crate::attenuation::{exp_negative, scattered_share};
use crate::layering::Layering;
use crate::water::{Scatter, Water};

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

/// One channel at a layer that is behind a gate, or before all of them.
#[derive(Clone, Copy)]
struct Behind<'a> {
    source: &'a Source<'a>,
    /// Its place among the sources.
    sum: usize,
    /// The gate in front of the layer; `None` for the nearest layer.
    gate: Option<Gate>,
}

/// Light that arrives in each channel, except the direct light of the nearest layer, which passes no gate. Never negative.
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
    let gates: Vec<Vec<Option<Gate>>> = sources
        .iter()
        .map(|source| {
            let ranges = layering.gates_m.iter();
            ranges
                .map(|&meters| Gate::in_frame(water, source.channel, meters, size))
                .collect()
        })
        .collect();
    let mut spectra = zeros(sources.len(), size, cache);
    for l in (0..layering.count()).rev() {
        let layer = divided.layer(l, cache);
        if l + 1 < layering.count() {
            let openings: Vec<Option<Opening>> =
                gates.iter().map(|gates| Opening::between(gates, l)).collect();
            let mask = layer.as_ref().map(|layer| layer.mask.as_slice());
            pass(&mut spectra, &openings, mask, size, cache);
        }
        // An empty layer has no light.
        let Some(layer) = layer else { continue };
        let seen: Vec<Behind<'_>> = sources
            .iter()
            .enumerate()
            .filter(|(sum, _)| gates[*sum][..l].iter().all(Option::is_some))
            .map(|(sum, source)| Behind {
                source,
                sum,
                gate: l.checked_sub(1).and_then(|front| gates[sum][front]),
            })
            .collect();
        if l > 0 {
            add_direct(&layer, &seen, water, size, &mut spectra, cache);
        }
        add_spread(&layer, l, &seen, water, size, &mut spectra, cache);
        cache.buffers.give(layer.into_buffers());
    }
    let planes = back(&spectra, size, cache);
    cache.buffers.give(spectra);
    cache
        .buffers
        .give([divided.range].into_iter().chain(divided.light));
    planes
}

/// Adds the light of layer `l` that its kernels spread.
fn add_spread(
    layer: &Layer,
    l: usize,
    seen: &[Behind<'_>],
    water: &Water,
    size: (usize, usize),
    spectra: &mut [Vec<f32>],
    cache: &mut KernelCache,
) {
    let mut channels = Vec::new();
    for Behind { source, sum, gate } in seen {
        let parts = spread(source.channel, layer, &layer.light[*sum], water, size, cache);
        let nodes = [&source.kernels[l].narrow, &source.kernels[l].wide];
        for (kernel, (part, nodes)) in parts.into_iter().zip(nodes).enumerate() {
            match (part, nodes) {
                (Some([mut light, gamma]), Some(nodes)) => {
                    let unit = gate.map(|gate| gate.units()[kernel]);
                    if let Some(unit) = unit {
                        let scale = (1.0 / unit) as f32;
                        vectorized!(light.iter_mut().for_each(|v| *v *= scale));
                    }
                    let channel = Channel::folded(light, gamma, nodes, size).part_of(*sum);
                    channels.push(match gate {
                        Some(gate) => {
                            let gain = gate.units()[kernel] / gate.direct;
                            channel.through(gate.reaches()[kernel], gain as f32)
                        }
                        None => channel,
                    });
                }
                (part, _) => cache.buffers.give(part.into_iter().flatten()),
            }
        }
    }
    accumulate(&channels, size, spectra, cache);
    cache
        .buffers
        .give(channels.into_iter().flat_map(Channel::into_buffers));
}

/// Attenuation from a pixel to the gate before it, `e^{−c (Z − G)}`.
#[derive(Clone, Copy)]
struct Path {
    attenuation: f32,
    /// G as the sum of two numbers, so that Z − G keeps its digits.
    gate_m: [f32; 2],
}

impl Path {
    fn new(attenuation: f64, gate_m: f64) -> Self {
        let high = gate_m as f32;
        Self {
            attenuation: attenuation as f32,
            gate_m: [high, (gate_m - f64::from(high)) as f32],
        }
    }
}

/// Adds the direct light of a layer.
fn add_direct(
    layer: &Layer,
    seen: &[Behind<'_>],
    water: &Water,
    size: (usize, usize),
    spectra: &mut [Vec<f32>],
    cache: &mut KernelCache,
) {
    let (width, height) = size;
    let rows = |part: usize| {
        let Behind { source, sum, gate } = seen.get(part)?;
        let path = Path::new(
            water.direct_attenuation[source.channel],
            gate.map_or(0.0, |gate| gate.range_m),
        );
        Some((path, &layer.light[*sum]))
    };
    for first in (0..seen.len()).step_by(2) {
        let [one, other] = [rows(first), rows(first + 1)];
        cache.transform(size).forward(
            |place, row| {
                let pixels = line(place, width);
                let (mask, range) = (&layer.mask[pixels.clone()], &layer.range[pixels.clone()]);
                row.fill(Complex::default());
                if let Some((path, light)) = one {
                    vectorized!(arriving(
                        mask,
                        range,
                        &light[pixels.clone()],
                        path,
                        row,
                        |to, v| { to.re = v }
                    ));
                }
                if let Some((path, light)) = other {
                    vectorized!(arriving(
                        mask,
                        range,
                        &light[pixels.clone()],
                        path,
                        row,
                        |to, v| { to.im = v }
                    ));
                }
            },
            width,
            |p, column| {
                let band = line(p, height);
                for (part, Behind { sum, .. }) in seen[first..].iter().take(2).enumerate() {
                    let to = spectra[*sum][band.clone()].iter_mut().zip(column);
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
    path: Path,
    row: &mut [Complex<f32>],
    set: impl Fn(&mut Complex<f32>, f32),
) {
    let Path {
        attenuation,
        gate_m: [high, low],
    } = path;
    for (to, ((&mask, &z), &light)) in row.iter_mut().zip(mask.iter().zip(range).zip(light)) {
        let beyond = z - high - low;
        // The nearest layer is not filled: outside of it range and mask are 0.
        let beyond = if beyond > 0.0 { beyond } else { 0.0 };
        set(to, mask * light * exp_negative(attenuation * beyond));
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
