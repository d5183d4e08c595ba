//! Contrast of an object against its surround, after the water and before.
//!
//! Contrast is `C = Σ |o − s| / Σ (o + s)` over the three channels, o the mean radiance of the object and s that of its surround:
//! the pixels near its box outside the object. The visibility is the contrast after the water over the contrast before it. For one
//! channel, one range Z and a small difference it is Duntley's contrast transmittance, `s T / (s T + B∞ (1 − T))` with T = e^{−c Z}
//! (Duntley 1963, "Light in the sea", J. Opt. Soc. Am. 53, 214, Eq. 2-6; in air Koschmieder 1924).

use imaging::{Plane, Rgb};

/// Koschmieder's threshold: less contrast than this is not seen.
pub const LEAST_CONTRAST: f64 = 0.02;
/// The surround reaches this share of the box's longer side beyond it, and at least this many pixels.
const MARGIN: (f64, usize) = (0.25, 4);

/// Contrast of one object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visibility {
    /// Contrast before the water.
    pub before: f64,
    /// Contrast after the water.
    pub after: f64,
}

impl Visibility {
    /// Contrast after over before, at most 1; `None` for an object that already equals its surround before the water.
    #[must_use]
    pub fn score(&self) -> Option<f64> {
        (self.before >= LEAST_CONTRAST).then(|| (self.after / self.before).min(1.0))
    }

    /// Whether the contrast after the water can be seen.
    #[must_use]
    pub fn is_visible(&self) -> bool {
        self.after >= LEAST_CONTRAST
    }
}

/// The contrast of the object with this number in the mask of instances before and after the water, all of one size. `bounds` is
/// the box around it: left, top, and the first column and row beyond. `None` if the object or its surround is empty.
#[must_use]
pub fn visibility(
    before: &Rgb<f32>,
    after: &Rgb<f32>,
    instances: &Plane<u16>,
    number: u16,
    [left, top, right, bottom]: [usize; 4],
) -> Option<Visibility> {
    let (width, height) = instances.size();
    let longer = right.saturating_sub(left).max(bottom.saturating_sub(top));
    let margin = ((MARGIN.0 * longer as f64) as usize).max(MARGIN.1);
    let columns = left.saturating_sub(margin)..(right + margin).min(width);
    let rows = top.saturating_sub(margin)..(bottom + margin).min(height);
    let (mut own, mut around) = (Sums::default(), Sums::default());
    for y in rows {
        for x in columns.clone() {
            let sums = if instances.pixel(x, y) == number {
                &mut own
            } else {
                &mut around
            };
            sums.add(before.pixel(x, y), after.pixel(x, y));
        }
    }
    (own.pixels > 0 && around.pixels > 0).then(|| Visibility {
        before: contrast(own.mean(0), around.mean(0)),
        after: contrast(own.mean(3), around.mean(3)),
    })
}

/// Sums of the six channels before and after.
#[derive(Default)]
struct Sums {
    pixels: u64,
    light: [f64; 6],
}

impl Sums {
    fn add(&mut self, before: [f32; 3], after: [f32; 3]) {
        self.pixels += 1;
        for (sum, v) in self.light.iter_mut().zip(before.into_iter().chain(after)) {
            *sum += f64::from(v);
        }
    }

    fn mean(&self, from: usize) -> [f64; 3] {
        [0, 1, 2].map(|i| self.light[from + i] / self.pixels as f64)
    }
}

fn contrast(object: [f64; 3], surround: [f64; 3]) -> f64 {
    let pairs = || object.into_iter().zip(surround);
    let sum: f64 = pairs().map(|(o, s)| o + s).sum();
    let difference: f64 = pairs().map(|(o, s)| (o - s).abs()).sum();
    if sum > 0.0 { difference / sum } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bright card on a wall, both at one range in a gray water.
    fn card(range: f64, turbidity: f64) -> Visibility {
        let numbers = Plane::from_fn(40, 30, |x, y| {
            u16::from((15..25).contains(&x) && (10..20).contains(&y))
        });
        let before = Rgb::from_fn(40, 30, |x, y| {
            [if numbers.pixel(x, y) == 1 { 0.6f32 } else { 0.2 }; 3]
        });
        let t = (-0.4 * turbidity * range).exp() as f32;
        let after = before.map(|&j| j * t + 0.3 * (1.0 - t));
        visibility(&before, &after, &numbers, 1, [15, 10, 25, 20]).unwrap()
    }

    #[test]
    fn a_card_fades_with_range_and_turbidity() {
        let scores: Vec<f64> = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0]
            .map(|range| card(range, 1.0).score().unwrap())
            .to_vec();
        assert!((scores[0] - 1.0).abs() < 1e-6);
        assert!(scores.windows(2).all(|pair| pair[1] < pair[0]), "{scores:?}");
        assert!(card(2.0, 2.0).after < card(2.0, 1.0).after);
        assert!(card(1.0, 1.0).is_visible() && !card(30.0, 1.0).is_visible());
        // Expected: contrast 0.4 T / (0.8 T + 0.6 (1 − T)) over 0.4/0.8.
        let t = (-0.8f64).exp();
        let expected = 0.8 * t / (0.8 * t + 0.6 * (1.0 - t));
        assert!((scores[3] - expected).abs() < 1e-5, "{} {expected}", scores[3]);
    }

    #[test]
    fn an_object_like_its_surround_has_no_score_and_a_frame_of_one_object_none_at_all() {
        let same = Rgb::from_fn(9, 9, |_, _| [0.5f32; 3]);
        let numbers = Plane::from_fn(9, 9, |x, _| u16::from(x < 3));
        let alike = visibility(&same, &same, &numbers, 1, [0, 0, 3, 9]).unwrap();
        assert_eq!((alike.score(), alike.is_visible()), (None, false));
        let all = Plane::filled(9, 9, 1u16);
        assert_eq!(visibility(&same, &same, &all, 1, [0, 0, 9, 9]), None);
    }
}
