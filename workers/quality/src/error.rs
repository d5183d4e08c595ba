//! Errors of measurements.

use crate::needs::Needs;

/// A picture that cannot be measured.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QualityError {
    /// The picture has no pixels.
    #[error("picture is {width}×{height} but needs at least 1×1")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A metric needs more than the picture.
    #[error("{metric} needs {needs}, which is missing")]
    Missing {
        /// The metric's name.
        metric: String,
        /// The missing input.
        needs: Needs,
    },
    /// The clean picture, the mask or the illumination has another size.
    #[error("picture is {width}×{height} but the {other} is {other_width}×{other_height}")]
    Size {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// The other input.
        other: &'static str,
        /// Its columns.
        other_width: usize,
        /// Its rows.
        other_height: usize,
    },
}
