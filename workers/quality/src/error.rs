//! Errors of measurements.

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
    /// A metric needs a clean picture and there is none.
    #[error("{metric} needs a clean picture, which is missing")]
    NoReference {
        /// The metric's name.
        metric: String,
    },
    /// The clean picture has another size.
    #[error("picture is {width}×{height} but the clean one is {clean_width}×{clean_height}")]
    Size {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Columns of the clean picture.
        clean_width: usize,
        /// Rows of the clean picture.
        clean_height: usize,
    },
}
