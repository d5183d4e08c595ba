//! Pairs of terms of light that is spread: their share of the light, its transform, and the sum of its spectrum.

use std::ops::Range;
use std::sync::Arc;

use imaging::fft::Complex;
use imaging::vectorized;

use super::KernelCache;
use super::basis::BLOCK;
use super::cache::Grid;
use super::channel::{Channel, Pair, Passed};
use super::decimation::{Decimation, line};

/// Two terms before their transform.
pub(super) struct Spread<'a> {
    channels: &'a [Channel<'a>],
    pair: Pair,
    transfers: [Arc<Grid>; 2],
    size: (usize, usize),
}

impl<'a> Spread<'a> {
    pub(super) fn new(
        channels: &'a [Channel<'a>],
        pair: Pair,
        size: (usize, usize),
        cache: &mut KernelCache,
    ) -> Self {
        Self {
            channels,
            pair,
            transfers: pair.transfers(channels, cache),
            size,
        }
    }

    pub(super) fn add_to(&self, sums: &mut [Vec<f32>], cache: &mut KernelCache) {
        cache.transform(self.size).forward(
            |place, row| self.fill(place, row),
            self.columns(),
            |p, column| self.take(p, column, sums),
        );
    }

    /// Whether a row has no light.
    fn is_dark(&self, place: usize) -> bool {
        let pixels = line(place, self.size.0);
        let is_dark = |channel: usize| {
            let light = &self.channels[channel].light[pixels.clone()];
            vectorized!(light.iter().fold(0, |bits, value| bits | value.to_bits())) == 0
        };
        self.pair.passed(self.channels).iter().all(Option::is_none)
            && self.pair.channels().into_iter().all(is_dark)
    }

    fn columns(&self) -> usize {
        let [first, second] = &self.transfers;
        first.columns().max(second.columns())
    }

    /// A row of light of both terms.
    fn fill(&self, place: usize, row: &mut [Complex<f32>]) {
        let pixels = line(place, self.size.0);
        vectorized!(split(self.channels, self.pair, pixels.clone(), row));
        let [one, other] = self.pair.passed(self.channels);
        if let Some(passed) = one {
            vectorized!(add_passed(passed, pixels.clone(), row, |to| &mut to.re));
        }
        if let Some(passed) = other {
            vectorized!(add_passed(passed, pixels.clone(), row, |to| &mut to.im));
        }
    }

    /// Adds a column of low frequencies under the transfer function of each term.
    fn take(&self, p: usize, column: &[Complex<f32>], sums: &mut [Vec<f32>]) {
        let channels = self.pair.channels().map(|channel| &self.channels[channel]);
        let gains = channels.map(|channel| channel.gain);
        let [one, other] = channels.map(|channel| channel.sum);
        let start = p * self.size.1;
        let band = start..start + column.len();
        let transfers = self.transfers.each_ref().map(|transfer| transfer.column(p));
        match transfers {
            [Some(first), Some(second)] if one == other && gains == [1.0; 2] => {
                add_products(&mut sums[one][band], column, [first, second]);
            }
            [Some(first), Some(second)] if one == other => {
                add_gained(&mut sums[one][band], column, [first, second], gains);
            }
            [first, second] => {
                if let Some(transfer) = first {
                    add_product(&mut sums[one][band.clone()], column, transfer, |v| {
                        gains[0] * v.re
                    });
                }
                if let Some(transfer) = second {
                    add_product(&mut sums[other][band], column, transfer, |v| gains[1] * v.im);
                }
            }
        }
    }
}

/// Two terms on coarse rows.
pub(super) struct CoarseSpread<'a> {
    pub(super) spread: Spread<'a>,
    pub(super) decimation: Arc<Decimation>,
    /// Memory for the coarse rows.
    pub(super) coarse: Vec<Complex<f32>>,
}

