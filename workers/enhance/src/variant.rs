//! How a stage with a fast and a reference implementation is computed.

/// Which of the two implementations computes a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Variant {
    /// Constant time per pixel, in single precision where the tolerance allows it.
    #[default]
    Fast,
    /// The definition, written plainly in double precision.
    Reference,
}
