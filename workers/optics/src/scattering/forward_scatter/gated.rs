//! Forward scatter that near objects stop, in f32.
//!
//! ```text
//! S_l = DCT[ m J T ] + Σ_k H_k · DCT[ l_k m J w ]          arriving light of a layer without occlusion
//! Y = max(0, DCT⁻¹[ P_{l+1} / A(G_l) ]) (1 − m_l)          propagated back to the gate, and its passing part
//! P_l = S_l + A(G_l) · DCT[ Y ]                            from the farthest layer to the nearest
//! ```
//!
//! `A(Z) = T + w ((1−m) H(γ₁) + m H(γ₂))` is the response of a path of Z. The light Y propagates like light of layer l at the range
//! of its gate, so it shares the transforms of that layer: the kernels of the range are among those of the layer. Behind a gate the
//! spectra hold P/T(G), and the light of each transform is in units of the [`Gate`]. A/T is at least 1 and all transforms are of
//! light of order 1, so that the division does not amplify their rounding.

use imaging::dct::Folding;
use imaging::fft::Complex;
use imaging::{Plane, vectorized};

use super::basis::Basis;
use super::channel::{Channel, Passed, folded};
use super::chebyshev::accumulate;
use super::decimation::line;
use super::gate::Gate;
use super::layer::{Divided, Layer};
use super::pass::{open_gate, pass};
use super::spectra::{back, zeros};
use super::{KernelCache, Kernels, Nodes, widest_px};
use crate::attenuation::{exp_negative, scattered_share};
use crate::layering::Layering;
use crate::water::{Scatter, Water};

/// One gated channel.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    /// Its index among red, green, blue.
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
    /// Its index among the sources.
    sum: usize,
    /// The gate in front of the layer; `None` for the nearest layer.
    gate: Option<Gate>,
    /// The gate behind the layer with the light that passes it.
    passed: Option<(Gate, &'a [f32])>,
}

impl<'a> Behind<'a> {
    /// Light behind the layer that propagates with one of its kernels, 0 the narrow and 1 the wide one.
    fn passed(&self, kernel: usize, nodes: &Nodes) -> Option<Passed<'a>> {
        let (behind, light) = self.passed?;
        let unit = self.gate.map_or(1.0, |gate| gate.units()[kernel]);
        Some(Passed {
            light,
            share: (behind.spread[kernel] / unit) as f32,
            k: nodes.nearest(behind.gammas[kernel]),
        })
    }

    /// The same light and its unscattered share.
    fn passed_direct(&self) -> Option<(&'a [f32], f32)> {
        let (behind, light) = self.passed?;
        let onward = behind.direct / self.gate.map_or(1.0, |gate| gate.direct);
        Some((light, onward as f32))
    }
}

/// Arriving light of each channel, except the direct light of the nearest layer, which passes no gate. Never negative.
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
    let mut passed: Vec<Option<Vec<f32>>> = sources.iter().map(|_| None).collect();
    for l in (0..layering.count()).rev() {
        let layer = divided.layer(l, cache);
        if l + 1 < layering.count() {
            let open: Vec<Option<Gate>> = gates.iter().map(|gates| open_gate(gates, l)).collect();
            cache.buffers.give(passed.into_iter().flatten());
            passed = pass(&spectra, &open, Some(&layer.mask), size, cache);
            spectra.iter_mut().for_each(|spectrum| spectrum.fill(0.0));
        }
        let seen = sources.iter().zip(&gates).enumerate();
        let seen: Vec<Behind<'_>> = seen
            .filter(|(_, (_, gates))| gates[..l].iter().all(Option::is_some))
            .map(|(sum, (source, gates))| Behind {
                source,
                sum,
                gate: l.checked_sub(1).and_then(|front| gates[front]),
                passed: gates.get(l).copied().flatten().zip(passed[sum].as_deref()),
            })
            .collect();
        if l > 0 {
            add_direct(&layer, &seen, water, size, &mut spectra, cache);
        }
        add_spread(&layer, l, &seen, water, size, &mut spectra, cache);
        cache.buffers.give(layer.into_buffers());
    }
    let mut planes = back(&spectra, size, cache);
    for (plane, (gates, passed)) in planes.iter_mut().zip(gates.iter().zip(&passed)) {
        if let (Some(gate), Some(passed)) = (gates[0], passed) {
            add_unfolded(passed, gate.direct as f32, plane);
        }
    }
    cache.buffers.give(spectra);
    cache.buffers.give(passed.into_iter().flatten());
    cache
        .buffers
        .give([divided.range].into_iter().chain(divided.light));
    planes
}

