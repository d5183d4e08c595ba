//! Step 2: the background light.

use imaging::{Plane, Rgb8};

use super::sigmoid;
use crate::blocks::{calmest, highest, histogram, largest, top_count};
use crate::variant::Variant;

/// Codes above this are above 0.5.
const HALF: usize = 127;
/// Part of bright pixels at which the light turns from the darkest to the brightest candidate.
const BRIGHT_PART: f64 = 0.2;

/// The part of the pixels of each channel that lies above 0.5.
fn bright_parts(picture: &Rgb8) -> [f64; 3] {
    histogram::histograms(picture).map(|counts| {
        let bright: u64 = counts[HALF + 1..].iter().sum();
        bright as f64 / histogram::total(&counts) as f64
    })
}

/// Whether a channel is bright enough for its brightest candidate to become the light.
pub(super) fn is_bright(picture: &Rgb8) -> bool {
    bright_parts(picture).iter().any(|&part| part > BRIGHT_PART)
}

pub(super) fn background(picture: &Rgb8, blurriness: &Plane<f64>, variant: Variant) -> [f64; 3] {
    let candidates = [
        mean_of_largest(picture, blurriness, variant),
        calmest(picture).mean_color(picture),
        highest(blurriness).mean_color(picture),
    ];
    let bright = bright_parts(picture);
    std::array::from_fn(|channel| {
        let values = candidates.map(|candidate| candidate[channel]);
        let (min, max) = (
            values.into_iter().fold(1.0, f64::min),
            values.into_iter().fold(0.0, f64::max),
        );
        let s = sigmoid(bright[channel], BRIGHT_PART);
        s * max + (1.0 - s) * min
    })
}

/// The mean color of the thousandth of the pixels with the largest blurriness.
fn mean_of_largest(picture: &Rgb8, blurriness: &Plane<f64>, variant: Variant) -> [f64; 3] {
    let positions = largest(blurriness, top_count(blurriness.data().len()), variant);
    let sum = |channel: usize| -> u64 {
        let codes = positions
            .iter()
            .map(|position| picture.data()[3 * position + channel]);
        codes.map(u64::from).sum()
    };
    [0, 1, 2].map(|channel| sum(channel) as f64 / (255 * positions.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bright_picture_takes_the_brightest_candidate_and_a_dark_one_the_darkest() {
        // Blurriest at the left, calm everywhere.
        let blurriness = Plane::from_fn(40, 40, |x, _| -(x as f64));
        let light_of = |left: u8, right: u8| {
            let picture = Rgb8::from_fn(40, 40, |x, _| if x < 20 { [left; 3] } else { [right; 3] });
            background(&picture, &blurriness, Variant::Fast)
        };
        let near = |got: [f64; 3], code: f64| got.iter().all(|value| (value - code / 255.0).abs() < 0.01);
        assert!(near(light_of(200, 100), 200.0));
        assert!(near(light_of(100, 60), 100.0));
        assert_eq!(
            bright_parts(&Rgb8::from_fn(4, 1, |x, _| [127 + x as u8, 128, 0])),
            [0.75, 1.0, 0.0]
        );
    }
}
