//! The tar of a shard, as WebDataset reads it: `FRAME.KIND.EXT` and `FRAME.json`, frame by frame.

use tar::{Builder, Header};

use crate::error::SetError;
use crate::storage::upload::{FileSum, Upload};

/// Length of the header of a member; names are short enough for a single block.
const HEADER_BYTES: u64 = 512;
/// Longest name that fits into a single block.
const MOST_NAME_BYTES: usize = 100;

/// A tar on its way into the store.
pub(crate) struct Archive {
    builder: Builder<Upload>,
    upload: Upload,
}

impl Archive {
    pub(crate) fn new(upload: Upload) -> Self {
        Self {
            builder: Builder::new(upload.clone()),
            upload,
        }
    }

    /// Adds a file of a frame, such as `rgb.png`; returns where its bytes begin.
    pub(crate) fn add(&mut self, frame: u64, name: &str, bytes: &[u8]) -> Result<u64, SetError> {
        let path = spec::shard_member(frame, name);
        if path.len() > MOST_NAME_BYTES {
            return Err(SetError::Machine(format!("{path} is too long a name for a tar")));
        }
        let offset = self.upload.bytes() + HEADER_BYTES;
        let mut header = Header::new_ustar();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        let added = self.builder.append_data(&mut header, path, bytes);
        added.map_err(|error| self.upload.failure(error))?;
        Ok(offset)
    }

    pub(crate) fn finish(mut self) -> Result<FileSum, SetError> {
        self.builder
            .finish()
            .map_err(|error| self.upload.failure(error))?;
        self.upload.finish()
    }

    pub(crate) fn abandon(self) {
        self.upload.abandon();
    }
}
