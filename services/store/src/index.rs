//! Index from digest to pack: in memory, filled from the packs at start. An index file could disagree with the packs.

use std::collections::{BTreeMap, HashMap, HashSet};

use futures::TryStreamExt;
use sqlx::{Connection, Row};

use crate::digest::Digest;
use crate::error::{StoreError, is_damage};
use crate::pack::{Folder, check, delete_entries};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Location {
    pub(crate) pack: u32,
    pub(crate) length: u64,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PackUse {
    pub(crate) blobs: u64,
    pub(crate) bytes: u64,
}

/// All readable blobs.
#[derive(Debug, Default)]
pub(crate) struct Index {
    locations: HashMap<Digest, Location>,
    packs: BTreeMap<u32, PackUse>,
    /// Bytes no longer match the digest. The next put replaces them.
    damaged: HashSet<Digest>,
    /// Packs closed for writing.
    sealed: HashSet<u32>,
    /// Highest pack number used so far.
    newest: u32,
    /// Number of unreadable packs.
    set_aside: u64,
}

impl Index {
    /// Reads every pack. If two packs have the same digest after a crash or damage, the newer entry counts and the
    /// older one is deleted. An unreadable pack is set aside: the others are intact, and its blobs can be rendered
    /// again.
    pub(crate) async fn load(folder: &Folder, packs: &[u32]) -> Result<Self, StoreError> {
        let mut index = Self::default();
        for &pack in packs {
            match index.read(folder, pack).await {
                Ok(()) => {}
                Err(StoreError::Damaged { message }) => {
                    tracing::error!(pack, message, "an artifact pack is unreadable and was set aside");
                    folder.set_aside(pack)?;
                    index.set_aside += 1;
                }
                Err(error @ (StoreError::Full { .. } | StoreError::Pack { .. })) => return Err(error),
                Err(other) => return Err(StoreError::pack(&folder.path(pack), other)),
            }
        }
        Ok(index)
    }

    async fn read(&mut self, folder: &Folder, pack: u32) -> Result<(), StoreError> {
        if folder.size(pack)? == 0 {
            return Err(StoreError::Damaged {
                message: "the file is empty".to_owned(),
            });
        }
        let mut connection = folder.open_sealed(pack).await?;
        check(&mut connection, &folder.path(pack)).await?;
        let mut stale: BTreeMap<u32, Vec<Digest>> = BTreeMap::new();
        self.add_pack(pack);
        {
            let mut rows = sqlx::query("SELECT digest, length FROM entry").fetch(&mut connection);
            loop {
                let row = match rows.try_next().await {
                    Ok(Some(row)) => row,
                    Ok(None) => break,
                    // The rows read so far are usable: every blob is hashed before it is served.
                    Err(error) if is_damage(&error) => {
                        tracing::error!(pack, %error, "an artifact pack is only partly readable");
                        self.seal(pack);
                        break;
                    }
                    Err(error) => return Err(error.into()),
                };
                let length = row.try_get::<i64, _>(1)? as u64;
                if let Some(digest) = Digest::from_row(row.try_get(0)?)
                    && let Some(before) = self.insert(digest, Location { pack, length })
                {
                    stale.entry(before.pack).or_default().push(digest);
                }
            }
        }
        connection.close().await?;
        for (pack, digests) in stale {
            let mut connection = folder.open_sealed(pack).await?;
            if let Err(error) = delete_entries(&mut connection, &digests).await {
                tracing::warn!(pack, %error, "could not delete the old entries of a pack");
            }
            connection.close().await?;
        }
        Ok(())
    }

    /// Where the blob is stored, damaged or not.
    pub(crate) fn locate(&self, digest: &Digest) -> Option<Location> {
        self.locations.get(digest).copied()
    }

    /// Whether the blob is stored and not known to be damaged.
    pub(crate) fn holds(&self, digest: &Digest) -> bool {
        self.locations.contains_key(digest) && !self.damaged.contains(digest)
    }

    /// Records where a blob is stored; returns the previous location.
    pub(crate) fn insert(&mut self, digest: Digest, place: Location) -> Option<Location> {
        self.damaged.remove(&digest);
        let before = self.locations.insert(digest, place);
        self.discount(before);
        let used = self.packs.entry(place.pack).or_default();
        used.blobs += 1;
        used.bytes += place.length;
        before
    }

    /// Removes a blob; returns where it was stored.
    pub(crate) fn remove(&mut self, digest: &Digest) -> Option<Location> {
        self.damaged.remove(digest);
        let before = self.locations.remove(digest);
        self.discount(before);
        before
    }

    fn discount(&mut self, place: Option<Location>) {
        if let Some(place) = place
            && let Some(used) = self.packs.get_mut(&place.pack)
        {
            used.blobs -= 1;
            used.bytes -= place.length;
        }
    }

    /// Marks the bytes at this location as damaged and seals their pack, which may have more damage.
    pub(crate) fn set_damaged(&mut self, digest: Digest, place: Location) {
        if self.locate(&digest) == Some(place) {
            self.damaged.insert(digest);
            self.seal(place.pack);
        }
    }

    /// Closes a pack for writing.
    pub(crate) fn seal(&mut self, pack: u32) {
        self.sealed.insert(pack);
    }

    pub(crate) fn add_pack(&mut self, pack: u32) {
        self.packs.entry(pack).or_default();
        self.newest = self.newest.max(pack);
    }

    /// Removes a pack without blobs; returns whether it did.
    pub(crate) fn remove_pack(&mut self, pack: u32) -> bool {
        let empty = self.packs.get(&pack).is_some_and(|used| used.blobs == 0);
        if empty {
            self.packs.remove(&pack);
            self.sealed.remove(&pack);
        }
        empty
    }

    /// The open pack, unless the newest is sealed.
    pub(crate) fn growing(&self) -> Option<(u32, PackUse)> {
        let (&pack, &used) = self.packs.last_key_value()?;
        (pack == self.newest && !self.sealed.contains(&pack)).then_some((pack, used))
    }

    /// Pack numbers are never reused: a reader may still have the older file open.
    pub(crate) fn next_number(&self) -> u32 {
        self.newest + 1
    }

    pub(crate) fn digests(&self) -> Vec<[u8; 32]> {
        self.locations.keys().map(|digest| digest.0).collect()
    }

    pub(crate) fn digests_in(&self, pack: u32) -> Vec<Digest> {
        let stored = self
            .locations
            .iter()
            .filter(|(_, location)| location.pack == pack);
        stored.map(|(digest, _)| *digest).collect()
    }

    pub(crate) fn set_aside(&self) -> u64 {
        self.set_aside
    }

    pub(crate) fn packs(&self) -> &BTreeMap<u32, PackUse> {
        &self.packs
    }
}
