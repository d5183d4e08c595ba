//! The identity of an image.

/// An image by its job and frame.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct ImageId {
    /// The job.
    pub job: String,
    /// The frame.
    pub frame: u64,
}
