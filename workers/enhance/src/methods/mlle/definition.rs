//! Constants and factors of the definition, shared by both variants.

/// Lightness of white in CIE Lab, and the offset of the balanced a and b.
pub(super) const WHITE: f64 = 100.0;
pub(super) const NEUTRAL: f64 = 128.0;

/// Factors of `a + 128` and `b + 128` by their means.
pub(super) fn balance([a, b]: [f64; 2]) -> [f64; 2] {
    let factor = |own: f64, other: f64| 1.0 + (other - own).max(0.0) / (own + other);
    [factor(a, b), factor(b, a)]
}
