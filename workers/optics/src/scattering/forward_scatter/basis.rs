//! The share of each kernel in each pixel, l_k(γ), in f32.
//!
//! Lagrange's product form, `l_k(t) = w_k Π_{j≠k} (t − t_j)`: no division, no special case at a node, one rounding for each factor.
//! t is s scaled to ±2: on an interval of that length the products neither grow nor vanish for any number of nodes.

use super::nodes::{Nodes, SHIFT_PX, place};

/// Half the length of the interval that s is scaled to.
const HALF: f64 = 2.0;
/// Pixels whose shares are kept together: few enough for the first-level cache.
pub(super) const BLOCK: usize = 256;

/// How a pixel's kernel is made up of the nodes.
pub(super) enum Basis {
    /// The scale of each pixel is a kernel.
    Exact(Vec<f32>),
    /// Interpolation.
    Lagrange {
        nodes: Vec<f32>,
        weights: Vec<f32>,
        middle: f64,
        scale: f64,
        span: (f32, f32),
        origin: f32,
    },
}

impl Basis {
    pub(super) fn new(nodes: &Nodes) -> Self {
        let (gammas, (least, most), origin) = match nodes {
            Nodes::Exact(gammas) => return Self::Exact(gammas.clone()),
            Nodes::Chebyshev { gammas, span, origin } => (gammas, *span, *origin),
        };
        let (low, high) = (place(least - origin), place(most - origin));
        let middle = (low + high) / 2.0;
        let scale = if gammas.len() > 1 {
            2.0 * HALF / (high - low)
        } else {
            0.0
        };
        let nodes: Vec<f32> = gammas
            .iter()
            .map(|&gamma| ((place(gamma - origin) - middle) * scale) as f32)
            .collect();
        let weight = |k: usize| {
            let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
            (1.0 / others
                .map(|(_, &other)| f64::from(nodes[k]) - f64::from(other))
                .product::<f64>()) as f32
        };
        let weights = (0..nodes.len()).map(weight).collect();
        Self::Lagrange {
            nodes,
            weights,
            middle,
            scale,
            span: (least as f32, most as f32),
            origin: origin as f32,
        }
    }

    /// Replaces kernel scales by the argument of [`Basis::shares`]: for interpolation t, with scales clamped to the span.
    #[inline(always)]
    pub(super) fn locate(&self, gammas: &mut [f32]) {
        let Self::Lagrange {
            middle,
            scale,
            span: (least, most),
            origin,
            ..
        } = self
        else {
            return;
        };
        // Scales are clamped to the span, so that γ − origin is negative by rounding at most.
        let (origin, shift) = (*origin, SHIFT_PX as f32);
        let (middle, scale) = (*middle as f32, *scale as f32);
        for value in gammas {
            let gamma = if *value > *least { *value } else { *least };
            let gamma = if gamma < *most { gamma } else { *most };
            *value = (ln(gamma - origin + shift) - middle) * scale;
        }
    }

    /// l_k of pixels; 0 if kernel k does not exist.
    #[inline(always)]
    pub(super) fn shares(&self, k: usize, located: &[f32], shares: &mut [f32]) {
        match self {
            Self::Exact(gammas) => match gammas.get(k) {
                Some(&node) => by_pixel(located, shares, |gamma| if gamma == node { 1.0 } else { 0.0 }),
                None => shares.fill(0.0),
            },
            Self::Lagrange { nodes, weights, .. } => {
                let Some(&weight) = weights.get(k) else {
                    return shares.fill(0.0);
                };
                for (shares, located) in shares.chunks_mut(LANES).zip(located.chunks(LANES)) {
                    let products = Products::new(located, &nodes[..k], &nodes[k + 1..]);
                    products.times(|_, product| weight * product, shares);
                }
            }
        }
    }

    /// l_k and l_{k+1}, both of which must exist: they differ in one factor.
    #[inline(always)]
    pub(super) fn pair_of_shares(&self, k: usize, located: &[f32], first: &mut [f32], second: &mut [f32]) {
        let Self::Lagrange { nodes, weights, .. } = self else {
            self.shares(k, located, first);
            return self.shares(k + 1, located, second);
        };
        let (one, other) = ((nodes[k], weights[k]), (nodes[k + 1], weights[k + 1]));
        let pixels = first.chunks_mut(LANES).zip(second.chunks_mut(LANES));
        for ((first, second), located) in pixels.zip(located.chunks(LANES)) {
            let products = Products::new(located, &nodes[..k], &nodes[k + 2..]);
            products.times(|t, product| one.1 * (product * (t - other.0)), first);
            products.times(|t, product| other.1 * (product * (t - one.0)), second);
        }
    }
}

