//! Collections of uploaded scenes.

use crate::check::is_dataset;

/// Most scenes of a collection: a description holds all their ids, of 39 bytes each, in its megabyte.
pub const MAX_COLLECTION: u64 = 10_000;

/// Whether a text may be the name of a collection: as that of a dataset.
#[must_use]
pub fn is_collection(name: &str) -> bool {
    is_dataset(name)
}