/// Adds terms that mostly have one channel, whose rows stay in the nearest cache for all of them. The spectrum of coarse rows is that of
/// low frequencies.
pub(super) fn add_coarse(
    mut together: Vec<CoarseSpread<'_>>,
    (width, height): (usize, usize),
    sums: &mut [Vec<f32>],
    cache: &mut KernelCache,
) {
    for CoarseSpread {
        decimation, coarse, ..
    } in &mut together
    {
        coarse.clear();
        coarse.resize(width * decimation.coarse_height(), Complex::default());
    }
    let mut row = vec![Complex::default(); width];
    for place in 0..height {
        for CoarseSpread {
            spread,
            decimation,
            coarse,
        } in &mut together
        {
            if !spread.is_dark(place) {
                spread.fill(place, &mut row);
                decimation.add_row(place, &row, coarse);
            }
        }
    }
    for CoarseSpread {
        spread,
        decimation,
        coarse,
    } in together
    {
        let mut spectrum = vec![Complex::default(); decimation.coarse_height()];
        cache.transform((width, decimation.coarse_height())).forward(
            |place, row| row.copy_from_slice(&coarse[line(place, width)]),
            spread.columns(),
            |p, column| {
                let pairs = column.iter().zip(decimation.response());
                for (to, (value, response)) in spectrum.iter_mut().zip(pairs) {
                    *to = value.unscale(*response);
                }
                spread.take(p, &spectrum, sums);
            },
        );
        cache.coarse.push(coarse);
    }
}

/// `l_k U` of both terms, in the pixels of a row.
#[inline(always)]
fn split(channels: &[Channel<'_>], pair: Pair, pixels: Range<usize>, row: &mut [Complex<f32>]) {
    let [one, other] = pair
        .channels()
        .map(|channel| &channels[channel].light[pixels.clone()]);
    let mut shares = [[0.0; BLOCK]; 2];
    for (block, row) in row.chunks_mut(BLOCK).enumerate() {
        let place = block * BLOCK..block * BLOCK + row.len();
        pair.shares(channels, pixels.start + place.start, row.len(), &mut shares);
        let lights = one[place.clone()].iter().zip(&other[place]);
        let [first, second] = &shares;
        for ((sample, (one, other)), (first, second)) in
            row.iter_mut().zip(lights).zip(first.iter().zip(second))
        {
            *sample = Complex::new(one * first, other * second);
        }
    }
}

/// Adds light that passed a gate to one part of a row.
#[inline(always)]
fn add_passed(
    passed: Passed<'_>,
    pixels: Range<usize>,
    row: &mut [Complex<f32>],
    part: impl Fn(&mut Complex<f32>) -> &mut f32,
) {
    for (to, light) in row.iter_mut().zip(&passed.light[pixels]) {
        *part(to) += passed.share * light;
    }
}

/// Adds both parts of a column of the spectrum, each times its H.
fn add_products(sum: &mut [f32], column: &[Complex<f32>], [first, second]: [&[f32]; 2]) {
    vectorized!({
        let products = column.iter().zip(first.iter().zip(second));
        for (sum, (value, (one, other))) in sum.iter_mut().zip(products) {
            *sum += value.re * one + value.im * other;
        }
    });
}

/// The same with a factor of each part.
fn add_gained(
    sum: &mut [f32],
    column: &[Complex<f32>],
    [first, second]: [&[f32]; 2],
    [one_gain, other_gain]: [f32; 2],
) {
    vectorized!({
        let products = column.iter().zip(first.iter().zip(second));
        for (sum, (value, (one, other))) in sum.iter_mut().zip(products) {
            *sum += one_gain * value.re * one + other_gain * value.im * other;
        }
    });
}

/// Adds one part of a column of the spectrum times its H.
fn add_product(
    sum: &mut [f32],
    column: &[Complex<f32>],
    transfer: &[f32],
    part: impl Fn(&Complex<f32>) -> f32,
) {
    vectorized!({
        for (sum, (value, h)) in sum.iter_mut().zip(column.iter().zip(transfer)) {
            *sum += part(value) * h;
        }
    });
}
