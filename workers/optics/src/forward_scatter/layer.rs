//! A layer of a frame as if nothing were in front of it, in f32 and in the order of the transform.

use imaging::fft::Complex;
use imaging::vectorized;

use super::KernelCache;
use super::chebyshev::line;
use crate::layering::Layering;
use crate::range::is_hole;

/// The kernel that fills what is hidden, as a share of the frame's width; at least 1 pixel.
const FILL_SHARE: f64 = 1.0 / 40.0;
/// Where less than this of the kernel meets anything known, nothing is known.
pub(crate) const FILL_LEAST: f64 = 1e-6;

/// Scale of the kernel that fills what is hidden, pixels.
pub(crate) fn fill_gamma_px(width: usize) -> f64 {
    (FILL_SHARE * width as f64).max(1.0)
}

/// A frame in layers, every plane in folded order.
pub(super) struct Divided {
    pub(super) size: (usize, usize),
    /// The layer of each pixel; that behind the last of a hole.
    pub(super) layers: Vec<u8>,
    /// Range in meters; 0 at a hole.
    pub(super) range: Vec<f32>,
    /// Light of each channel before the water.
    pub(super) light: Vec<Vec<f32>>,
    spans_m: Vec<Option<(f64, f64)>>,
}

/// One layer with what is behind nearer ones filled in.
pub(super) struct Layer {
    /// How much of it is at each pixel, 0..=1.
    pub(super) mask: Vec<f32>,
    /// Its range, meters.
    pub(super) range: Vec<f32>,
    /// Light of each channel before the water.
    pub(super) light: Vec<Vec<f32>>,
}

impl Divided {
    /// Divides a frame, given its range and light in folded order.
    pub(super) fn new(
        size: (usize, usize),
        mut range: Vec<f32>,
        light: Vec<Vec<f32>>,
        layering: &Layering,
    ) -> Self {
        let cuts: Vec<f32> = layering.cuts_m.iter().map(|&cut| rounded_down(cut)).collect();
        let deepest = layering.count() as u8;
        let layer = |z: f32| cuts.iter().map(|&cut| u8::from(z > cut)).sum();
        let layers = range.iter().map(|&z| if is_hole(z) { deepest } else { layer(z) });
        let layers: Vec<u8> = layers.collect();
        for (z, &layer) in range.iter_mut().zip(&layers) {
            *z = if layer == deepest { 0.0 } else { *z };
        }
        Self {
            size,
            layers,
            range,
            light,
            spans_m: layering.spans_m.clone(),
        }
    }

    /// One layer. It is dark where no pixel is of it.
    pub(super) fn layer(&self, layer: usize, cache: &mut KernelCache) -> Layer {
        let (nearest, farthest) = self.spans_m[layer].unwrap_or_default();
        // Ranges are filled from the nearest of the layer on: rounding is that of their differences.
        let nearest = if layer > 0 { nearest as f32 } else { 0.0 };
        let reach = farthest as f32 - nearest;
        let (of, layer) = (self.layers.as_slice(), layer as u8);
        let mut mask = cache.buffers.take(of.len());
        vectorized!(choose(&mut mask, of, |of| of == layer));
        let own =
            || std::iter::once((&self.range, nearest)).chain(self.light.iter().map(|light| (light, 0.0)));
        let mut values = Vec::new();
        for (own, from) in own() {
            let mut value = cache.buffers.take(of.len());
            vectorized!(product(&mut value, own, from, &mask));
            values.push(value);
        }
        if layer > 0 {
            let mut known = cache.buffers.take(of.len());
            vectorized!(choose(&mut known, of, |of| of >= layer));
            self.spread(
                [&mut mask, &mut known].into_iter().chain(&mut values).collect(),
                cache,
            );
            let most = std::iter::once(reach).chain(std::iter::repeat(f32::MAX));
            for ((value, (own, from)), most) in values.iter_mut().zip(own()).zip(most) {
                vectorized!(means(value, &mask, (of, layer), own, (from, most)));
            }
            vectorized!(cover(&mut mask, &known, (of, layer)));
            cache.buffers.give([known]);
        }
        let range = values.remove(0);
        let light = values;
        Layer { mask, range, light }
    }

