//! Range as a 16-bit file: millimeters, 0 = hole.

use imaging::Plane;
use optics::range::is_hole;

/// Rounds a range map to millimeters; also returns the number of pixels clamped to 65.535 m.
pub(crate) fn millimeters(range: &Plane<f32>) -> (Plane<u16>, u64) {
    let mut saturated = 0;
    let codes = range.map(|&meters| {
        if is_hole(meters) {
            return 0;
        }
        let code = (f64::from(meters) * 1000.0).round();
        if code > f64::from(u16::MAX) {
            saturated += 1;
        }
        code as u16
    });
    (codes, saturated)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_zero_and_what_is_too_far_is_counted() {
        let range = Plane::new(5, 1, vec![f32::NAN, 0.001, 1.2345, 65.535, 70.0]).unwrap();
        let (codes, saturated) = millimeters(&range);
        assert_eq!(codes.data(), &[0, 1, 1235, 65535, 65535]);
        assert_eq!(saturated, 1);
    }
}
