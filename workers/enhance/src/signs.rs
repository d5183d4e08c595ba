//! Signs of failure that several methods look for.

use imaging::{Rgb8, luma1000};

use crate::blocks::histogram::{Histogram, code_at, ends, histograms, mean, total};
use crate::warning::{Warning, found};

/// Fewer pixels leave less than one in a tail of a thousandth.
const FEW_PIXELS: usize = 1000;
/// Luma below which a picture is dark, in codes, and the part of the pixels that must be.
const DARK_LUMA: u32 = 16;
const DARK_PART: f64 = 0.99;
/// Part of a channel's codes that must turn black.
const BLACKENED_PART: f64 = 0.2;
/// How much redder than green and blue a result must be on the mean: a fifth and some codes.
const RED_FACTOR: f64 = 1.2;
const RED_CODES: f64 = 5.0;

/// Counts of the codes of red, green and blue.
pub(crate) type Histograms = [Histogram; 3];

/// What a picture's codes say.
pub(crate) struct Signs {
    pub(crate) histograms: Histograms,
    pixels: usize,
    gray: bool,
    dark: bool,
}

impl Signs {
    /// The signs of a picture with pixels.
    pub(crate) fn of(picture: &Rgb8) -> Self {
        let pixels = picture.data().len() / 3;
        // Whole rows keep the test cheap and let it stop early.
        let gray = picture.data().chunks(3 * 64).all(|run| {
            let unequal = run.chunks_exact(3).map(|p| (p[0] ^ p[1]) | (p[1] ^ p[2]));
            unequal.fold(0, |all, bits| all | bits) == 0
        });
        let bound = dark_below(255_000);
        let dark = picture.pixels().filter(|&pixel| luma1000(pixel) < bound).count();
        Self {
            histograms: histograms(picture),
            pixels,
            gray,
            dark: is_dark(dark, pixels),
        }
    }

    /// Every channel has one code.
    pub(crate) fn constant(&self) -> bool {
        self.histograms.iter().map(ends).all(|(low, high)| low == high)
    }

    /// What any method that measures the whole picture should say of a result with these codes.
    pub(crate) fn common(&self, after: &Histograms) -> Vec<Warning> {
        found([
            (self.constant(), Warning::Constant),
            (self.pixels < FEW_PIXELS, Warning::FewPixels),
            (self.dark, Warning::Dark),
            (self.blackened(after), Warning::Blackened),
        ])
    }

    /// What a restoration should say besides.
    pub(crate) fn of_restoration(&self, after: &Histograms) -> Vec<Warning> {
        let mut warnings = self.common(after);
        warnings.extend(found([(self.gray && !self.constant(), Warning::Gray)]));
        warnings
    }

    /// A channel is black everywhere while another is not.
    pub(crate) fn channel_without_light(&self) -> bool {
        let black = self.histograms.each_ref().map(|histogram| ends(histogram).1 == 0);
        black.contains(&true) && black.contains(&false)
    }

    /// The result is red on the mean and the picture is not.
    pub(crate) fn red_cast(&self, after: &Histograms) -> bool {
        let red = |[r, g, b]: [f64; 3]| r > RED_FACTOR * g.max(b) + RED_CODES;
        red(after.each_ref().map(mean)) && !red(self.histograms.each_ref().map(mean))
    }

    fn blackened(&self, after: &Histograms) -> bool {
        self.histograms
            .iter()
            .zip(after)
            .any(|(before, after)| after[0] as f64 > before[0] as f64 + BLACKENED_PART * total(before) as f64)
    }

    /// The most frequent code of a channel is 0 although it has others.
    pub(crate) fn black_mode(&self) -> bool {
        self.histograms.iter().any(|histogram| {
            let most = histogram.iter().copied().max().unwrap_or(0);
            histogram[0] == most && code_at(histogram, total(histogram) - 1) > 0
        })
    }
}

/// The luma below which a pixel counts as dark; `white` is the luma of white.
pub(crate) fn dark_below(white: u32) -> u32 {
    white / 255 * DARK_LUMA
}

/// Whether nearly all of the pixels are dark.
pub(crate) fn is_dark(dark: usize, pixels: usize) -> bool {
    dark as f64 >= DARK_PART * pixels as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(pixel: [u8; 3]) -> Rgb8 {
        Rgb8::from_fn(40, 30, |_, _| pixel)
    }

    #[test]
    fn one_color_few_pixels_and_darkness_are_seen() {
        let common = |picture: &Rgb8| Signs::of(picture).common(&histograms(picture));
        assert_eq!(common(&flat([9, 80, 90])), [Warning::Constant]);
        assert_eq!(common(&flat([15; 3])), [Warning::Constant, Warning::Dark]);
        let ramp = |width: usize| Rgb8::from_fn(width, 10, |x, _| [x as u8, 99, 99]);
        assert_eq!(common(&ramp(99)), [Warning::FewPixels]);
        assert_eq!(common(&ramp(100)), []);
    }

    #[test]
    fn a_gray_picture_and_a_missing_channel_are_seen() {
        let gray = Rgb8::from_fn(40, 30, |x, _| [x as u8 + 40; 3]);
        assert_eq!(
            Signs::of(&gray).of_restoration(&histograms(&gray)),
            [Warning::Gray]
        );
        let one_off = Rgb8::from_fn(40, 30, |x, y| {
            if (x, y) == (39, 29) {
                [80, 80, 81]
            } else {
                gray.at(x, y)
            }
        });
        assert_eq!(Signs::of(&one_off).of_restoration(&histograms(&one_off)), []);
        assert!(Signs::of(&flat([0, 4, 4])).channel_without_light());
        assert!(!Signs::of(&flat([0; 3])).channel_without_light());
    }

    #[test]
    fn red_and_black_results_are_seen() {
        let signs = Signs::of(&flat([60, 120, 140]));
        assert!(
            signs.red_cast(&histograms(&flat([180, 120, 140])))
                && !signs.red_cast(&histograms(&flat([150, 120, 140])))
        );
        assert_eq!(
            signs.of_restoration(&histograms(&flat([60, 0, 140]))),
            [Warning::Constant, Warning::Blackened]
        );
    }

    #[test]
    fn a_black_mode_needs_other_codes() {
        let mostly_black = Rgb8::from_fn(40, 30, |x, _| [if x < 25 { 0 } else { x as u8 }, 7, 7]);
        assert!(Signs::of(&mostly_black).black_mode());
        assert!(!Signs::of(&flat([0; 3])).black_mode());
    }
}