    /// Spreads planes by the kernel that fills, two in each transform.
    fn spread(&self, mut planes: Vec<&mut Vec<f32>>, cache: &mut KernelCache) {
        let (width, height) = self.size;
        let kernel = cache.transfer(fill_gamma_px(width), width, height);
        let columns = kernel.columns();
        let mut spectrum = vec![Complex::default(); columns * height];
        for pair in planes.chunks_mut(2) {
            let transform = cache.transform(self.size);
            transform.forward(
                |place, row| {
                    let pixels = line(place, width);
                    let (one, other) = (&pair[0][pixels.clone()], pair.get(1).map(|other| &other[pixels]));
                    row.iter_mut()
                        .zip(one)
                        .for_each(|(to, &one)| *to = Complex::new(one, 0.0));
                    if let Some(other) = other {
                        row.iter_mut().zip(other).for_each(|(to, &other)| to.im = other);
                    }
                },
                columns,
                |p, column| {
                    let Some(kernel) = kernel.column(p) else { return };
                    let to = spectrum[line(p, height)].iter_mut();
                    to.zip(column.iter().zip(kernel))
                        .for_each(|(to, (value, &h))| *to = value.scale(h));
                },
            );
            transform.inverse(
                |p, column| column.copy_from_slice(&spectrum[line(p, height)]),
                columns,
                |place, row| {
                    let pixels = line(place, width);
                    for (part, plane) in pair.iter_mut().enumerate() {
                        let to = plane[pixels.clone()].iter_mut().zip(row.iter());
                        to.for_each(|(to, value)| *to = if part == 0 { value.re } else { value.im });
                    }
                },
            );
        }
    }
}

impl Layer {
    pub(super) fn into_buffers(self) -> impl Iterator<Item = Vec<f32>> {
        [self.mask, self.range].into_iter().chain(self.light)
    }
}

/// The largest f32 that is not above a cut: an f32 is above the one where it is above the other.
fn rounded_down(cut: f64) -> f32 {
    let near = cut as f32;
    if f64::from(near) > cut {
        near.next_down()
    } else {
        near
    }
}

/// 1 where a layer is one of those asked for, else 0.
#[inline(always)]
fn choose(chosen: &mut [f32], of: &[u8], is_chosen: impl Fn(u8) -> bool) {
    for (to, &of) in chosen.iter_mut().zip(of) {
        *to = f32::from(u8::from(is_chosen(of)));
    }
}

#[inline(always)]
fn product(to: &mut [f32], values: &[f32], from: f32, mask: &[f32]) {
    for (to, (value, mask)) in to.iter_mut().zip(values.iter().zip(mask)) {
        *to = (value - from) * mask;
    }
}

/// The layer's values on its pixels, elsewhere the mean of nearby ones: `from` plus the ratio of `means` to `weights`, at most `from + most`.
#[inline(always)]
fn means(
    means: &mut [f32],
    weights: &[f32],
    (of, layer): (&[u8], u8),
    own: &[f32],
    (from, most): (f32, f32),
) {
    for ((mean, &weight), (&of, &own)) in means.iter_mut().zip(weights).zip(of.iter().zip(own)) {
        let near = weight > FILL_LEAST as f32;
        let filled = *mean / if near { weight } else { 1.0 };
        let filled = if near { filled } else { 0.0 };
        let filled = if filled > 0.0 { filled } else { 0.0 };
        let filled = if filled < most { filled } else { most };
        *mean = if of == layer { own } else { from + filled };
    }
}

/// How much of a layer is at each pixel: 1 where it is, its share of what is near where something is in front, 0 where it is seen
/// that it is not there.
#[inline(always)]
fn cover(mask: &mut [f32], known: &[f32], (of, layer): (&[u8], u8)) {
    for ((mask, &known), &of) in mask.iter_mut().zip(known).zip(of) {
        let near = known > FILL_LEAST as f32;
        let hidden = *mask / if near { known } else { 1.0 };
        let hidden = if near { hidden.clamp(0.0, 1.0) } else { 0.0 };
        *mask = if of == layer {
            1.0
        } else if of < layer {
            hidden
        } else {
            0.0
        };
    }
}
