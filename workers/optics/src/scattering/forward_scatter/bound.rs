//! How wrong interpolation between kernels can be, before anything is transformed.
//!
//! With `E(d; γ) = k(d; γ) − Σ_k l_k(γ) k(d; γ_k)` the error at a pixel is `Σ_y U(y) E(x − y; γ(y))`. A scene with the worst scale
//! at every offset would reach `Σ_d max_γ u(γ) |E(d; γ)|`, u(γ) the largest light of that scale; real scenes, and noise, stay far
//! below, since neighbors have similar scales and E of one scale sums to 0. Offsets are single pixels up to eight and rings beyond,
//! for the kernel is round there.

use super::nodes::place;
use crate::kernel::pixel;

/// Offsets up to here are pixels, beyond rings.
const NEAR_PX: i64 = 8;
/// Rings from there outwards, of equal ratio.
const RINGS: usize = 40;
/// The outermost ring in units of the widest kernel: 1/400 of the light is beyond, and hardly any of the difference.
const REACH: f64 = 400.0;

/// Light that is spread with a kernel of this scale: at most `light`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleLight {
    /// γ in pixels.
    pub gamma: f64,
    /// Largest light among the pixels of this scale, linear.
    pub light: f64,
}

/// The kernels of the scales of a frame at all significant offsets.
pub struct Bound {
    scales: Vec<ScaleLight>,
    offsets: Vec<Offset>,
    /// For each offset the kernels of all scales.
    kernels: Vec<f64>,
}

/// Pixels at one offset.
struct Offset {
    x: f64,
    y: f64,
    count: f64,
    near: bool,
}

impl Offset {
    /// Light on one of the pixels.
    fn kernel(&self, gamma: f64) -> f64 {
        if self.near {
            return pixel(self.x as i64, self.y as i64, gamma);
        }
        let q = gamma * gamma + self.x * self.x;
        gamma / (std::f64::consts::TAU * q * q.sqrt())
    }
}

/// Errors that interpolation can make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Upper bound for any scene of this light: every offset has its worst scale.
    pub worst: f64,
    /// Every light at will, but of one scale: `max_γ u(γ) ½ Σ_d |E(d; γ)|`.
    pub even: f64,
}

impl Bound {
    /// Prepares the bound for the scales of a frame.
    #[must_use]
    pub fn new(scales: Vec<ScaleLight>) -> Self {
        let widest = scales.iter().map(|scale| scale.gamma).fold(1.0, f64::max);
        let offsets = offsets(REACH * widest);
        let kernels = offsets
            .iter()
            .flat_map(|offset| scales.iter().map(|scale| offset.kernel(scale.gamma)))
            .collect();
        Self {
            scales,
            offsets,
            kernels,
        }
    }

    /// The most light that can arrive at a pixel, `Σ_d max_γ u(γ) k(d; γ)`: a cone-shaped range focuses it.
    #[must_use]
    pub fn arriving(&self) -> f64 {
        let kernels = self.kernels.chunks_exact(self.scales.len().max(1));
        let most = |kernels: &[f64]| {
            let lights = self.scales.iter().zip(kernels);
            lights
                .map(|(scale, kernel)| scale.light * kernel)
                .fold(0.0, f64::max)
        };
        self.offsets
            .iter()
            .zip(kernels)
            .map(|(offset, kernels)| offset.count * most(kernels))
            .sum()
    }

    /// Errors with kernels at these scales, interpolated as the fast method does.
    #[must_use]
    pub fn errors(&self, gammas: &[f64]) -> Errors {
        let places: Vec<f64> = gammas.iter().map(|&gamma| place(gamma)).collect();
        let shares: Vec<Vec<f64>> = self
            .scales
            .iter()
            .map(|scale| shares(&places, place(scale.gamma)))
            .collect();
        let mut worst = 0.0;
        let mut alone = vec![0.0; self.scales.len()];
        for (offset, kernels) in self
            .offsets
            .iter()
            .zip(self.kernels.chunks_exact(self.scales.len().max(1)))
        {
            let nodes: Vec<f64> = gammas.iter().map(|&gamma| offset.kernel(gamma)).collect();
            let mut largest = 0.0f64;
            for (j, (scale, &kernel)) in self.scales.iter().zip(kernels).enumerate() {
                let mixed: f64 = shares[j].iter().zip(&nodes).map(|(l, k)| l * k).sum();
                let error = scale.light * (kernel - mixed).abs();
                alone[j] += offset.count * error;
                largest = largest.max(error);
            }
            worst += offset.count * largest;
        }
        Errors {
            worst,
            even: alone.into_iter().fold(0.0, f64::max) / 2.0,
        }
    }
}

