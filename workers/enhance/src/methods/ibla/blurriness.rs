//! Blurriness of a picture.

use imaging::{Plane, Rgb8, luma1000};

use crate::blocks::{filled, gaussian, window_max};
use crate::variant::Variant;

/// Radius of the windows of local maxima, pixels.
pub(super) const MAXIMUM_PX: usize = 3;

/// `P_r` of step 1.
pub(super) fn blurriness(picture: &Rgb8, variant: Variant) -> Plane<f64> {
    let luma = picture
        .pixels()
        .map(|pixel| f64::from(luma1000(pixel)) / 255_000.0);
    let luma = Plane::new(picture.width(), picture.height(), luma.collect()).expect("a luma for each pixel");
    let mut sharpness = luma.map(|_| 0.0);
    for i in 1..=4u32 {
        let radius = 2usize.pow(i) * 2;
        let blurred = gaussian(&luma, radius, (2 * radius + 1) as f64, variant);
        let differences = luma.data().iter().zip(blurred.data());
        for (sum, (value, blurred)) in sharpness.data_mut().iter_mut().zip(differences) {
            *sum += 0.25 * (value - blurred).abs();
        }
    }
    filled(&window_max(&sharpness, MAXIMUM_PX, variant), variant)
}
