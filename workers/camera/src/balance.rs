//! White balance: channel gains.

use imaging::{Rgb, vectorized};
use spec::WhiteBalance;

/// Pixels whose largest channel reaches this value are too bright for the gray world.
const BRIGHT: f64 = 0.98;
/// Largest gain, and reciprocal of the smallest.
const MOST: f64 = 8.0;
/// Lower limit of the divisor.
const LEAST_MEAN: f64 = 1e-6;

/// The gains of R, G, B for a picture.
///
/// Gray world: `clamp(m_G / max(m, 1e-6), 1/8, 8)` with the means m over pixels whose largest channel is below 0.98, or
/// over all pixels if there are none.
#[must_use]
pub fn gains<T: Copy + Into<f64>>(picture: &Rgb<T>, balance: WhiteBalance) -> [f64; 3] {
    match balance {
        WhiteBalance::Off => [1.0; 3],
        WhiteBalance::Fixed(gains) => gains,
        WhiteBalance::GrayWorld => {
            let means = means(picture, BRIGHT).or_else(|| means(picture, f64::INFINITY));
            means.map_or([1.0; 3], |means| {
                means.map(|mean| (means[1] / mean.max(LEAST_MEAN)).clamp(1.0 / MOST, MOST))
            })
        }
    }
}

/// The channel means of darker pixels; `None` if there are none.
fn means<T: Copy + Into<f64>>(picture: &Rgb<T>, below: f64) -> Option<[f64; 3]> {
    let [r, g, b] = picture.planes().each_ref().map(|plane| plane.data());
    let (mut sums, mut count) = ([0.0f64; 3], 0.0f64);
    for ((&r, &g), &b) in r.iter().zip(g).zip(b) {
        let pixel: [f64; 3] = [r.into(), g.into(), b.into()];
        let counts = f64::from(u8::from(pixel.iter().all(|&v| v < below)));
        count += counts;
        for (sum, v) in sums.iter_mut().zip(pixel) {
            *sum += counts * v;
        }
    }
    (count > 0.0).then(|| sums.map(|sum| sum / count))
}

/// Multiplies the channels.
pub fn apply(picture: &mut Rgb<f32>, gains: [f64; 3]) {
    for (samples, gain) in picture.planes_mut().into_iter().zip(gains) {
        if gain != 1.0 {
            vectorized!(samples.iter_mut().for_each(|v| *v *= gain as f32));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gray_world_makes_the_means_equal_and_leaves_out_what_is_bright() {
        let picture = Rgb::from_fn(2, 1, |x, _| {
            if x == 0 {
                [0.1f32, 0.2, 0.4]
            } else {
                [1.0, 0.3, 0.3]
            }
        });
        let gains = gains(&picture, WhiteBalance::GrayWorld);
        let expected = [2.0, 1.0, 0.5];
        assert!(
            gains.iter().zip(expected).all(|(g, e)| (g - e).abs() < 1e-6),
            "{gains:?}"
        );
    }

    #[test]
    fn gains_end_at_eight_and_bright_pictures_have_them_as_well() {
        let dark = Rgb::from_fn(1, 1, |_, _| [0.001f32, 0.5, 0.5]);
        assert_eq!(gains(&dark, WhiteBalance::GrayWorld)[0], 8.0);
        let bright = Rgb::from_fn(1, 1, |_, _| [0.5f32, 1.0, 2.0]);
        assert_eq!(gains(&bright, WhiteBalance::GrayWorld), [2.0, 1.0, 0.5]);
        assert_eq!(gains(&bright, WhiteBalance::Off), [1.0; 3]);
    }
}
