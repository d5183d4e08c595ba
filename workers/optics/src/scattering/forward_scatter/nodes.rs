//! The kernels that the fast method works with.
//!
//! `H(f; γ) ≈ Σ_k l_k(γ) H(f; γ_k)` with Lagrange weights in `s = ln(γ + 0.3)` at Chebyshev nodes; the weights sum to 1, which
//! conserves light. In s the kernel changes evenly: over the pixel for small γ, by octaves for large ones. Equal steps in γ would
//! need many times as many nodes. A frame with few distinct scales is not interpolated.

use std::f64::consts::PI;

use super::decimation::Coarseness;

/// Where the scale of s turns from linear to logarithmic, px.
pub(super) const SHIFT_PX: f64 = 0.3;
/// Two nodes carry an interval this narrow in s.
const NARROW: f64 = 1e-3;
/// Within an interval this narrow in s the kernel does not change in f32.
const POINT: f64 = 1e-6;

/// s of a kernel scale.
pub(crate) fn place(gamma: f64) -> f64 {
    (gamma + SHIFT_PX).ln()
}

/// The kernel scale at s.
pub(crate) fn scale_at(s: f64) -> f64 {
    s.exp() - SHIFT_PX
}

/// Kernel scales γ_k in pixels: at least one, ascending, all different.
#[derive(Debug, Clone, PartialEq)]
pub enum Nodes {
    /// All scales of the frame: every pixel has one of them.
    Exact(Vec<f32>),
    /// Nodes between which to interpolate.
    Chebyshev {
        /// The scales.
        gammas: Vec<f64>,
        /// The interval of scales that they span.
        span: (f64, f64),
        /// Subtracted from γ in s; at most the least scale. 0 without gates.
        origin: f64,
    },
}

impl Nodes {
    /// The distinct scales themselves.
    ///
    /// # Panics
    /// If `gammas` is empty.
    #[must_use]
    pub fn exact(gammas: impl IntoIterator<Item = f64>) -> Self {
        let mut gammas: Vec<f32> = gammas.into_iter().map(|gamma| gamma as f32).collect();
        gammas.sort_by(f32::total_cmp);
        gammas.dedup();
        assert!(!gammas.is_empty(), "at least one kernel");
        Self::Exact(gammas)
    }

    /// `terms` nodes over `least..=most`; two if the interval is narrow, one if it is a point.
    #[must_use]
    pub fn chebyshev(least: f64, most: f64, terms: usize) -> Self {
        Self::chebyshev_from(0.0, (least, most), terms)
    }

    /// The same in `s = ln(γ − origin + 0.3)`.
    #[must_use]
    pub(crate) fn chebyshev_from(origin: f64, (least, most): (f64, f64), terms: usize) -> Self {
        let (low, high) = (place(least - origin), place(most - origin));
        let terms = match high - low {
            width if width < POINT => 1,
            width if width < NARROW => 2,
            _ => terms.max(1),
        };
        let node = |k: usize| {
            let cosine = (PI * (k as f64 + 0.5) / terms as f64).cos();
            scale_at((low + high) / 2.0 - (high - low) / 2.0 * cosine).max(0.0) + origin
        };
        Self::Chebyshev {
            gammas: (0..terms).map(node).collect(),
            span: (least, most),
            origin,
        }
    }

    /// The same nodes with the nearest one moved to `gamma`, a scale of their span: light of that scale is exact.
    #[must_use]
    pub(crate) fn with_node_at(mut self, gamma: f64) -> Self {
        let nearest = self.nearest(gamma);
        if let Self::Chebyshev { gammas, .. } = &mut self {
            gammas[nearest] = gamma;
        }
        self
    }

    /// The kernel whose scale is nearest to `gamma`.
    #[must_use]
    pub(crate) fn nearest(&self, gamma: f64) -> usize {
        let distance = |&k: &usize| (self.gamma(k) - gamma).abs();
        (0..self.terms())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("at least one kernel")
    }

    /// How many kernels.
    #[must_use]
    pub fn terms(&self) -> usize {
        match self {
            Self::Exact(gammas) => gammas.len(),
            Self::Chebyshev { gammas, .. } => gammas.len(),
        }
    }

    /// The scale of kernel `k`, pixels.
    ///
    /// # Panics
    /// If kernel `k` does not exist.
    #[must_use]
    pub fn gamma(&self, k: usize) -> f64 {
        match self {
            Self::Exact(gammas) => f64::from(gammas[k]),
            Self::Chebyshev { gammas, .. } => gammas[k],
        }
    }
}

/// Kernels of one layer; `None` if it has no light to spread.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Kernels {
    /// Of the only kernel of a path, or the narrow one.
    pub narrow: Option<Nodes>,
    /// Of the wide one.
    pub wide: Option<Nodes>,
    /// Error of coarse rows of the narrow kernels.
    pub narrow_coarse: Coarseness,
    /// The same of the wide ones.
    pub wide_coarse: Coarseness,
}

impl Kernels {
    /// Whether one of them is computed on coarse rows in a frame of `height` rows.
    #[must_use]
    pub fn has_coarse_rows(&self, height: usize) -> bool {
        let parts = [(&self.narrow, self.narrow_coarse), (&self.wide, self.wide_coarse)];
        parts.into_iter().any(|(nodes, coarse)| {
            let nodes = nodes
                .iter()
                .flat_map(|nodes| (0..nodes.terms()).map(|k| nodes.gamma(k)));
            nodes
                .into_iter()
                .any(|gamma| coarse.rows(gamma, height).is_some())
        })
    }

    /// How many there are.
    #[must_use]
    pub fn terms(&self) -> usize {
        [&self.narrow, &self.wide]
            .into_iter()
            .flatten()
            .map(Nodes::terms)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_needs_one_kernel_and_a_narrow_interval_two() {
        assert_eq!(Nodes::chebyshev(2.0, 2.0, 9).terms(), 1);
        assert!((Nodes::chebyshev(2.0, 2.0, 9).gamma(0) - 2.0).abs() < 1e-12);
        assert_eq!(Nodes::chebyshev(2.0, 2.0005, 9).terms(), 2);
        assert_eq!(Nodes::chebyshev(2.0, 3.0, 9).terms(), 9);
    }

    #[test]
    fn nodes_ascend_within_their_span_and_never_below_zero() {
        let nodes = Nodes::chebyshev(0.0, 30.0, 7);
        let gammas: Vec<f64> = (0..7).map(|k| nodes.gamma(k)).collect();
        assert!(
            gammas.is_sorted() && gammas[0] >= 0.0 && gammas[6] < 30.0,
            "{gammas:?}"
        );
    }

    #[test]
    fn equal_scales_are_one_kernel() {
        assert_eq!(Nodes::exact([3.0, 1.0, 3.0]), Nodes::Exact(vec![1.0, 3.0]));
    }
}
