//! The noise of a frame, for networks with a noise input.

use imaging::Plane;
use imaging::random::Stream;

/// Stage name of the stream.
const STAGE: &str = "style noise";

/// Independent standard normal samples of a frame's size, unitless. They are a function of job seed, frame and position
/// only: `sqrt(-2 ln u) (cos 2πv, sin 2πv)` (Box and Muller 1958, "A note on the generation of random normal deviates")
/// for pairs of neighbors in a row, u in (0, 1) and v in [0, 1) from the halves of 64 bits of [`Stream`]. The largest
/// possible value is 6.8.
#[must_use]
pub fn noise(seed: u64, frame: u64, (width, height): (usize, usize)) -> Plane<f32> {
    let stream = Stream::stage(seed, STAGE);
    let count = width * height;
    let mut samples = Vec::with_capacity(count + 1);
    for pair in 0..count.div_ceil(2) as u64 {
        let bits = stream.bits(frame, pair);
        let half =
            |bits: u64, center: f64| ((bits & u64::from(u32::MAX)) as f64 + center) / (1u64 << 32) as f64;
        let radius = (-2.0 * libm::log(half(bits, 0.5))).sqrt();
        let (sine, cosine) = libm::sincos(2.0 * std::f64::consts::PI * half(bits >> 32, 0.0));
        samples.extend([radius * cosine, radius * sine].map(|sample| sample as f32));
    }
    samples.truncate(count);
    Plane::new(width, height, samples).expect("one sample for each pixel")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_depends_on_seed_and_frame_and_nothing_else() {
        let base = noise(1, 2, (31, 17));
        assert_eq!(noise(1, 2, (31, 17)), base);
        assert!(noise(2, 2, (31, 17)) != base && noise(1, 3, (31, 17)) != base);
        assert_eq!(noise(1, 2, (1, 1)).data(), &base.data()[..1]);
        assert_eq!(noise(1, 2, (0, 0)).data().len(), 0);
    }

    /// 262 144 samples: the standard error of each statistic is below a fifth of its tolerance.
    #[test]
    fn it_is_standard_normal_and_neighbors_are_independent() {
        let plane = noise(7, 3, (512, 512));
        let samples: Vec<f64> = plane.data().iter().map(|&sample| f64::from(sample)).collect();
        let mean = |of: &dyn Fn(usize) -> f64| (0..samples.len()).map(of).sum::<f64>() / samples.len() as f64;
        let moments = [1, 2, 3, 4].map(|power| mean(&|at| samples[at].powi(power)));
        for (found, (expected, allowed)) in
            moments
                .into_iter()
                .zip([(0.0, 0.01), (1.0, 0.015), (0.0, 0.025), (3.0, 0.1)])
        {
            assert!((found - expected).abs() < allowed, "{moments:?}");
        }
        for (limit, share) in [(1.0, 0.6827), (2.0, 0.9545), (3.0, 0.9973)] {
            let found = mean(&|at| f64::from(u8::from(samples[at].abs() < limit)));
            assert!((found - share).abs() < 0.005, "{limit}: {found}");
        }
        for step in [1, 2, 512] {
            let product = mean(&|at| samples[at] * samples[(at + step) % samples.len()]);
            assert!(product.abs() < 0.01, "{step}: {product}");
        }
    }
}
