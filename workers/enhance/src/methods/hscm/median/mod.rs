//! Median of a square window with replicated borders, such as code 13 of the 25 sorted ones of 5 × 5. All variants yield the
//! same codes.

mod five;
mod reference;
mod sliding;

use imaging::Plane;

use crate::variant::Variant;

/// The median of each window of `side` × `side` pixels, `side` odd.
#[must_use]
pub fn median(picture: &Plane<u8>, side: usize, variant: Variant) -> Plane<u8> {
    match (variant, side) {
        (_, 1) => picture.clone(),
        (Variant::Fast, 5) => five::median(picture),
        (Variant::Fast, _) => sliding::median(picture, side),
        (Variant::Reference, _) => reference::median(picture, side),
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
        // At the left end the window holds 1 1 1 5 9, five times over; at the right end 1 5 9 9 9.
        let picture = Plane::new(3, 1, vec![1u8, 5, 9]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(median(&picture, 5, variant).data(), &[1, 5, 9]);
        }
    }

    #[test]
    fn every_side_has_the_codes_of_the_sorted_window() {
        for (width, height) in [(1, 1), (2, 7), (40, 23)] {
            let picture = Plane::from_fn(width, height, |x, y| ((x * x * 31 + y * 57 + x * y) % 251) as u8);
            for side in [1, 3, 7, 31] {
                let [fast, exact] =
                    [Variant::Fast, Variant::Reference].map(|variant| median(&picture, side, variant));
                assert_eq!(fast, exact, "{side} at {width}×{height}");
            }
        }
    }
}
