//! Collections of uploaded scenes.

use crate::check::is_dataset;

/// Maximum scenes of a collection: a description contains all their ids, 39 bytes each, within one megabyte.
pub const MAX_COLLECTION: u64 = 10_000;

/// Whether a text is a valid name of a collection; the rules are those of dataset names.
#[must_use]
pub fn is_collection(name: &str) -> bool {
    is_dataset(name)
}
