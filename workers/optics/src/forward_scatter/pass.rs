//! The gate between two layers: light is taken back to it, stopped at covered pixels, and sent on.

use imaging::dct::PairDct;
use imaging::fft::Complex;
use imaging::vectorized;

use super::KernelCache;
use super::chebyshev::{line, zeros};
use super::gate::Gate;

/// A gate that light of one channel passes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Opening {
    gate: Gate,
    /// T of this gate over T of the next nearer one, the unit of the light from here on.
    onward: f64,
}

impl Opening {
    /// Gate number `l` of a channel; `None` if it or a nearer one is opaque.
    pub(super) fn between(gates: &[Option<Gate>], l: usize) -> Option<Self> {
        let is_open = gates[..=l].iter().all(Option::is_some);
        let gate = gates[l].filter(|_| is_open)?;
        let next = l.checked_sub(1).and_then(|next| gates[next]);
        Some(Self {
            gate,
            onward: gate.direct / next.map_or(1.0, |next| next.direct),
        })
    }

    /// A/T column by column.
    fn response(&self, size: (usize, usize), cache: &mut KernelCache) -> Vec<f32> {
        let (width, height) = size;
        let mut response = cache.buffers.take(width * height);
        response.fill(1.0);
        let parts = self.gate.ratios().into_iter().zip(self.gate.reaches());
        for (ratio, reach) in parts.filter(|(ratio, _)| *ratio != 0.0) {
            let (weight, kernel) = (ratio as f32, cache.gated_transfer(reach.gamma_px, size, reach));
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
        response
    }
}

/// Takes light back to a gate, multiplies it by the uncovered share of each pixel, and sends it on. A channel without an opening becomes
/// dark; without a mask all pixels are open.
pub(super) fn pass(
    spectra: &mut [Vec<f32>],
    openings: &[Option<Opening>],
    mask: Option<&[f32]>,
    size: (usize, usize),
    cache: &mut KernelCache,
) {
    let mut open = Vec::new();
    for (spectrum, opening) in spectra.iter_mut().zip(openings) {
        match opening {
            Some(opening) => open.push(Open {
                spectrum,
                response: opening.response(size, cache),
                onward: opening.onward as f32,
            }),
            None => spectrum.fill(0.0),
        }
    }
    let mut passed = zeros(2, size, cache);
    for pair in open.chunks_mut(2) {
        let transform = cache.transform(size);
        take_back(pair, mask, transform, &mut passed);
        send_on(pair, &passed, transform);
    }
    cache.buffers.give(passed);
    cache.buffers.give(open.into_iter().map(|open| open.response));
}

/// One channel at its gate.
struct Open<'a> {
    spectrum: &'a mut Vec<f32>,
    response: Vec<f32>,
    onward: f32,
}

/// Uncovered light of one or two channels at the gate.
fn take_back(pair: &[Open<'_>], mask: Option<&[f32]>, transform: &mut PairDct, passed: &mut [Vec<f32>]) {
    let (width, height) = transform.size();
    transform.inverse(
        |p, column| {
            column.fill(Complex::default());
            for (part, open) in pair.iter().enumerate() {
                let band = line(p, height);
                let (values, response) = (&open.spectrum[band.clone()], &open.response[band]);
                match part {
                    0 => vectorized!(quotients(values, response, column, |to, v| to.re = v)),
                    _ => vectorized!(quotients(values, response, column, |to, v| to.im = v)),
                }
            }
        },
        width,
        |place, row| {
            let pixels = line(place, width);
            let covers = mask.map(|mask| &mask[pixels.clone()]);
            for (part, passed) in passed.iter_mut().enumerate() {
                let light = &mut passed[pixels.clone()];
                match part {
                    0 => vectorized!(uncovered(row, covers, light, |v| v.re)),
                    _ => vectorized!(uncovered(row, covers, light, |v| v.im)),
                }
            }
        },
    );
}

/// Spectra of the light beyond the gate.
fn send_on(pair: &mut [Open<'_>], passed: &[Vec<f32>], transform: &mut PairDct) {
    let (width, height) = transform.size();
    transform.forward(
        |place, row| {
            let pixels = line(place, width);
            let lights = passed[0][pixels.clone()].iter().zip(&passed[1][pixels]);
            row.iter_mut()
                .zip(lights)
                .for_each(|(value, (&one, &other))| *value = Complex::new(one, other));
        },
        width,
        |p, column| {
            for (part, open) in pair.iter_mut().enumerate() {
                let band = line(p, height);
                let (values, response) = (&mut open.spectrum[band.clone()], &open.response[band]);
                match part {
                    0 => vectorized!(products(column, response, open.onward, values, |v| v.re)),
                    _ => vectorized!(products(column, response, open.onward, values, |v| v.im)),
                }
            }
        },
    );
}

#[inline(always)]
fn quotients(values: &[f32], by: &[f32], to: &mut [Complex<f32>], set: impl Fn(&mut Complex<f32>, f32)) {
    for (to, (value, by)) in to.iter_mut().zip(values.iter().zip(by)) {
        set(to, value / by);
    }
}

#[inline(always)]
fn uncovered(
    row: &[Complex<f32>],
    covers: Option<&[f32]>,
    to: &mut [f32],
    part: impl Fn(Complex<f32>) -> f32,
) {
    for (to, &value) in to.iter_mut().zip(row) {
        let value = part(value);
        *to = if value > 0.0 { value } else { 0.0 };
    }
    if let Some(covers) = covers {
        for (to, cover) in to.iter_mut().zip(covers) {
            *to *= 1.0 - cover;
        }
    }
}

#[inline(always)]
fn products(
    column: &[Complex<f32>],
    by: &[f32],
    onward: f32,
    to: &mut [f32],
    part: impl Fn(Complex<f32>) -> f32,
) {
    for (to, (&value, by)) in to.iter_mut().zip(column.iter().zip(by)) {
        *to = part(value) * by * onward;
    }
}
