//! Median over a square window with the border replicated. Every variant gives the same codes.

mod five;
mod reference;

use imaging::Plane;

use crate::method::Variant;

/// The k × k median: code number `(k² + 1) / 2` of the sorted window. `window_px` is odd and within 1..=31; 1 copies.
/// Only a side of 5, the default, has a fast variant.
#[must_use]
pub fn median(picture: &Plane<u8>, window_px: usize, variant: Variant) -> Plane<u8> {
    if window_px == 1 || picture.data().is_empty() {
        return picture.clone();
    }
    match (variant, window_px) {
        (Variant::Fast, 5) => five::median(picture),
        _ => reference::median(picture, window_px),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_smaller_than_half_the_window_vanishes() {
        let picture = Plane::from_fn(9, 9, |x, y| {
            if x.abs_diff(4) + y.abs_diff(4) < 2 {
                200
            } else {
                10
            }
        });
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(median(&picture, 5, variant), Plane::filled(9, 9, 10));
        }
    }

    #[test]
    fn the_border_is_replicated() {
        // At the left end the window of 3 holds 1 1 5, three times over; at the right end 5 9 9.
        let picture = Plane::new(3, 1, vec![1u8, 5, 9]).unwrap();
        assert_eq!(median(&picture, 3, Variant::Fast).data(), &[1, 5, 9]);
        assert_eq!(median(&picture, 5, Variant::Fast).data(), &[1, 5, 9]);
    }

    #[test]
    fn a_window_of_one_changes_nothing() {
        let picture = Plane::new(2, 1, vec![3u8, 250]).unwrap();
        assert_eq!(median(&picture, 1, Variant::Fast), picture);
    }
}
