//! The definition in f64: pad, transform, multiply, transform back, crop.

use imaging::fft::{self, Complex, Fft};
use imaging::{Plane, reflected};

use super::padding::padded_side;
use super::parameters::Filter;
use crate::methods::hscm::luma::Luma;

pub(super) fn filtered_log(luma: &Luma, filter: &Filter) -> Plane<f64> {
    let (width, height) = luma.codes().size();
    let (padded_width, padded_height) = (padded_side(width), padded_side(height));
    let logs = luma.map(|y| (y + filter.eps).ln());
    let mut bins = Plane::from_fn(padded_width, padded_height, |x, y| {
        Complex::new(
            logs.pixel(reflected(x as isize, width), reflected(y as isize, height)),
            0.0,
        )
    });

    let [along_x, along_y] = [padded_width, padded_height].map(fft::double);
    transform(&mut bins, along_x.forward.as_ref(), along_y.forward.as_ref());
    for v in 0..padded_height {
        for (u, bin) in bins.row_mut(v).iter_mut().enumerate() {
            // Signed bin numbers: the second half of a side counts back from its end.
            let u = u.min(padded_width - u) as f64 / filter.delta;
            let v = v.min(padded_height - v) as f64 / filter.delta;
            *bin *= filter.drop() * (1.0 - (-0.5 * (u * u + v * v)).exp()) + filter.gain_low;
        }
    }
    transform(&mut bins, along_x.inverse.as_ref(), along_y.inverse.as_ref());

    let scale = 1.0 / (padded_width * padded_height) as f64;
    Plane::from_fn(width, height, |x, y| bins.pixel(x, y).re * scale)
}

/// Transforms every row, then every column.
fn transform(bins: &mut Plane<Complex<f64>>, along_x: &dyn Fft<f64>, along_y: &dyn Fft<f64>) {
    let (width, height) = bins.size();
    along_x.process(bins.data_mut());
    let mut columns = Plane::from_fn(height, width, |y, x| bins.pixel(x, y));
    along_y.process(columns.data_mut());
    for y in 0..height {
        for (x, bin) in bins.row_mut(y).iter_mut().enumerate() {
            *bin = columns.pixel(y, x);
        }
    }
}

/// The 8-bit code of `exp(x)`; values above white saturate.
pub(super) fn code(x: f64) -> u8 {
    (255.0 * x.min(0.0).exp() + 0.5) as u8
}
