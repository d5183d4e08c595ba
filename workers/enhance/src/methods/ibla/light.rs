//! Step 2: the background light.

use imaging::{Plane, Rgb8};

use crate::blocks::{calmest, histogram, largest, lowest};
use crate::variant::Variant;

/// Codes above this are above 0.5.
const HALF: usize = 127;
/// Share of bright pixels at the transition from the darkest to the brightest candidate.
const BRIGHT_PART: f64 = 0.2;
/// The most blurred pixels are one in this many.
const BLURRED: usize = 1000;
/// If candidates of a channel with an undecided sigmoid differ by more than this, the light is unstable.
const APART: f64 = 0.1;

/// The background light and its candidates.
#[derive(Debug)]
pub(super) struct BackgroundLight {
    /// The color, 0..=1.
    pub(super) color: [f64; 3],
    /// Colors of the most blurred pixels, of the calmest region and of the most blurred region.
    pub(super) candidates: [[f64; 3]; 3],
    /// Weights of the brightest candidate.
    shares: [f64; 3],
}

impl BackgroundLight {
    /// From the blurriness, which is small where the picture is blurred.
    pub(super) fn new(picture: &Rgb8, blurriness: &Plane<f64>, variant: Variant) -> Self {
        let candidates = [
            mean_of_blurred(picture, blurriness, variant),
            calmest(picture).mean_color(picture),
            lowest(blurriness).mean_color(picture),
        ];
        let shares = bright_parts(picture).map(|part| sigmoid(part, BRIGHT_PART));
        let ends = spread(&candidates);
        Self {
            color: std::array::from_fn(|c| shares[c] * ends[c].1 + (1.0 - shares[c]) * ends[c].0),
            candidates,
            shares,
        }
    }

    /// Whether a channel's candidates are far apart and its share is undecided; `others` are undecided shares of all
    /// channels.
    pub(super) fn is_unstable(&self, others: [f64; 2]) -> bool {
        let are_apart = spread(&self.candidates).map(|(low, high)| high - low > APART);
        let are_others_undecided = others.into_iter().any(is_undecided);
        (0..3).any(|c| are_apart[c] && (are_others_undecided || is_undecided(self.shares[c])))
    }
}

/// The minimum and maximum of each channel.
fn spread(candidates: &[[f64; 3]; 3]) -> [(f64, f64); 3] {
    std::array::from_fn(|c| {
        let values = candidates.map(|candidate| candidate[c]);
        (
            values.into_iter().fold(1.0, f64::min),
            values.into_iter().fold(0.0, f64::max),
        )
    })
}

/// The share of pixels above 0.5 in each channel.
fn bright_parts(picture: &Rgb8) -> [f64; 3] {
    histogram::histograms(picture).map(|counts| {
        let bright: u64 = counts[HALF + 1..].iter().sum();
        bright as f64 / histogram::total(&counts) as f64
    })
}

/// The mean color of the thousandth of the pixels with the smallest blurriness.
fn mean_of_blurred(picture: &Rgb8, blurriness: &Plane<f64>, variant: Variant) -> [f64; 3] {
    let count = (blurriness.data().len() / BLURRED).max(1);
    let positions = largest(&blurriness.map(|value| -value), count, variant);
    [0, 1, 2].map(|channel| {
        let codes = positions
            .iter()
            .map(|position| picture.data()[3 * position + channel]);
        let sum: u64 = codes.map(u64::from).sum();
        sum as f64 / (255 * positions.len()) as f64
    })
}

fn is_undecided(share: f64) -> bool {
    (0.05..=0.95).contains(&share)
}

/// `1 / (1 + exp(-32 (a - b)))`.
pub(super) fn sigmoid(a: f64, b: f64) -> f64 {
    1.0 / (1.0 + (-32.0 * (a - b)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bright_picture_takes_the_brightest_candidate_and_a_dark_one_the_darkest() {
        // Most blurred at the left, calm everywhere.
        let blurriness = Plane::from_fn(40, 40, |x, _| x as f64);
        let light_of = |left: u8, right: u8| {
            let picture = Rgb8::from_fn(40, 40, |x, _| if x < 21 { [left; 3] } else { [right; 3] });
            BackgroundLight::new(&picture, &blurriness, Variant::Fast)
        };
        let near = |got: [f64; 3], code: f64| got.iter().all(|value| (value - code / 255.0).abs() < 0.01);
        assert!(near(light_of(200, 100).color, 200.0));
        assert!(near(light_of(100, 60).color, 100.0));
        assert!(!light_of(200, 100).is_unstable([0.0, 1.0]));
        assert_eq!(
            bright_parts(&Rgb8::from_fn(4, 1, |x, _| [127 + x as u8, 128, 0])),
            [0.75, 1.0, 0.0]
        );
    }

    #[test]
    fn candidates_far_apart_are_unstable_where_a_share_is_undecided() {
        let light = |apart: f64, shares: [f64; 3]| BackgroundLight {
            color: [0.5; 3],
            candidates: [[0.5; 3], [0.5, 0.5 + apart, 0.5], [0.5; 3]],
            shares,
        };
        assert!(light(0.2, [0.0, 0.5, 1.0]).is_unstable([0.0, 1.0]));
        assert!(light(0.2, [0.0, 0.0, 1.0]).is_unstable([0.5, 1.0]));
        assert!(!light(0.2, [0.5, 0.0, 0.5]).is_unstable([0.0, 1.0]));
        assert!(!light(0.05, [0.5; 3]).is_unstable([0.5; 2]));
    }
}
