//! Opens the set that a command names.

use cli::exit::Failure;
use sets::{Location, Set};

use crate::failure::failure;

/// The set at a location that the user names.
pub(super) fn open(location: &str) -> Result<Set, Failure> {
    Set::open(&Location::parse(location).map_err(failure)?).map_err(failure)
}
