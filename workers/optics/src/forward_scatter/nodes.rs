//! The kernels between which the fast method interpolates.
//!
//! `H(f; γ) ≈ Σ_k l_k(γ) H(f; γ_k)` with Lagrange weights in `s = ln(γ + 0.3)` at Chebyshev nodes; the weights sum to 1, so
//! no light is lost. In s the kernel changes evenly: over the pixel for small γ, by octaves for large ones. Equal steps in γ
//! would need many times as many nodes.

use std::f64::consts::PI;

/// Where the scale of s turns from linear to logarithmic, px.
const SHIFT_PX: f64 = 0.3;
/// Two nodes carry an interval this narrow in s.
const NARROW: f64 = 1e-3;

fn place(gamma: f64) -> f64 {
    (gamma + SHIFT_PX).ln()
}

/// Kernel scales γ_k in pixels, at least one, all different.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes {
    gammas: Vec<f64>,
}

impl Nodes {
    /// The distinct scales themselves: interpolation is then exact.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn exact(mut gammas: Vec<f64>) -> Self {
        gammas.sort_by(f64::total_cmp);
        gammas.dedup();
        assert!(!gammas.is_empty(), "at least one kernel");
        Self { gammas }
    }

    /// `terms` Chebyshev nodes over `least..=most`; two if the interval is narrow, one if it is a point.
    #[must_use]
    pub fn chebyshev(least: f64, most: f64, terms: usize) -> Self {
        if least >= most {
            return Self::exact(vec![least]);
        }
        let (low, high) = (place(least), place(most));
        let terms = if high - low < NARROW { 2 } else { terms.max(1) };
        let node = |k: usize| {
            let cosine = (PI * (k as f64 + 0.5) / terms as f64).cos();
            (((low + high) / 2.0 + (high - low) / 2.0 * cosine).exp() - SHIFT_PX).max(0.0)
        };
        Self::exact((0..terms).map(node).collect())
    }

    /// The scales, ascending.
    #[must_use]
    pub fn gammas(&self) -> &[f64] {
        &self.gammas
    }

    /// Prepares the weights.
    #[must_use]
    pub(super) fn lagrange(&self) -> Lagrange {
        let places: Vec<f64> = self.gammas.iter().map(|&gamma| place(gamma)).collect();
        let middle = (places[0] + places[places.len() - 1]) / 2.0;
        let half = ((places[places.len() - 1] - places[0]) / 2.0).max(f64::MIN_POSITIVE);
        let nodes: Vec<f64> = places.iter().map(|s| (s - middle) / half).collect();
        let weight = |k: usize| {
            let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
            1.0 / others.map(|(_, other)| nodes[k] - other).product::<f64>()
        };
        Lagrange {
            middle,
            half,
            weights: (0..nodes.len()).map(weight).collect(),
            nodes,
        }
    }
}

/// Barycentric weights on normalised nodes.
pub(super) struct Lagrange {
    middle: f64,
    half: f64,
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Lagrange {
    /// `l_k(γ)` for every node; their sum is 1. `shares` has one place for each node.
    pub(super) fn at(&self, gamma: f64, shares: &mut [f64]) {
        let s = (place(gamma) - self.middle) / self.half;
        if let Some(exact) = self.nodes.iter().position(|&node| (s - node).abs() < 1e-14) {
            shares.fill(0.0);
            shares[exact] = 1.0;
            return;
        }
        let mut total = 0.0;
        for ((share, weight), node) in shares.iter_mut().zip(&self.weights).zip(&self.nodes) {
            *share = weight / (s - node);
            total += *share;
        }
        shares.iter_mut().for_each(|share| *share /= total);
    }
}

/// Terms that suffice for an error of `tolerance` in linear light, without any table:
/// `K = ceil(3 + 0.8 h ln(u/tol))`, `h = ½ ln((γ_max + 0.3)/(γ_min + 0.3))`, u the largest source light. Fitted so that it
/// lies at or above what the error bound asks for over γ from 0 to 1000 px and tolerances from 1/255 to 1e-6.
#[must_use]
pub fn closed_form_terms(least: f64, most: f64, brightest: f64, tolerance: f64) -> usize {
    let half = (place(most) - place(least)) / 2.0;
    let decades = (brightest / tolerance).max(1.0).ln();
    (3.0 + 0.8 * half * decades).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_select_a_node_at_its_own_place() {
        let nodes = Nodes::chebyshev(0.04, 30.0, 7);
        let lagrange = nodes.lagrange();
        let mut shares = vec![0.0; 7];
        for gamma in [0.04, 0.1, 1.0, 7.0, 30.0] {
            lagrange.at(gamma, &mut shares);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        lagrange.at(nodes.gammas()[3], &mut shares);
        assert_eq!(shares, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_point_needs_one_kernel_and_a_narrow_interval_two() {
        assert_eq!(Nodes::chebyshev(2.0, 2.0, 9).gammas(), [2.0]);
        assert_eq!(Nodes::chebyshev(2.0, 2.0005, 9).gammas().len(), 2);
    }

    #[test]
    fn terms_grow_with_the_logarithm_of_the_ratio_and_of_the_tolerance() {
        assert_eq!(closed_form_terms(1.0, 10.0, 1.0, 1.0 / 255.0), 8);
        assert_eq!(closed_form_terms(1.0, 1.0, 1.0, 1e-6), 3);
        assert!(closed_form_terms(0.0, 100.0, 1.0, 1e-6) >= 31);
    }
}
