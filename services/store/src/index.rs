//! Which pack holds which blob: in memory, filled from the packs at start. There is no index file that could disagree.

use std::collections::{BTreeMap, HashMap, HashSet};

use futures::TryStreamExt;
use sqlx::{Connection, Row};

use crate::digest::Digest;
use crate::error::{StoreError, is_damage};
use crate::pack::{Folder, check, forget};

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
    /// Packs that must not grow.
    sealed: HashSet<u32>,
    /// The largest number that a pack has had.
    newest: u32,
    /// Packs that could not be read at all.
    set_aside: u64,
}

impl Index {
    /// Reads every pack. Of a digest in two packs the newer counts, and the older entry is taken away: a crash between
    /// two steps, or damage, left it there. A pack that cannot be read at all is set aside, since the others are good and
    /// what it held can be made again.
    pub(crate) async fn load(folder: &Folder, packs: &[u32]) -> Result<Self, StoreError> {
        let mut index = Self::default();
        for &pack in packs {
            match index.read(folder, pack).await {
                Ok(()) => {}
                Err(StoreError::Damaged { message }) => {
                    tracing::error!(pack, message, "an artifact pack cannot be read and is set aside");
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
        let mut connection = folder.resting(pack).await?;
        check(&mut connection, &folder.path(pack)).await?;
        let mut stale: BTreeMap<u32, Vec<Digest>> = BTreeMap::new();
        self.add_pack(pack);
        {
            let mut rows = sqlx::query("SELECT digest, length FROM entry").fetch(&mut connection);
            loop {
                let row = match rows.try_next().await {
                    Ok(Some(row)) => row,
                    Ok(None) => break,
                    // What was read so far is as good as any: every blob is hashed before it is served.
                    Err(error) if is_damage(&error) => {
                        tracing::error!(pack, %error, "an artifact pack can only be read in part");
                        self.seal(pack);
                        break;
                    }
                    Err(error) => return Err(error.into()),
                };
                let length = row.try_get::<i64, _>(1)? as u64;
                if let Some(digest) = Digest::from_row(row.try_get(0)?)
                    && let Some(before) = self.insert(digest, Place { pack, length })
                {
                    stale.entry(before.pack).or_default().push(digest);
                }
            }
        }
        connection.close().await?;
        for (pack, digests) in stale {
            let mut connection = folder.resting(pack).await?;
            if let Err(error) = forget(&mut connection, &digests).await {
                tracing::warn!(pack, %error, "old entries of a pack stay");
            }
            connection.close().await?;
        }
        Ok(())
    }

    /// Where the blob can be read, damaged or not.
    pub(crate) fn place(&self, digest: &Digest) -> Option<Place> {
        self.places.get(digest).copied()
    }

    /// Returns whether the blob is stored and not known to be damaged.
    pub(crate) fn holds(&self, digest: &Digest) -> bool {
        self.places.contains_key(digest) && !self.damaged.contains(digest)
    }

    /// Records where a blob is on the disk; returns where it was before.
    pub(crate) fn insert(&mut self, digest: Digest, place: Place) -> Option<Place> {
        self.damaged.remove(&digest);
        let before = self.places.insert(digest, place);
        self.discount(before);
        let used = self.packs.entry(place.pack).or_default();
        used.blobs += 1;
        used.bytes += place.length;
        before
    }

    /// Removes a blob; returns where it was.
    pub(crate) fn remove(&mut self, digest: &Digest) -> Option<Place> {
        self.damaged.remove(digest);
        let before = self.places.remove(digest);
        self.discount(before);
        before
    }

    fn discount(&mut self, place: Option<Place>) {
        if let Some(place) = place
            && let Some(used) = self.packs.get_mut(&place.pack)
        {
            used.blobs -= 1;
            used.bytes -= place.length;
        }
    }

    /// The bytes at this place are not the blob's. Their pack must not grow: it may have more damage.
    pub(crate) fn set_damaged(&mut self, digest: Digest, place: Place) {
        if self.place(&digest) == Some(place) {
            self.damaged.insert(digest);
            self.seal(place.pack);
        }
    }

    /// What is written from now on goes to a later pack.
    pub(crate) fn seal(&mut self, pack: u32) {
        self.sealed.insert(pack);
    }

    pub(crate) fn add_pack(&mut self, pack: u32) {
        self.packs.entry(pack).or_default();
        self.newest = self.newest.max(pack);
    }

    /// Removes a pack that holds no blob; returns whether it did.
    pub(crate) fn remove_pack(&mut self, pack: u32) -> bool {
        let empty = self.packs.get(&pack).is_some_and(|used| used.blobs == 0);
        if empty {
            self.packs.remove(&pack);
            self.sealed.remove(&pack);
        }
        empty
    }

    /// The pack that grows, if the newest still does.
    pub(crate) fn growing(&self) -> Option<(u32, PackUse)> {
        let (&pack, &used) = self.packs.last_key_value()?;
        (pack == self.newest && !self.sealed.contains(&pack)).then_some((pack, used))
    }

    /// The number of the next pack. No number is used twice while a reader may still have the older file open.
    pub(crate) fn next_number(&self) -> u32 {
        self.newest + 1
    }

    pub(crate) fn digests(&self) -> Vec<[u8; 32]> {
        self.places.keys().map(|digest| digest.0).collect()
    }

    /// The blobs of a pack.
    pub(crate) fn blobs_of(&self, pack: u32) -> Vec<Digest> {
        let of = self.places.iter().filter(|(_, place)| place.pack == pack);
        of.map(|(digest, _)| *digest).collect()
    }

    pub(crate) fn set_aside(&self) -> u64 {
        self.set_aside
    }

    pub(crate) fn packs(&self) -> &BTreeMap<u32, PackUse> {
        &self.packs
    }
}
