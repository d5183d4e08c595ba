//! An unoccluded layer of a frame, in f32 and in the order of the transform.

use std::ops::Range;

use imaging::fft::Complex;
use imaging::vectorized;

use super::KernelCache;
use super::cache::Grid;
use super::decimation::{Coarseness, Decimation, aliasing, line};
use crate::layering::Layering;
use crate::range::is_hole;

/// Kernel for filling occluded pixels, as a share of the frame's width; at least 1 pixel.
const FILL_SHARE: f64 = 1.0 / 40.0;
/// Scale of the kernel for filling in coarse rows: the fill is a quotient with a possibly small divisor.
const FILL_RATIO: f64 = 6.25;
/// Below this share of known pixels under the kernel, the fill is 0.
pub(crate) const FILL_LEAST: f64 = 1e-6;

/// Scale of the kernel for filling occluded pixels, pixels.
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

/// One layer, filled behind nearer ones.
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

    /// One layer. It is dark outside its pixels.
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

    /// Spreads planes by the kernel that fills, two in each transform, on coarse rows.
    fn spread(&self, mut planes: Vec<&mut Vec<f32>>, cache: &mut KernelCache) {
        let (width, height) = self.size;
        let gamma = fill_gamma_px(width);
        let coarse = Coarseness {
            limit: aliasing(FILL_RATIO),
            origin: 0.0,
        };
        let rows = coarse.rows(gamma, height).unwrap_or(height);
        let kernel = cache.transfer(gamma, self.size, rows);
        let decimation = cache.decimation(height, rows);
        let factors = coarse_kernel(&kernel, &decimation);
        let (columns, coarse_height) = (kernel.columns(), decimation.coarse_height());
        let mut coarse = cache.coarse.pop().unwrap_or_default();
        coarse.resize(width * coarse_height, Complex::default());
        let transform = cache.transform((width, coarse_height));
        let mut row = vec![Complex::default(); width];
        let mut spectrum = vec![Complex::default(); columns * coarse_height];
        for pair in planes.chunks_mut(2) {
            coarse.fill(Complex::default());
            for place in 0..height {
                join_rows(pair, line(place, width), &mut row);
                decimation.add_row(place, &row, &mut coarse);
            }
            transform.forward(
                |place, row| row.copy_from_slice(&coarse[line(place, width)]),
                columns,
                |p, column| {
                    let band = line(p, coarse_height);
                    let (to, factors) = (&mut spectrum[band.clone()], &factors[band]);
                    vectorized!(scale(to, column, factors));
                },
            );
            transform.inverse(
                |p, column| column.copy_from_slice(&spectrum[line(p, coarse_height)]),
                columns,
                |place, row| coarse[line(place, width)].copy_from_slice(row),
            );
            for place in 0..height {
                decimation.row_between(place, &coarse, &mut row);
                part_rows(&row, line(place, width), pair);
            }
        }
        cache.coarse.push(coarse);
    }
}

/// H over the responses of both passes to and from the coarse rows.
fn coarse_kernel(kernel: &Grid, decimation: &Decimation) -> Vec<f32> {
    let response = decimation.response();
    let step = decimation.step() as f32;
    let mut factors = Vec::with_capacity(kernel.columns() * response.len());
    for column in (0..kernel.columns()).filter_map(|p| kernel.column(p)) {
        let pairs = column.iter().zip(response);
        factors.extend(pairs.map(|(h, w)| h / (w * w * step)));
    }
    factors
}

/// One row of one or two planes.
fn join_rows(planes: &[&mut Vec<f32>], pixels: Range<usize>, row: &mut [Complex<f32>]) {
    let one = &planes[0][pixels.clone()];
    let other = &planes[planes.len() - 1][pixels];
    vectorized!({
        for (to, (&one, &other)) in row.iter_mut().zip(one.iter().zip(other)) {
            *to = Complex::new(one, other);
        }
    });
}

/// Undoes [`join_rows`].
fn part_rows(row: &[Complex<f32>], pixels: Range<usize>, planes: &mut [&mut Vec<f32>]) {
    for (part, plane) in planes.iter_mut().enumerate() {
        let to = &mut plane[pixels.clone()];
        vectorized!({
            for (to, value) in to.iter_mut().zip(row) {
                *to = if part == 0 { value.re } else { value.im };
            }
        });
    }
}

#[inline(always)]
fn scale(to: &mut [Complex<f32>], values: &[Complex<f32>], factors: &[f32]) {
    for (to, (value, &factor)) in to.iter_mut().zip(values.iter().zip(factors)) {
        *to = value.scale(factor);
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

/// 1 in the chosen layers, else 0.
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

/// The layer's values on its pixels, elsewhere the mean of nearby ones: `from` plus the ratio of `means` to `weights`, at most `from
/// + most`.
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

/// Coverage of a layer at each pixel: 1 on it, its share of the surroundings behind a nearer layer, 0 on a farther one.
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
