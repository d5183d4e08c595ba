//! Choice between fast and reference implementations.

/// Implementation of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Variant {
    /// Constant time per pixel, in single precision where the tolerance allows it.
    #[default]
    Fast,
    /// The definition, written plainly in f64.
    Reference,
}
