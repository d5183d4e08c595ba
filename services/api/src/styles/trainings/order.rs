//! The options of a training.

use tempfile::TempDir;

/// The options of a training; the photos are in `folder`.
pub(crate) struct Order {
    /// The caller that submitted it.
    pub(crate) owner: String,
    pub(crate) name: String,
    pub(crate) seed: u64,
    pub(crate) steps: u32,
    /// Whether its network has a range input.
    pub(crate) range: bool,
    pub(crate) licence: String,
    pub(crate) source: String,
    pub(crate) photos: usize,
    pub(crate) folder: TempDir,
}
