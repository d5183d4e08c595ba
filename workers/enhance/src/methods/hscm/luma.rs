//! Luma of a raster in exact integers.

use imaging::{Channels, Plane, Raster, Samples, vectorized};

use crate::signs::{dark_below, is_dark};

/// Luma codes and the code of white: `y = code / white` in 0..=1.
///
/// Codes are `299 R + 587 G + 114 B` at the depth of the file, without rounding: white is 255 000 at 8 bit and 65 535
/// 000 at 16 bit. Gray counts as R = G = B.
#[derive(Debug, Clone, PartialEq)]
pub struct Luma {
    codes: Plane<u32>,
    white: u32,
    low: u32,
    high: u32,
    /// Number of nearly black pixels.
    dark: usize,
}

impl Luma {
    /// The luma of a raster; alpha is ignored.
    #[must_use]
    pub fn new(picture: &Raster) -> Self {
        let white = match picture.samples() {
            Samples::U8(_) => 255_000,
            Samples::U16(_) => 65_535_000,
        };
        let mut luma = Self {
            codes: Plane::filled(picture.width(), picture.height(), 0u32),
            white,
            low: u32::MAX,
            high: 0,
            dark: 0,
        };
        vectorized!(luma.measure(picture));
        luma
    }

    #[inline(always)]
    fn measure(&mut self, picture: &Raster) {
        let codes = self.codes.data_mut();
        match picture.samples() {
            Samples::U8(samples) => weigh(samples, picture.channels(), codes),
            Samples::U16(samples) => weigh(samples, picture.channels(), codes),
        }
        let bound = dark_below(self.white);
        let (mut low, mut high, mut dark) = (u32::MAX, 0, 0u32);
        for &code in self.codes.data() {
            low = low.min(code);
            high = high.max(code);
            dark += u32::from(code < bound);
        }
        (self.low, self.high, self.dark) = (low, high, dark as usize);
    }

    /// The codes, in thousandths of the file's luma steps.
    #[must_use]
    pub fn codes(&self) -> &Plane<u32> {
        &self.codes
    }

    /// The code of white.
    #[must_use]
    pub fn white(&self) -> u32 {
        self.white
    }

    /// Maps the luma `y` of each pixel.
    pub(crate) fn map(&self, value: impl Fn(f64) -> f64) -> Plane<f64> {
        let white = f64::from(self.white);
        self.codes.map(|&code| value(f64::from(code) / white))
    }

    /// Whether nearly all pixels are nearly black.
    pub(crate) fn is_dark(&self) -> bool {
        is_dark(self.dark, self.codes.data().len())
    }

    /// The smallest and the largest `y`.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let white = f64::from(self.white);
        (f64::from(self.low) / white, f64::from(self.high) / white)
    }
}

#[inline(always)]
fn weigh<T: Copy + Into<u32>>(samples: &[T], channels: Channels, codes: &mut [u32]) {
    match channels {
        Channels::Gray => {
            for (code, &v) in codes.iter_mut().zip(samples) {
                *code = 1000 * v.into();
            }
        }
        Channels::Rgb => {
            for (code, p) in codes.iter_mut().zip(samples.chunks_exact(3)) {
                *code = 299 * p[0].into() + 587 * p[1].into() + 114 * p[2].into();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_one_at_either_depth() {
        let eight = Raster::new(1, 1, Channels::Rgb, Samples::U8(vec![255; 3]), None).unwrap();
        let sixteen = Raster::new(1, 1, Channels::Gray, Samples::U16(vec![65535]), None).unwrap();
        assert_eq!(Luma::new(&eight).extremes(), (1.0, 1.0));
        assert_eq!(Luma::new(&sixteen).extremes(), (1.0, 1.0));
    }

    #[test]
    fn sixteen_bit_steps_below_one_eight_bit_step_are_kept() {
        let picture = Raster::new(2, 1, Channels::Gray, Samples::U16(vec![1000, 1001]), None).unwrap();
        assert_eq!(Luma::new(&picture).codes().data(), &[1_000_000, 1_001_000]);
    }
}
