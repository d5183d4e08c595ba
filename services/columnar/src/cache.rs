//! Columns that were read, within a bound.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::column::Column;
use crate::error::ColumnarError;
use crate::file::ReplicaFile;

/// Recently read columns of files. A query that needs more than fits keeps its first columns: evicting the oldest would leave nothing
/// for the next similar query.
#[derive(Debug)]
pub struct Cache {
    most_bytes: usize,
    held: Mutex<Held>,
}

#[derive(Debug, Default)]
struct Held {
    columns: HashMap<(u64, String), (Arc<Column>, u64)>,
    bytes: usize,
    /// Number of queries so far.
    now: u64,
}

impl Cache {
    /// A cache of at most this size.
    #[must_use]
    pub fn new(most_bytes: usize) -> Self {
        Self {
            most_bytes,
            held: Mutex::default(),
        }
    }

    /// A new query begins.
    pub(crate) fn begin(&self) {
        self.held.lock().unwrap_or_else(PoisonError::into_inner).now += 1;
    }

    /// A column of a file.
    pub(crate) fn read(&self, file: &ReplicaFile, name: &str) -> Result<Arc<Column>, ColumnarError> {
        let key = (file.id, name.to_owned());
        {
            let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
            let now = held.now;
            if let Some((column, used)) = held.columns.get_mut(&key) {
                *used = now;
                return Ok(Arc::clone(column));
            }
        }
        let column = Arc::new(file.read(name)?);
        self.held
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .keep(key, &column, self.most_bytes);
        Ok(column)
    }
}

impl Held {
    fn keep(&mut self, key: (u64, String), column: &Arc<Column>, most_bytes: usize) {
        let bytes = column.bytes();
        // Half of the cache is reserved for texts, which are expensive to decode; numbers are read as they are stored.
        let most_bytes = match **column {
            Column::Texts { .. } => most_bytes,
            _ => most_bytes / 2,
        };
        if self.bytes + bytes > most_bytes {
            // Columns that no recent query used.
            let old = self.now.saturating_sub(1);
            let mut freed = 0;
            self.columns.retain(|_, (column, used)| {
                let stays = *used >= old;
                freed += if stays { 0 } else { column.bytes() };
                stays
            });
            self.bytes -= freed;
        }
        if self.bytes + bytes <= most_bytes {
            let before = self.columns.insert(key, (Arc::clone(column), self.now));
            self.bytes += bytes;
            self.bytes -= before.map_or(0, |(column, _)| column.bytes());
        }
    }
}
