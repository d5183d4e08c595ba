//! The definition, in double precision: pad, transform, multiply, transform back, crop.

use imaging::Plane;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

use super::padding::{padded_side, source};
use crate::hscm::luma::Luma;
use crate::hscm::options::{Options, Profile, Settings};

/// The filtered logarithm `x`. The scalar planner is used so that every machine computes the same bits.
pub(super) fn filtered_log(luma: &Luma, options: &Options) -> Plane<f64> {
    let Settings {
        r_high,
        r_low,
        profile,
        ..
    } = *options.settings();
    let codes = luma.codes();
    let (width, height) = codes.size();
    let (padded_width, padded_height) = (padded_side(width), padded_side(height));
    let delta = options.delta_bins(width);

    let white = f64::from(luma.white());
    let logs = codes.map(|&code| super::log(f64::from(code) / white, options));
    let mut bins = Plane::from_fn(padded_width, padded_height, |x, y| {
        let sample = source(x, width, profile).zip(source(y, height, profile));
        Complex::new(sample.map_or(0.0, |(x, y)| logs.at(x, y)), 0.0)
    });

    let mut planner = FftPlannerScalar::new();
    let [along_x, along_y] = [padded_width, padded_height].map(|side| planner.plan_fft_forward(side));
    transform(&mut bins, along_x.as_ref(), along_y.as_ref());
    for v in 0..padded_height {
        for (u, bin) in bins.row_mut(v).iter_mut().enumerate() {
            // Signed bin numbers: the second half of a side counts back from its end.
            let signed = |k: usize, side: usize| k.min(side - k) as f64 / delta;
            let (u, v) = (signed(u, padded_width), signed(v, padded_height));
            *bin *= (r_high - r_low) * (1.0 - (-0.5 * (u * u + v * v)).exp()) + r_low;
        }
    }
    let [along_x, along_y] = [padded_width, padded_height].map(|side| planner.plan_fft_inverse(side));
    transform(&mut bins, along_x.as_ref(), along_y.as_ref());

    let scale = 1.0 / (padded_width * padded_height) as f64;
    Plane::from_fn(width, height, |x, y| bins.at(x, y).re * scale)
}

/// Transforms every row, then every column.
fn transform(bins: &mut Plane<Complex<f64>>, along_x: &dyn Fft<f64>, along_y: &dyn Fft<f64>) {
    let (width, height) = bins.size();
    along_x.process(bins.data_mut());
    let mut columns = Plane::from_fn(height, width, |y, x| bins.at(x, y));
    along_y.process(columns.data_mut());
    for y in 0..height {
        for (x, bin) in bins.row_mut(y).iter_mut().enumerate() {
            *bin = columns.at(y, x);
        }
    }
}

/// The 8-bit code of `exp(x)`; values above white saturate.
pub(super) fn code(x: f64, options: &Options) -> u8 {
    let value = 255.0 * x.min(0.0).exp();
    match options.settings().profile {
        Profile::Standard => (value + 0.5) as u8,
        Profile::Table1 => value as u8,
    }
}
