//! Luma of a raster in exact integers.

use imaging::{Channels, Plane, Raster, Samples};

use crate::signs::is_dark;

/// Luma codes and the code of white: `y = code / white` lies in 0..=1.
///
/// Codes are `299 R + 587 G + 114 B` at the depth of the file, so nothing is rounded: white is 255 000 at 8 bit and
/// 65 535 000 at 16 bit. Gray counts as R = G = B.
#[derive(Debug, Clone, PartialEq)]
pub struct Luma {
    codes: Plane<u32>,
    white: u32,
}

impl Luma {
    /// The luma of a raster; alpha is not looked at.
    #[must_use]
    pub fn of(picture: &Raster) -> Self {
        let (codes, white) = match picture.samples() {
            Samples::U8(samples) => (weighted(samples, picture.channels()), 255_000),
            Samples::U16(samples) => (weighted(samples, picture.channels()), 65_535_000),
        };
        let codes = Plane::new(picture.width(), picture.height(), codes)
            .expect("a raster holds one sample set per pixel");
        Self { codes, white }
    }

    /// The codes: thousandths of the file's own luma steps.
    #[must_use]
    pub fn codes(&self) -> &Plane<u32> {
        &self.codes
    }

    /// The code of white.
    #[must_use]
    pub fn white(&self) -> u32 {
        self.white
    }

    /// Whether nearly all pixels are nearly black.
    pub(crate) fn is_dark(&self) -> bool {
        let codes = self.codes.data();
        is_dark(codes.iter().copied(), self.white, codes.len())
    }

    /// The least and the greatest `y`.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let (low, high) = self
            .codes
            .data()
            .iter()
            .fold((u32::MAX, 0), |(low, high), &code| {
                (low.min(code), high.max(code))
            });
        (
            f64::from(low) / f64::from(self.white),
            f64::from(high) / f64::from(self.white),
        )
    }
}

fn weighted<T: Copy + Into<u32>>(samples: &[T], channels: Channels) -> Vec<u32> {
    match channels {
        Channels::Gray => samples.iter().map(|&v| 1000 * v.into()).collect(),
        Channels::Rgb => samples
            .chunks_exact(3)
            .map(|p| 299 * p[0].into() + 587 * p[1].into() + 114 * p[2].into())
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_one_at_either_depth() {
        let eight = Raster::new(1, 1, Channels::Rgb, Samples::U8(vec![255; 3]), None).unwrap();
        let sixteen = Raster::new(1, 1, Channels::Gray, Samples::U16(vec![65535]), None).unwrap();
        assert_eq!(Luma::of(&eight).extremes(), (1.0, 1.0));
        assert_eq!(Luma::of(&sixteen).extremes(), (1.0, 1.0));
    }

    #[test]
    fn sixteen_bit_steps_below_one_eight_bit_step_are_kept() {
        let picture = Raster::new(2, 1, Channels::Gray, Samples::U16(vec![1000, 1001]), None).unwrap();
        assert_eq!(Luma::of(&picture).codes().data(), &[1_000_000, 1_001_000]);
    }
}
