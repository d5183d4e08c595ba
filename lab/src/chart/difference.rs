//! Difference of a picture from its reference.

use imaging::{Rgb, transfer};
use quality::MetricId;

/// Differences to a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Largest, in linear light.
    pub max: f64,
    /// Root of the mean square, in linear light.
    pub rmse: f64,
    /// Largest, in 8-bit codes of the encoded picture.
    pub codes: u8,
    /// Mean color difference of the encoded pictures, CIEDE2000.
    pub delta_e: f64,
}

/// Compares two linear pictures of one size.
#[must_use]
pub fn difference(picture: &Rgb<f32>, reference: &Rgb<f32>) -> Difference {
    let pairs = || {
        let planes = picture.planes().iter().zip(reference.planes());
        planes.flat_map(|(a, b)| a.data().iter().zip(b.data()))
    };
    let errors = || pairs().map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
    let count = pairs().count().max(1) as f64;
    let (ours, exact) = (
        transfer::encode_rgb8(picture).0,
        transfer::encode_rgb8(reference).0,
    );
    let codes = ours
        .data()
        .iter()
        .zip(exact.data())
        .map(|(a, b)| a.abs_diff(*b))
        .max();
    let metric: Vec<MetricId> = MetricId::parse("ciede2000").into_iter().collect();
    let measured = quality::measure(&ours, Some(&exact), &metric).unwrap_or_default();
    Difference {
        max: errors().fold(0.0, f64::max),
        rmse: (errors().map(|e| e * e).sum::<f64>() / count).sqrt(),
        codes: codes.unwrap_or(0),
        delta_e: measured.first().map_or(f64::NAN, |(_, value)| *value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_do_not_differ_and_others_by_as_much_as_they_do() {
        let grey = |v: f32| Rgb::from_fn(4, 3, |_, _| [v; 3]);
        assert_eq!(
            difference(&grey(0.3), &grey(0.3)),
            Difference {
                max: 0.0,
                rmse: 0.0,
                codes: 0,
                delta_e: 0.0
            }
        );
        let d = difference(&grey(0.5), &grey(0.25));
        assert!((d.max - 0.25).abs() < 1e-7 && (d.rmse - 0.25).abs() < 1e-7);
        assert!(d.codes == 51 && d.delta_e > 10.0, "{d:?}");
    }
}
