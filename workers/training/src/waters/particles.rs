//! Particles in front of the camera, many small and few large (Junge 1963): blurred dots of random brightness.

use imaging::random::Stream;

use crate::blur::gaussian;
use crate::tensor::Tensor;

/// Radius of the smallest, px; exponent of the law; radius of the largest, px.
const SMALLEST: f64 = 0.6;
const EXPONENT: f64 = 2.2;
const LARGEST: f64 = 7.0;
/// Sizes that are drawn, half an octave and a bit apart.
const SIZES: usize = 7;
/// Brightness of the smallest.
const PEAK: f64 = 0.05;

/// Brightness of `count` particles, row by row.
pub(super) fn draw(seed: u64, count: u64, (width, height): (usize, usize)) -> Vec<f32> {
    let stream = Stream::stage(seed, "particles");
    let mut layers: Vec<Tensor<f32>> = (0..SIZES).map(|_| Tensor::zeros(1, height, width)).collect();
    for particle in 0..count {
        let draw = |purpose: u64| stream.unit(particle, purpose);
        let radius = (SMALLEST * libm::pow(1.0 - draw(0), -1.0 / EXPONENT)).min(LARGEST);
        let size = (1.5 * libm::log2(radius / SMALLEST)).round() as usize;
        // Gamma of shape 2 and scale 0.5.
        let amplitude = -0.5 * (libm::log(1.0 - draw(1)) + libm::log(1.0 - draw(2)));
        let (x, y) = (draw(3) * width as f64, draw(4) * height as f64);
        layers[size.min(SIZES - 1)].row_mut(0, y as usize)[x as usize] += amplitude as f32;
    }
    let mut sum = vec![0.0f32; width * height];
    for (size, mut layer) in layers.into_iter().enumerate() {
        let sigma = 0.48 * libm::exp2(size as f64 / 1.5);
        gaussian(&mut layer, sigma);
        // What a dot of 1 has left in its centre.
        let mut dot = Tensor::zeros(1, 65, 65);
        dot.row_mut(0, 32)[32] = 1.0;
        gaussian(&mut dot, sigma);
        let gain = (PEAK / (1.0 + 0.3 * size as f64)) as f32 / dot.row(0, 32)[32];
        for (sum, value) in sum.iter_mut().zip(&layer.data) {
            *sum += gain * value;
        }
    }
    sum
}
