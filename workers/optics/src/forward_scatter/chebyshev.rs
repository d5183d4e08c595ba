//! The fast method: a few kernels and Lagrange weights between them, in f32.
//!
//! ```text
//! scatter: F = DCT⁻¹ [ Σ_k H_k · DCT( l_k(γ) U ) ]       K transforms forward, one back
//! gather:  F = Σ_k l_k(γ) · DCT⁻¹ [ H_k · DCT(I) ]       one forward, K back
//! ```
//!
//! The largest error for light up to 1 falls from 2e-3 with four terms to 1e-5 with eight.

use imaging::Plane;

use super::{KernelCache, Nodes};

/// Spreads the light `source` of each pixel with the pixel's own kernel scale. Never negative.
///
/// # Panics
/// When the planes differ in size.
#[must_use]
pub fn scatter(
    source: &Plane<f32>,
    gamma: &Plane<f64>,
    nodes: &Nodes,
    cache: &mut KernelCache,
) -> Plane<f32> {
    assert_eq!(
        source.size(),
        gamma.size(),
        "light and kernel scale belong to one frame"
    );
    let (width, height) = source.size();
    let weights = weights(gamma, nodes);
    let mut sum = vec![0.0f32; source.data().len()];
    let mut work = vec![0.0f32; source.data().len()];
    for (weight, &node) in weights.iter().zip(nodes.gammas()) {
        for ((sample, &light), &share) in work.iter_mut().zip(source.data()).zip(weight) {
            *sample = light * share;
        }
        cache.transform(width, height).forward(&mut work);
        let transfer = cache.transfer(node, width, height);
        for ((sum, &sample), &h) in sum.iter_mut().zip(&work).zip(&*transfer) {
            *sum += sample * h;
        }
    }
    cache.transform(width, height).inverse(&mut sum);
    finished(width, height, sum)
}

/// Collects `image` at each pixel with the pixel's own kernel scale. Never negative.
///
/// # Panics
/// When the planes differ in size.
#[must_use]
pub fn gather(image: &Plane<f32>, gamma: &Plane<f64>, nodes: &Nodes, cache: &mut KernelCache) -> Plane<f32> {
    assert_eq!(
        image.size(),
        gamma.size(),
        "light and kernel scale belong to one frame"
    );
    let (width, height) = image.size();
    let weights = weights(gamma, nodes);
    let mut spectrum = image.data().to_vec();
    cache.transform(width, height).forward(&mut spectrum);
    let mut sum = vec![0.0f32; spectrum.len()];
    let mut work = vec![0.0f32; spectrum.len()];
    for (weight, &node) in weights.iter().zip(nodes.gammas()) {
        let transfer = cache.transfer(node, width, height);
        for ((sample, &value), &h) in work.iter_mut().zip(&spectrum).zip(&*transfer) {
            *sample = value * h;
        }
        cache.transform(width, height).inverse(&mut work);
        for ((sum, &sample), &share) in sum.iter_mut().zip(&work).zip(weight) {
            *sum += sample * share;
        }
    }
    finished(width, height, sum)
}

/// One plane of weights for each node. Neighbouring pixels often share a scale, so the last result is kept.
fn weights(gamma: &Plane<f64>, nodes: &Nodes) -> Vec<Vec<f32>> {
    let count = nodes.gammas().len();
    let lagrange = nodes.lagrange();
    let mut planes: Vec<Vec<f32>> = (0..count)
        .map(|_| Vec::with_capacity(gamma.data().len()))
        .collect();
    let mut shares = vec![0.0; count];
    let mut last = f64::NAN;
    for &gamma in gamma.data() {
        if gamma != last {
            lagrange.at(gamma, &mut shares);
            last = gamma;
        }
        for (plane, &share) in planes.iter_mut().zip(&shares) {
            plane.push(share as f32);
        }
    }
    planes
}

/// The truth is never negative, so the clamp can only bring the result nearer.
fn finished(width: usize, height: usize, mut data: Vec<f32>) -> Plane<f32> {
    data.iter_mut().for_each(|value| *value = value.max(0.0));
    Plane::new(width, height, data).expect("the size of the source")
}
