//! Which pack holds which blob: in memory, filled from the packs at start. There is no index file that could disagree.

use std::collections::{BTreeMap, HashMap, HashSet};

use futures::TryStreamExt;
use sqlx::{Row, SqliteConnection};

use crate::digest::Digest;
use crate::error::StoreError;
use crate::pack::{Folder, check};

/// Where a blob lies and how long it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) pack: u32,
    pub(crate) length: u64,
}

/// What a pack holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PackUse {
    pub(crate) blobs: u64,
    pub(crate) bytes: u64,
}

/// All blobs that can be read.
#[derive(Debug, Default)]
pub(crate) struct Index {
    places: HashMap<Digest, Place>,
    packs: BTreeMap<u32, PackUse>,
    /// Found not to have their digest any more. A put replaces them.
    damaged: HashSet<Digest>,
}

impl Index {
    /// Reads every pack; of a digest in two packs the newer counts, since it replaced damaged bytes.
    pub(crate) async fn load(folder: &Folder, packs: &[u32]) -> Result<Self, StoreError> {
        let mut index = Self::default();
        for &pack in packs {
            let path = folder.path(pack);
            let mut connection = folder
                .writer(pack)
                .await
                .map_err(|error| StoreError::pack(&path, error))?;
            check(&mut connection, &path).await?;
            index
                .read(&mut connection, pack)
                .await
                .map_err(|error| StoreError::pack(&path, error))?;
        }
        Ok(index)
    }

    async fn read(&mut self, connection: &mut SqliteConnection, pack: u32) -> Result<(), sqlx::Error> {
        self.add_pack(pack);
        let mut rows = sqlx::query("SELECT digest, length FROM entry").fetch(connection);
        while let Some(row) = rows.try_next().await? {
            let length: i64 = row.try_get(1)?;
            if let Some(digest) = Digest::from_row(row.try_get(0)?) {
                self.insert(
                    digest,
                    Place {
                        pack,
                        length: length as u64,
                    },
                );
            }
        }
        Ok(())
    }

    /// Where the blob can be read, damaged or not.
    pub(crate) fn place(&self, digest: &Digest) -> Option<Place> {
        self.places.get(digest).copied()
    }

    /// Whether the blob is there and not known to be damaged.
    pub(crate) fn holds(&self, digest: &Digest) -> bool {
        self.places.contains_key(digest) && !self.damaged.contains(digest)
    }

    /// Makes a place that is on the disk known.
    pub(crate) fn insert(&mut self, digest: Digest, place: Place) {
        self.damaged.remove(&digest);
        if let Some(before) = self.places.insert(digest, place)
            && let Some(used) = self.packs.get_mut(&before.pack)
        {
            used.blobs -= 1;
            used.bytes -= before.length;
        }
        let used = self.packs.entry(place.pack).or_default();
        used.blobs += 1;
        used.bytes += place.length;
    }

    pub(crate) fn set_damaged(&mut self, digest: Digest) {
        self.damaged.insert(digest);
    }

    pub(crate) fn add_pack(&mut self, pack: u32) {
        self.packs.entry(pack).or_default();
    }

    /// The newest pack.
    pub(crate) fn last(&self) -> Option<(u32, PackUse)> {
        self.packs.last_key_value().map(|(&pack, &used)| (pack, used))
    }

    pub(crate) fn packs(&self) -> &BTreeMap<u32, PackUse> {
        &self.packs
    }
}
