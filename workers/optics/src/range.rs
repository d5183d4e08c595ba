//! Range along the ray, and what a pixel without one means.

/// The shortest range that is one, in metres: below it, and where it is not finite, the pixel is a hole.
pub const SHORTEST_M: f32 = 1e-3;

/// Whether a pixel's range is none: NaN, infinite, negative, zero or below a millimetre.
#[must_use]
pub fn is_hole(range: f32) -> bool {
    !(range.is_finite() && range >= SHORTEST_M)
}

/// What a hole means.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum HoleRule {
    /// The ray meets only water: nothing of the scene arrives where the water attenuates at all.
    #[default]
    Background,
    /// The range is this many metres.
    Range(f64),
    /// A frame with holes is refused.
    Reject,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_distance_is_a_hole() {
        for range in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, 9.9e-4] {
            assert!(is_hole(range), "{range}");
        }
        assert!(!is_hole(1e-3) && !is_hole(1e6));
    }
}
