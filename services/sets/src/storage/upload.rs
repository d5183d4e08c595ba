//! A file on its way into the store: streamed in parts, so that its length costs no memory.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;
use object_store::buffered::BufWriter;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tokio::io::AsyncWriteExt;

use crate::error::SetError;
use crate::storage::location::Location;
use crate::storage::store::Store;

/// Part of an upload to a bucket. S3 allows 10 000 parts, so a file may have 78 GiB. One part is filled while another is sent.
const PART_BYTES: usize = 8 << 20;
/// Part of an upload to a folder, without a limit on their number.
const FOLDER_PART_BYTES: usize = 1 << 20;
/// Small writes are gathered up to this size.
const GATHERED_BYTES: usize = 256 << 10;

/// The expected length and digest of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileSum {
    /// SHA-256, lower-case hex.
    pub sha256: String,
    /// Length in bytes.
    pub bytes: u64,
}

impl FileSum {
    /// Describes a wrong or missing length; `None` if it is as expected.
    pub(crate) fn contradiction(&self, name: &str, found: Option<u64>) -> Option<String> {
        match found {
            None => Some(format!("{name} is gone")),
            Some(bytes) if bytes != self.bytes => Some(format!(
                "{name} has {bytes} bytes, its marker says {}",
                self.bytes
            )),
            Some(_) => None,
        }
    }
}

/// A file that is being uploaded, invisible before [`Upload::finish`]; clones write the same file.
#[derive(Clone)]
pub(crate) struct Upload {
    store: Store,
    name: String,
    state: Arc<Mutex<State>>,
}

struct State {
    writer: BufWriter,
    gathered: Vec<u8>,
    hash: Sha256,
    bytes: u64,
    failure: Option<SetError>,
    is_open: bool,
}

impl Upload {
    pub(crate) fn new(store: &Store, name: String) -> Self {
        let part = match store.location() {
            Location::Folder(_) => FOLDER_PART_BYTES,
            Location::S3 { .. } => PART_BYTES,
        };
        let writer = BufWriter::with_capacity(Arc::clone(&store.objects), store.path(&name), part);
        let state = State {
            writer: writer.with_max_concurrency(1),
            gathered: Vec::with_capacity(GATHERED_BYTES),
            hash: Sha256::new(),
            bytes: 0,
            failure: None,
            is_open: true,
        };
        Self {
            store: store.clone(),
            name,
            state: Arc::new(Mutex::new(state)),
        }
    }

    /// Bytes so far.
    pub(crate) fn bytes(&self) -> u64 {
        self.state().bytes
    }

    /// Why the store took no more, or else this reason.
    pub(crate) fn failure(&self, otherwise: impl std::fmt::Display) -> SetError {
        let failure = self.state().failure.take();
        failure.unwrap_or_else(|| SetError::Machine(format!("cannot write {}: {otherwise}", self.name)))
    }

    /// Completes the file.
    pub(crate) fn finish(&self) -> Result<FileSum, SetError> {
        let mut state = self.state();
        state.is_open = false;
        let sent = state.send(&self.store).and_then(|()| {
            let shut = self.store.wait(async { Ok(state.writer.shutdown().await) })?;
            shut.map_err(|error| match error.downcast::<object_store::Error>() {
                Ok(error) => self.store.explain(&error),
                Err(error) => SetError::Later(format!("{} cannot be written: {error}", self.name)),
            })
        });
        sent?;
        Ok(FileSum {
            sha256: hex::encode(state.hash.clone().finalize()),
            bytes: state.bytes,
        })
    }

    /// Aborts the upload and removes its parts, if the store allows it; otherwise `gc` removes them.
    pub(crate) fn abandon(&self) {
        let mut state = self.state();
        if std::mem::replace(&mut state.is_open, false) {
            let _ = self.store.wait(state.writer.abort());
        } else {
            let _ = self.store.delete(&self.name);
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn send(&mut self, store: &Store) -> Result<(), SetError> {
        if self.gathered.is_empty() {
            return Ok(());
        }
        let bytes = std::mem::replace(&mut self.gathered, Vec::with_capacity(GATHERED_BYTES));
        store.wait(self.writer.put(Bytes::from(bytes)))
    }
}

impl Write for Upload {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.state();
        state.hash.update(bytes);
        state.bytes += bytes.len() as u64;
        state.gathered.extend_from_slice(bytes);
        if state.gathered.len() >= GATHERED_BYTES
            && let Err(error) = state.send(&self.store)
        {
            let text = error.to_string();
            state.failure = Some(error);
            return Err(io::Error::other(text));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
