//! How far one light is from another.

use imaging::Rgb;

/// The greatest sample.
pub(crate) fn peak(light: &Rgb<f64>) -> f64 {
    let samples = light.planes().iter().flat_map(|plane| plane.data());
    samples.copied().fold(0.0, f64::max)
}

/// The greatest difference of a sample, including NaN.
pub(crate) fn worst(fast: &Rgb<f32>, exact: &Rgb<f64>) -> f64 {
    let pairs = fast.planes().iter().zip(exact.planes());
    let errors = pairs.flat_map(|(fast, exact)| {
        let samples = fast.data().iter().zip(exact.data());
        samples.map(|(&fast, exact)| (f64::from(fast) - exact).abs())
    });
    errors.fold(0.0, |worst, error| if error <= worst { worst } else { error })
}
