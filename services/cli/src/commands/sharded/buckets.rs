//! Reads ranges of sets in buckets for the service, which has no client of S3 itself.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use api::{ReadBucket, Unread};
use catalogue::Place;
use sets::{Location, SetError, Store};

/// Open stores by the URL of their set.
type Stores = Mutex<BTreeMap<String, Store>>;

/// A reader of buckets that opens each one once.
pub(crate) fn reader() -> ReadBucket {
    let stores = Stores::default();
    Arc::new(move |place, range| read(&stores, place, range))
}

fn read(stores: &Stores, place: &Place, range: Range<u64>) -> Result<Vec<u8>, Unread> {
    let store = open(stores, &place.set).map_err(unread)?;
    let end = range.end;
    let failure = match store.range(&place.tar, range) {
        Ok(bytes) => return Ok(bytes.to_vec()),
        Err(error) => error,
    };
    // Stores report a range beyond the end of an object differently.
    match store.entry(&place.tar).map_err(unread)? {
        Some(entry) if entry.bytes >= end => Err(unread(failure)),
        Some(entry) => Err(Unread::Gone(format!(
            "{} in {} has only {} bytes",
            place.tar, place.set, entry.bytes
        ))),
        None => Err(Unread::Gone(format!("{} in {} is gone", place.tar, place.set))),
    }
}

fn open(stores: &Stores, set: &str) -> Result<Store, SetError> {
    let mut stores = stores.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(store) = stores.get(set) {
        return Ok(store.clone());
    }
    let store = Store::open(&Location::parse(set)?)?;
    stores.insert(set.to_owned(), store.clone());
    Ok(store)
}

fn unread(error: SetError) -> Unread {
    match error {
        SetError::Damaged(reason) => Unread::Gone(reason),
        other => Unread::Unreachable(other.to_string()),
    }
}
