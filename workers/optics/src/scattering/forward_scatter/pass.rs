//! The gate between two layers: light is propagated back to it and stopped at covered pixels. The rest continues as light of the
//! nearer layer at the range of the gate.

use std::sync::Arc;

use imaging::dct::PairDct;
use imaging::fft::Complex;
use imaging::vectorized;

use super::KernelCache;
use super::cache::Grid;
use super::decimation::line;
use super::gate::Gate;
use super::spectra::zeros;

/// The gate number `l` of a channel; `None` if it or a nearer one is opaque.
pub(super) fn open_gate(gates: &[Option<Gate>], l: usize) -> Option<Gate> {
    let is_open = gates[..=l].iter().all(Option::is_some);
    gates[l].filter(|_| is_open)
}

/// Light of each channel that passes its gate; `None` for a channel whose gate is opaque. Without a mask all pixels are open.
/// `spectra` are in units of the direct transmittance of the gate.
pub(super) fn pass(
    spectra: &[Vec<f32>],
    gates: &[Option<Gate>],
    mask: Option<&[f32]>,
    size: (usize, usize),
    cache: &mut KernelCache,
) -> Vec<Option<Vec<f32>>> {
    let open: Vec<usize> = (0..gates.len()).filter(|&c| gates[c].is_some()).collect();
    let mut passed: Vec<Option<Vec<f32>>> = gates.iter().map(|_| None).collect();
    for pair in open.chunks(2) {
        let responses: Vec<Response<'_>> = pair
            .iter()
            .filter_map(|&c| Some(Response::new(&spectra[c], gates[c]?, size, cache)))
            .collect();
        let mut light = zeros(pair.len(), size, cache);
        take_back(&responses, mask, cache.transform(size), &mut light);
        for (&c, light) in pair.iter().zip(light) {
            passed[c] = Some(light);
        }
    }
    passed
}

/// The spectrum of one channel and the response of its gate, `A/T`.
struct Response<'a> {
    spectrum: &'a [f32],
    /// n/T and v/T with the kernel of each.
    kernels: Vec<(f32, Arc<Grid>)>,
}

impl<'a> Response<'a> {
    fn new(spectrum: &'a [f32], gate: Gate, size: (usize, usize), cache: &mut KernelCache) -> Self {
        let parts = gate.ratios().into_iter().zip(gate.reaches());
        let kernels = parts.filter(|(ratio, _)| *ratio != 0.0);
        let kernels = kernels.map(|(ratio, reach)| {
            let kernel = cache.gated_transfer(reach.gamma_px, size, size.1, reach);
            (ratio as f32, kernel)
        });
        Self {
            spectrum,
            kernels: kernels.collect(),
        }
    }

    /// A/T of one column of the spectrum.
    fn column(&self, p: usize, response: &mut [f32]) {
        response.fill(1.0);
        for (ratio, kernel) in &self.kernels {
            let Some(kernel) = kernel.column(p) else { continue };
            vectorized!({
                for (to, h) in response.iter_mut().zip(kernel) {
                    *to += ratio * h;
                }
            });
        }
    }
}

/// Uncovered light of one or two channels at the gate.
fn take_back(pair: &[Response<'_>], mask: Option<&[f32]>, transform: &mut PairDct, passed: &mut [Vec<f32>]) {
    let (width, height) = transform.size();
    let mut response = vec![0.0; height];
    transform.inverse(
        |p, column| {
            column.fill(Complex::default());
            for (part, of) in pair.iter().enumerate() {
                of.column(p, &mut response);
                let values = &of.spectrum[line(p, height)];
                match part {
                    0 => vectorized!(quotients(values, &response, column, |to, v| to.re = v)),
                    _ => vectorized!(quotients(values, &response, column, |to, v| to.im = v)),
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
