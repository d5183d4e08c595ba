//! Points in the water that light reaches.

/// A point in the water and the weight of its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LitPoint {
    /// In camera axes, m.
    pub place: [f64; 3],
    /// Largest share of its light in a pixel, 0 to 1.
    pub weight: f64,
}
