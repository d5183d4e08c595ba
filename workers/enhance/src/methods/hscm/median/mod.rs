//! 5 × 5 median with replicated borders: code 13 of the 25 sorted ones. Both variants yield the same codes.

mod five;
mod reference;

use imaging::Plane;

use crate::variant::Variant;

/// The median of each window.
#[must_use]
pub fn median(picture: &Plane<u8>, variant: Variant) -> Plane<u8> {
    match variant {
        Variant::Fast => five::median(picture),
        Variant::Reference => reference::median(picture),
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
            assert_eq!(median(&picture, variant), Plane::filled(9, 9, 10));
        }
    }

    #[test]
    fn the_border_is_replicated() {
        // At the left end the window holds 1 1 1 5 9, five times over; at the right end 1 5 9 9 9.
        let picture = Plane::new(3, 1, vec![1u8, 5, 9]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(median(&picture, variant).data(), &[1, 5, 9]);
        }
    }
}