/// Lagrange's weights at one point.
fn shares(places: &[f64], at: f64) -> Vec<f64> {
    let share = |k: usize| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != k);
        others
            .map(|(_, &other)| (at - other) / (places[k] - other))
            .product()
    };
    (0..places.len()).map(share).collect()
}

fn offsets(reach: f64) -> Vec<Offset> {
    let mut offsets = Vec::new();
    for x in 0..=NEAR_PX {
        for y in 0..=x {
            if x * x + y * y > NEAR_PX * NEAR_PX {
                continue;
            }
            let count = match (x, y) {
                (0, 0) => 1.0,
                (_, 0) => 4.0,
                _ if x == y => 4.0,
                _ => 8.0,
            };
            offsets.push(Offset {
                x: x as f64,
                y: y as f64,
                count,
                near: true,
            });
        }
    }
    let pixels: f64 = offsets.iter().map(|offset| offset.count).sum();
    // Rings begin where the area of the single pixels ends.
    let first = (pixels / std::f64::consts::PI).sqrt();
    let ratio = (reach / first).powf(1.0 / RINGS as f64);
    for ring in 0..RINGS {
        let (inner, outer) = (
            first * ratio.powi(ring as i32),
            first * ratio.powi(ring as i32 + 1),
        );
        offsets.push(Offset {
            x: (inner * outer).sqrt(),
            y: 0.0,
            count: std::f64::consts::PI * (outer * outer - inner * inner),
            near: false,
        });
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward_scatter::Nodes;

    fn scales(least: f64, most: f64) -> Vec<ScaleLight> {
        let at = |j: usize| (place(least) + (place(most) - place(least)) * j as f64 / 40.0).exp() - 0.3;
        (0..=40)
            .map(|j| ScaleLight {
                gamma: at(j).max(0.0),
                light: 1.0,
            })
            .collect()
    }

    fn nodes(least: f64, most: f64, terms: usize) -> Vec<f64> {
        let nodes = Nodes::chebyshev(least, most, terms);
        (0..nodes.terms()).map(|k| nodes.gamma(k)).collect()
    }

    /// Compared with the sum over single pixels, out to 192.
    #[test]
    fn rings_agree_with_the_sum_over_pixels() {
        let (least, most) = (1.0, 10.0);
        let (gammas, scales) = (nodes(least, most, 5), scales(least, most));
        let places: Vec<f64> = gammas.iter().map(|&g| place(g)).collect();
        let mut worst = 0.0;
        for x in 0i64..192 {
            for y in 0..=x {
                let count = if x == 0 {
                    1.0
                } else if y == 0 || x == y {
                    4.0
                } else {
                    8.0
                };
                let largest = scales.iter().map(|scale| {
                    let shares = shares(&places, place(scale.gamma));
                    let mixed: f64 = shares.iter().zip(&gammas).map(|(l, &g)| l * pixel(x, y, g)).sum();
                    (pixel(x, y, scale.gamma) - mixed).abs()
                });
                worst += count * largest.fold(0.0, f64::max);
            }
        }
        let rings = Bound::new(scales).errors(&gammas).worst;
        assert!(
            (rings / worst - 1.0).abs() < 0.1,
            "{rings:e} by rings, {worst:e} by pixels"
        );
    }

    #[test]
    fn more_kernels_are_more_exact_and_one_scale_is_exact() {
        let bound = Bound::new(scales(0.0, 30.0));
        let errors: Vec<f64> = (2..=12)
            .map(|k| bound.errors(&nodes(0.0, 30.0, k)).worst)
            .collect();
        assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
        let one = Bound::new(vec![ScaleLight {
            gamma: 3.0,
            light: 1.0,
        }]);
        assert!(one.errors(&[3.0]).worst < 1e-15);
    }

    #[test]
    fn light_of_one_scale_errs_less_than_light_of_all() {
        let errors = Bound::new(scales(0.5, 20.0)).errors(&nodes(0.5, 20.0, 6));
        assert!(
            errors.even < errors.worst && errors.even > 0.05 * errors.worst,
            "{errors:?}"
        );
    }
}
