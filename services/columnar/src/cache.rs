//! Columns that were read, within a bound.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::column::Column;
use crate::error::ColumnarError;
use crate::file::ReplicaFile;

/// Columns of files that were read lately. A query that needs more than fits keeps what came first: if it threw out the oldest,
/// the next one like it would find nothing of it.
#[derive(Debug)]
pub struct Cache {
    most_bytes: usize,
    held: Mutex<Held>,
}

#[derive(Debug, Default)]
struct Held {
    columns: HashMap<(u64, String), (Arc<Column>, u64)>,
    bytes: usize,
    /// Counts the questions.
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
        // Texts have to be taken apart, numbers are read as they lie: these leave room for those.
        let most_bytes = match **column {
            Column::Texts { .. } => most_bytes,
            _ => most_bytes / 2,
        };
        if self.bytes + bytes > most_bytes {
            // What no query of late has asked for.
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