/// Pixels in one chunk, whose products stay in registers.
const LANES: usize = 32;

/// `Π (t − t_j)` over some nodes, of a few pixels.
struct Products {
    t: [f32; LANES],
    product: [f32; LANES],
}

impl Products {
    #[inline(always)]
    fn new(located: &[f32], below: &[f32], above: &[f32]) -> Self {
        let mut t = [0.0f32; LANES];
        t[..located.len()].copy_from_slice(located);
        let mut product = [1.0f32; LANES];
        for nodes in [below, above] {
            for &node in nodes {
                for (product, t) in product.iter_mut().zip(&t) {
                    *product *= t - node;
                }
            }
        }
        Self { t, product }
    }

    #[inline(always)]
    fn times(&self, share: impl Fn(f32, f32) -> f32, shares: &mut [f32]) {
        for (to, (&t, &product)) in shares.iter_mut().zip(self.t.iter().zip(&self.product)) {
            *to = share(t, product);
        }
    }
}

#[inline(always)]
fn by_pixel(from: &[f32], to: &mut [f32], value: impl Fn(f32) -> f32) {
    to.iter_mut().zip(from).for_each(|(to, &from)| *to = value(from));
}

/// ln x for normal positive x, absolute error below 1e-7 (|ln x| + 1). Polynomial of S. Moshier's Cephes library.
#[inline(always)]
fn ln(x: f32) -> f32 {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let exponent = (x.to_bits().wrapping_sub(SQRT_HALF) as i32) >> 23;
    let mantissa = f32::from_bits(x.to_bits().wrapping_sub((exponent << 23) as u32));
    let (n, r) = (exponent as f32, mantissa - 1.0);
    let square = r * r;
    let mut p = 7.037_683_6e-2;
    for coefficient in [
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_7e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333_1e-1,
    ] {
        p = p * r + coefficient;
    }
    let tail = p * r * square + n * -2.121_944_4e-4 - 0.5 * square;
    (r + tail) + n * 0.693_359_4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_is_exact_to_the_last_places() {
        for step in 1..100_000 {
            let x = 0.3 * 1.000_1f32.powi(step);
            let expected = f64::from(x).ln();
            let error = (f64::from(ln(x)) - expected).abs();
            assert!(error < 1e-7 * (expected.abs() + 1.0), "ln {x}: {error:e}");
        }
    }

    fn all_shares(nodes: &Nodes, gamma: f32) -> Vec<f32> {
        let basis = Basis::new(nodes);
        let mut located = [gamma];
        basis.locate(&mut located);
        let mut all = Vec::new();
        for k in 0..nodes.terms() {
            let mut share = [0.0];
            basis.shares(k, &located, &mut share);
            all.push(share[0]);
        }
        all
    }

    #[test]
    fn shares_sum_to_one_for_any_number_of_nodes() {
        for terms in [1, 2, 7, 16, 40, 100] {
            let nodes = Nodes::chebyshev(0.04, 30.0, terms);
            for gamma in [0.0, 0.04, 0.1, 1.0, 7.0, 30.0, 99.0] {
                let sum: f32 = all_shares(&nodes, gamma).iter().sum();
                assert!((sum - 1.0).abs() < 3e-6, "{terms} nodes at γ = {gamma}: {sum}");
            }
        }
    }

    #[test]
    fn a_node_has_its_own_kernel_alone() {
        let nodes = Nodes::chebyshev(0.04, 30.0, 7);
        let shares = all_shares(&nodes, nodes.gamma(3) as f32);
        for (k, share) in shares.iter().enumerate() {
            assert!((share - f32::from(u8::from(k == 3))).abs() < 1e-5, "{shares:?}");
        }
        assert_eq!(all_shares(&Nodes::exact([1.0, 2.5, 9.0]), 2.5), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn between_nodes_a_polynomial_in_s_is_reproduced() {
        let nodes = Nodes::chebyshev(0.1, 20.0, 5);
        let value = |gamma: f64| 1.0 + place(gamma) - 0.5 * place(gamma).powi(3);
        for gamma in [0.1, 0.5, 3.0, 19.0] {
            let shares = all_shares(&nodes, gamma as f32);
            let mixed: f64 = shares
                .iter()
                .enumerate()
                .map(|(k, share)| f64::from(*share) * value(nodes.gamma(k)))
                .sum();
            assert!((mixed - value(gamma)).abs() < 2e-5, "γ = {gamma}");
        }
    }
}