/// Adds a share of a folded plane.
fn add_unfolded(folded: &[f32], share: f32, plane: &mut Plane<f32>) {
    let (width, height) = plane.size();
    let folding = Folding::new(width, height);
    let mut row = vec![0.0; width];
    for (place, folded) in folded.chunks_exact(width.max(1)).enumerate() {
        folding.unfold_row(folded, |value| share * value, &mut row);
        let to = plane.data_mut()[line(folding.row(place), width)].iter_mut();
        to.zip(&row).for_each(|(to, value)| *to += value);
    }
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
    for behind in seen {
        let Behind {
            source, sum, gate, ..
        } = *behind;
        let nodes = [&source.kernels[l].narrow, &source.kernels[l].wide];
        let units = gate.map_or([1.0; 2], |gate| gate.units());
        let parts = spread(
            layer,
            source.channel,
            &layer.light[sum],
            &Kernel::both(nodes, units),
            water,
            size,
            cache,
        );
        for (kernel, (part, nodes)) in parts.into_iter().zip(nodes).enumerate() {
            let (Some([light, located]), Some(nodes)) = (part, nodes) else {
                continue;
            };
            let coarse = [source.kernels[l].narrow_coarse, source.kernels[l].wide_coarse][kernel];
            let channel = Channel::located(light, located, nodes, size)
                .on_coarse_rows(coarse)
                .part_of(sum)
                .with_passed(behind.passed(kernel, nodes));
            channels.push(match gate {
                Some(gate) => {
                    let gain = units[kernel] / gate.direct;
                    channel.through(gate.reaches()[kernel], gain as f32)
                }
                None => channel,
            });
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

/// Adds the direct light of a layer, and that of farther ones which passes the gate behind it.
fn add_direct(
    layer: &Layer,
    seen: &[Behind<'_>],
    water: &Water,
    size: (usize, usize),
    spectra: &mut [Vec<f32>],
    cache: &mut KernelCache,
) {
    let (width, height) = size;
    let write = |behind: &Behind<'_>, place: usize, row: &mut [f32]| {
        let path = Path::new(
            water.direct_attenuation[behind.source.channel],
            behind.gate.map_or(0.0, |gate| gate.range_m),
        );
        let pixels = line(place, width);
        let [mask, range, light] = [&layer.mask, &layer.range, &layer.light[behind.sum]];
        let rows = [mask, range, light].map(|plane| &plane[pixels.clone()]);
        vectorized!(arriving(rows, path, row));
        if let Some((light, share)) = behind.passed_direct() {
            let pairs = row.iter_mut().zip(&light[pixels]);
            pairs.for_each(|(to, light)| *to += share * light);
        }
    };
    let mut rows = [vec![0.0; width], vec![0.0; width]];
    for pair in seen.chunks(2) {
        cache.transform(size).forward(
            |place, row| {
                for (behind, row) in pair.iter().zip(&mut rows) {
                    write(behind, place, row);
                }
                let [one, other] = &rows;
                let values = row.iter_mut().zip(one.iter().zip(other));
                values.for_each(|(to, (&one, &other))| *to = Complex::new(one, other));
            },
            width,
            |p, column| {
                for (part, behind) in pair.iter().enumerate() {
                    let to = &mut spectra[behind.sum][line(p, height)];
                    match part {
                        0 => vectorized!(add_part(to, column, |v| v.re)),
                        _ => vectorized!(add_part(to, column, |v| v.im)),
                    }
                }
            },
        );
    }
}

#[inline(always)]
fn add_part(to: &mut [f32], column: &[Complex<f32>], part: impl Fn(Complex<f32>) -> f32) {
    to.iter_mut()
        .zip(column)
        .for_each(|(to, &value)| *to += part(value));
}

#[inline(always)]
fn arriving([mask, range, light]: [&[f32]; 3], path: Path, row: &mut [f32]) {
    let Path {
        attenuation,
        gate_m: [high, low],
    } = path;
    for (to, ((&mask, &z), &light)) in row.iter_mut().zip(mask.iter().zip(range).zip(light)) {
        let beyond = z - high - low;
        // The nearest layer is not filled: outside of it range and mask are 0.
        let beyond = if beyond > 0.0 { beyond } else { 0.0 };
        *to = mask * light * exp_negative(attenuation * beyond);
    }
}

/// The narrow or the wide kernel of a layer.
struct Kernel {
    basis: Basis,
    /// The unit of its light.
    unit: f64,
}

impl Kernel {
    fn both(nodes: [&Option<Nodes>; 2], units: [f64; 2]) -> [Option<Self>; 2] {
        [0, 1].map(|kernel| {
            nodes[kernel].as_ref().map(|nodes| Self {
                basis: Basis::new(nodes),
                unit: units[kernel],
            })
        })
    }
}

/// The light of a layer that each of its kernels spreads in units of the kernel, with the located scales of that kernel.
fn spread(
    layer: &Layer,
    c: usize,
    light: &[f32],
    kernels: &[Option<Kernel>; 2],
    water: &Water,
    (width, height): (usize, usize),
    cache: &mut KernelCache,
) -> [Option<[Vec<f32>; 2]>; 2] {
    let Scatter::Jaffe { g, spread, tail, .. } = water.scatter else {
        unreachable!("only the Jaffe–McGlamery form is gated");
    };
    let widest = widest_px(width, height);
    let (g, excess) = (g[c] as f32, (water.direct_attenuation[c] - g[c]).max(0.0) as f32);
    let spreads = [Some(spread), tail.map(|tail| tail.spread)];
    let mut planes = kernels.each_ref().map(|kernel| {
        let kernel = kernel.as_ref();
        kernel.map(|_| [(); 2].map(|()| cache.buffers.take(light.len())))
    });
    let mut rows = [(); 2].map(|()| vec![0.0; width]);
    // All of a row while it is in the nearest cache.
    for pixels in (0..height).map(|place| line(place, width)) {
        let [mask, range] = [&layer.mask, &layer.range].map(|plane| &plane[pixels.clone()]);
        let light = &light[pixels.clone()];
        if vectorized!(mask.iter().fold(0, |bits, value| bits | value.to_bits())) == 0 {
            // Light of 0 has any scale.
            let planes = planes.iter_mut().flatten().flatten();
            planes.for_each(|plane| plane[pixels.clone()].fill(0.0));
            continue;
        }
        let [narrow, wide] = &mut rows;
        vectorized!(scattered(narrow, [mask, range, light], g, excess));
        if let Some(tail) = tail {
            vectorized!(tail.split(c, range, narrow, wide));
        }
        for (kernel, (planes, row)) in planes.iter_mut().zip(&rows).enumerate() {
            let (Some([to, located]), Some(Kernel { basis, unit }), Some(spread)) =
                (planes, &kernels[kernel], spreads[kernel])
            else {
                continue;
            };
            let (to, located) = (&mut to[pixels.clone()], &mut located[pixels.clone()]);
            let scale = (1.0 / unit) as f32;
            vectorized!(scaled(row, scale, to));
            vectorized!(spread.scales(c, widest, range, located));
            vectorized!(basis.locate(located));
        }
    }
    planes
}

#[inline(always)]
fn scattered(to: &mut [f32], [mask, range, light]: [&[f32]; 3], g: f32, excess: f32) {
    for (to, ((&mask, &z), &light)) in to.iter_mut().zip(mask.iter().zip(range).zip(light)) {
        *to = mask * light * scattered_share(g, excess, z);
    }
}

#[inline(always)]
fn scaled(from: &[f32], factor: f32, to: &mut [f32]) {
    to.iter_mut()
        .zip(from)
        .for_each(|(to, &from)| *to = factor * from);
}
