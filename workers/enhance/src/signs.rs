//! Signs of failure shared by several methods.

use imaging::{Rgb8, luma1000};

use crate::blocks::histogram::{CodeCounts, code_at, ends, histograms, mean, total};
use crate::warning::{Warning, found};

/// Fewer pixels leave less than one in a tail of a thousandth.
const FEW_PIXELS: usize = 1000;
/// Luma below which a pixel is dark, in codes; `DARK_PART` of the pixels make a picture dark.
const DARK_LUMA: u32 = 16;
const DARK_PART: f64 = 0.99;
/// Share of a channel's codes that must turn black.
const BLACKENED_PART: f64 = 0.2;
/// Redness of a result relative to green and blue in the mean: a fifth plus some codes.
const RED_FACTOR: f64 = 1.2;
const RED_CODES: f64 = 5.0;

/// Statistics of a picture before and after a method.
pub(crate) struct Signs {
    pixels: usize,
    dark: usize,
    has_equal_channels: bool,
    before: [CodeCounts; 3],
    after: [CodeCounts; 3],
}

/// A warning and its test.
pub(crate) type FailureSign = (Warning, fn(&Signs) -> bool);

/// The warnings common to all methods, then those of `others` with a positive test, for a non-empty picture and its
/// result.
pub(crate) fn warnings(picture: &Rgb8, result: &Rgb8, others: &[FailureSign]) -> Vec<Warning> {
    let bound = dark_below(255_000);
    // Runs of pixels keep the test cheap and let it stop early.
    let has_equal_channels = picture.data().chunks(3 * 64).all(|run| {
        let unequal = run.chunks_exact(3).map(|p| (p[0] ^ p[1]) | (p[1] ^ p[2]));
        unequal.fold(0, |all, bits| all | bits) == 0
    });
    let signs = Signs {
        pixels: picture.pixels().len(),
        dark: picture.pixels().filter(|&pixel| luma1000(pixel) < bound).count(),
        has_equal_channels,
        before: histograms(picture),
        after: histograms(result),
    };
    let common: [FailureSign; 4] = [
        (Warning::Constant, Signs::is_constant),
        (Warning::FewPixels, Signs::has_few_pixels),
        (Warning::Dark, Signs::is_dark),
        (Warning::Blackened, Signs::is_blackened),
    ];
    found(
        common
            .iter()
            .chain(others)
            .map(|(warning, test)| (test(&signs), *warning)),
    )
}

impl Signs {
    fn is_constant(&self) -> bool {
        self.before.iter().map(ends).all(|(low, high)| low == high)
    }

    fn has_few_pixels(&self) -> bool {
        self.pixels < FEW_PIXELS
    }

    fn is_dark(&self) -> bool {
        is_dark(self.dark, self.pixels)
    }

    /// A fifth of a channel became 0.
    fn is_blackened(&self) -> bool {
        self.before
            .iter()
            .zip(&self.after)
            .any(|(before, after)| after[0] as f64 > before[0] as f64 + BLACKENED_PART * total(before) as f64)
    }

    /// Red, green and blue are equal everywhere, and there are several grays.
    pub(crate) fn is_gray(&self) -> bool {
        self.has_equal_channels && !self.is_constant()
    }

    /// A channel is black everywhere while another is not.
    pub(crate) fn lacks_a_channel(&self) -> bool {
        let black = self.before.each_ref().map(|histogram| ends(histogram).1 == 0);
        black.contains(&true) && black.contains(&false)
    }

    /// The result is red in the mean and the picture is not.
    pub(crate) fn turned_red(&self) -> bool {
        is_red(&self.after) && !is_red(&self.before)
    }

    /// The most frequent code of a channel is 0 although it has others.
    pub(crate) fn has_black_mode(&self) -> bool {
        self.before.iter().any(|histogram| {
            let most = histogram.iter().copied().max().unwrap_or(0);
            histogram[0] == most && code_at(histogram, total(histogram) - 1) > 0
        })
    }
}

/// The luma threshold of dark pixels; `white` is the luma of white.
pub(crate) fn dark_below(white: u32) -> u32 {
    white / 255 * DARK_LUMA
}

/// Whether nearly all of the pixels are dark.
pub(crate) fn is_dark(dark: usize, pixels: usize) -> bool {
    dark as f64 >= DARK_PART * pixels as f64
}

fn is_red(histograms: &[CodeCounts; 3]) -> bool {
    let [r, g, b] = histograms.each_ref().map(mean);
    r > RED_FACTOR * g.max(b) + RED_CODES
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(pixel: [u8; 3]) -> Rgb8 {
        Rgb8::from_fn(40, 30, |_, _| pixel)
    }

    fn only(sign: FailureSign, before: &Rgb8, after: &Rgb8) -> bool {
        warnings(before, after, &[sign]).contains(&sign.0)
    }

    #[test]
    fn one_color_few_pixels_and_darkness_are_seen() {
        let common = |picture: &Rgb8| warnings(picture, picture, &[]);
        assert_eq!(common(&flat([9, 80, 90])), [Warning::Constant]);
        assert_eq!(common(&flat([15; 3])), [Warning::Constant, Warning::Dark]);
        let ramp = |width: usize| Rgb8::from_fn(width, 10, |x, _| [x as u8, 99, 99]);
        assert_eq!(common(&ramp(99)), [Warning::FewPixels]);
        assert_eq!(common(&ramp(100)), []);
    }

    #[test]
    fn a_gray_picture_and_a_missing_channel_are_seen() {
        let is_gray = |picture: &Rgb8| only((Warning::Gray, Signs::is_gray), picture, picture);
        let gray = Rgb8::from_fn(40, 30, |x, _| [x as u8 + 40; 3]);
        let one_off = Rgb8::from_fn(40, 30, |x, y| {
            if (x, y) == (39, 29) {
                [80, 80, 81]
            } else {
                gray.pixel(x, y)
            }
        });
        assert!(is_gray(&gray) && !is_gray(&one_off));
        let lacks = |picture: &Rgb8| {
            let sign = (
                Warning::ChannelWithoutLight,
                Signs::lacks_a_channel as fn(&Signs) -> bool,
            );
            only(sign, picture, picture)
        };
        assert!(lacks(&flat([0, 4, 4])) && !lacks(&flat([0; 3])));
    }

    #[test]
    fn red_and_black_results_are_seen() {
        let water = flat([60, 120, 140]);
        let turned = |after: [u8; 3]| only((Warning::RedCast, Signs::turned_red), &water, &flat(after));
        assert!(turned([180, 120, 140]) && !turned([150, 120, 140]));
        assert_eq!(
            warnings(&water, &flat([60, 0, 140]), &[]),
            [Warning::Constant, Warning::Blackened]
        );
    }

    #[test]
    fn a_black_mode_needs_other_codes() {
        let has = |picture: &Rgb8| only((Warning::BlackMode, Signs::has_black_mode), picture, picture);
        let mostly_black = Rgb8::from_fn(40, 30, |x, _| [if x < 25 { 0 } else { x as u8 }, 7, 7]);
        assert!(has(&mostly_black) && !has(&flat([0; 3])));
    }
}
