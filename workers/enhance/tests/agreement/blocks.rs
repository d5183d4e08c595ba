//! Building blocks.

use enhance::Variant::{Fast, Reference};
use enhance::blocks::{
    Guide, Matting, Veil, binomial, binomial_exact, dehaze, filled, gaussian, guided, largest, restore,
    tails, window_max, window_mean, window_min,
};
use imaging::{Plane, Rgb8};

use crate::{SIZES, noise, pictures};

/// Largest difference of the filtered plane in 0..=1. The inverse amplifies the rounding of the covariances by at most
/// the largest variance over the regularization, 0.25 / 1e-3.
const GUIDED_AGREEMENT: f64 = 1e-10;

/// A plane in 0..=1 nearly independent of the picture, and one that is a function of it.
fn planes(picture: &Rgb8) -> [Plane<f64>; 2] {
    let (width, height) = (picture.width(), picture.height());
    [
        Plane::from_fn(width, height, |x, y| f64::from(noise(x + 31, y)) / 255.0),
        Plane::from_fn(width, height, |x, y| f64::from(picture.pixel(x, y)[0]) / 255.0),
    ]
}

fn assert_close(fast: &Plane<f64>, exact: &Plane<f64>, tolerance: f64, what: &str) {
    for (a, b) in fast.data().iter().zip(exact.data()) {
        assert!((a - b).abs() <= tolerance, "{what}: {a} for {b}");
    }
}

#[test]
fn guided_filters() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                // The time of the reference grows with the radius: the largest size uses only the small one.
                let radii = [(3, 1e-3), (50, 1e-3)].into_iter();
                for (radius, regularization) in
                    radii.filter(|(radius, _)| width * height * radius < 2_000_000)
                {
                    let guide = Guide::new(&picture).window(radius, regularization);
                    let what = format!("{width}×{height} {content}, radius {radius}");
                    let [fast, exact] = [Fast, Reference].map(|variant| guided(&guide, &plane, variant));
                    assert_close(&fast, &exact, GUIDED_AGREEMENT, &what);
                }
            }
        }
    }
}

#[test]
fn largest_values() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                for count in [1, 2, plane.data().len() / 3, plane.data().len()] {
                    let [fast, exact] = [Fast, Reference].map(|variant| largest(&plane, count, variant));
                    assert_eq!(fast, exact, "{width}×{height} {content}, {count}");
                }
            }
        }
    }
}

/// The smallest transmittance amplifies f32 rounding by ten: still far below one code, but a value may be that close to
/// a tie.
#[test]
fn restored_codes() {
    let veil = Veil {
        light: [0.1, 0.5, 0.55],
        attenuation: [0.186, 0.05, 0.03],
        transmittance: (0.1, 0.9),
    };
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            let distance = planes(&picture)[0].map(|value| 25.0 * value);
            let [fast, exact] = [Fast, Reference].map(|variant| restore(&picture, &distance, &veil, variant));
            for (a, b) in fast.data().iter().zip(exact.data()) {
                assert!(a.abs_diff(*b) <= 1, "{width}×{height} {content}: {a} for {b}");
            }
        }
    }
}

/// As for [`restored_codes`].
#[test]
fn dehazed_codes() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            let transmittance = planes(&picture)[0].map(|value| 1.2 * value);
            let [fast, exact] = [Fast, Reference].map(|variant| {
                dehaze(
                    &picture.to_planes(),
                    &transmittance,
                    [0.1, 0.5, 0.55],
                    0.1,
                    variant,
                )
            });
            for (a, b) in fast.data().iter().zip(exact.data()) {
                assert!(a.abs_diff(*b) <= 1, "{width}×{height} {content}: {a} for {b}");
            }
        }
    }
}

/// Two sums of five products of at most 1, each rounded in single precision.
const BINOMIAL_AGREEMENT: f64 = 5e-7;

#[test]
fn binomial_windows() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                let fast = binomial(&plane.map(|&value| value as f32)).map(|&value| f64::from(value));
                let what = format!("{width}×{height} {content}");
                assert_close(&fast, &binomial_exact(&plane), BINOMIAL_AGREEMENT, &what);
            }
        }
    }
}

/// Running sums of up to 77 000 values of at most 1.
const MEAN_AGREEMENT: f64 = 1e-11;

#[test]
fn window_means() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            let [a, b] = planes(&picture);
            for radius in [0, 1, 12, 400] {
                let [fast, exact] = [Fast, Reference].map(|variant| window_mean([&a, &b], radius, variant));
                for (fast, exact) in fast.iter().zip(&exact) {
                    let what = format!("{width}×{height} {content}, radius {radius}");
                    assert_close(fast, exact, MEAN_AGREEMENT, &what);
                }
            }
        }
    }
}

#[test]
fn tail_values() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                for share in [0.0, 0.01, 0.3] {
                    let [fast, exact] = [Fast, Reference].map(|variant| tails(plane.data(), share, variant));
                    assert_eq!(fast, exact, "{width}×{height} {content}, {share}");
                }
            }
        }
    }
}

#[test]
fn window_extremes() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            let codes = Plane::from_fn(width, height, |x, y| picture.pixel(x, y)[1]);
            for radius in [0, 1, 3, 4, 9, 20] {
                let what = format!("{width}×{height} {content}, radius {radius}");
                assert_eq!(
                    window_max(&codes, radius, Fast),
                    window_max(&codes, radius, Reference),
                    "{what}"
                );
                assert_eq!(
                    window_min(&codes, radius, Fast),
                    window_min(&codes, radius, Reference),
                    "{what}"
                );
            }
        }
    }
}

/// The same products added in another order.
const GAUSSIAN_AGREEMENT: f64 = 1e-14;

#[test]
fn gaussian_windows() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                for radius in [0, 4, 32] {
                    let what = format!("{width}×{height} {content}, radius {radius}");
                    let blur = |variant| gaussian(&plane, radius, (2 * radius + 1) as f64, variant);
                    assert_close(&blur(Fast), &blur(Reference), GAUSSIAN_AGREEMENT, &what);
                }
            }
        }
    }
}

#[test]
fn filled_planes() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            for plane in planes(&picture) {
                let what = format!("{width}×{height} {content}");
                assert_eq!(filled(&plane, Fast), filled(&plane, Reference), "{what}");
            }
        }
    }
}

/// The iteration ends at a residual of 1e-9, which bounds the mean square; a single pixel may hold all of it.
const MATTING_AGREEMENT: f64 = 1e-6;

#[test]
fn refined_planes() {
    // The reference takes minutes for the larger ones; the unit tests of matting compare one of them.
    for (width, height) in SIZES
        .into_iter()
        .filter(|(width, height)| width * height < 15_000)
    {
        for (content, picture) in pictures(width, height) {
            let guide = Guide::new(&picture);
            let [fast, reference] = [Fast, Reference].map(|variant| Matting::new(&guide, variant));
            let what = format!("{width}×{height} {content}");
            let [plane, _] = planes(&picture);
            assert_close(
                &fast.refined(&plane),
                &reference.refined(&plane),
                MATTING_AGREEMENT,
                &what,
            );
        }
    }
}
