//! Opens the set that a command names.

use cli::exit::Failure;
use sets::{Location, Set};

use super::failure::failure;

/// The set at a location that the user names.
pub(crate) fn open(location: &str) -> Result<Set, Failure> {
    Set::open(&Location::parse(location).map_err(failure)?).map_err(failure)
}

/// The location after resolving links.
pub(crate) fn resolved(location: &Location) -> Result<Location, Failure> {
    match location {
        Location::Folder(path) => {
            let whole = path.canonicalize();
            let whole = whole.map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
            match whole.to_str() {
                Some(_) => Ok(Location::Folder(whole)),
                None => Err(Failure::BadInput(format!("{} is not UTF-8", whole.display()))),
            }
        }
        bucket @ Location::S3 { .. } => Ok(bucket.clone()),
    }
}
