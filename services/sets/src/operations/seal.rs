//! The manifest: the content of a complete set under one digest.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use spec::MerkleTree;

use crate::error::SetError;
use crate::set::marker::Marker;
use crate::set::opened::Set;
use crate::storage::layout;

/// Something that went into the frames, with its terms.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Such as `water jerlov-3C` or `style muddy`.
    pub name: String,
    /// Where its numbers are from.
    pub source: String,
    /// Under which license.
    pub licence: String,
}

/// The content of `manifest.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the dataset.
    pub dataset: String,
    /// SHA-256 of the job's canonical text.
    pub job: String,
    /// Digest over all images, as `fathom render` and a service compute it.
    pub digest: String,
    /// Root of the Merkle tree over the markers.
    pub root: String,
    /// Number of shards.
    pub shards: u64,
    /// Number of images.
    pub images: u64,
    /// Frames without an image.
    pub failed: u64,
    /// Length of all files.
    pub bytes: u64,
    /// Version of the program.
    pub code_version: String,
    /// Waters and styles with their terms.
    pub sources: Vec<Source>,
}

impl Set {
    /// Writes the manifest of a complete set, and returns it.
    ///
    /// # Errors
    /// [`SetError::Refused`] if shards are missing; [`SetError::Damaged`] if a file of a marker is missing or truncated, or if contents
    /// changed since sealing; otherwise [`SetError`] of the store.
    pub fn seal(&self, sources: Vec<Source>) -> Result<Manifest, SetError> {
        let card = self.card();
        let markers = self.markers(self.done()?)?;
        if markers.len() as u64 != card.shards() {
            return Err(SetError::Refused(format!(
                "{} of {} shards are done: render the others before the set is sealed",
                markers.len(),
                card.shards()
            )));
        }
        self.check_files(&markers)?;
        let sum = |value: fn(&Marker) -> u64| markers.iter().map(value).sum();
        let manifest = Manifest {
            dataset: card.dataset(),
            job: card.digest.clone(),
            digest: self.digest()?,
            root: root(&markers)?,
            shards: card.shards(),
            images: sum(|marker| marker.images),
            failed: sum(|marker| marker.failed.len() as u64),
            bytes: sum(|marker| marker.tar.bytes + marker.rows.bytes),
            code_version: card.code_version.clone(),
            sources,
        };
        let text = serde_json::to_vec_pretty(&manifest)
            .map_err(|error| SetError::Machine(format!("the manifest cannot be written: {error}")))?;
        match self.store.create(layout::MANIFEST, &text)? {
            None => Ok(manifest),
            Some(_) => Err(SetError::Damaged(format!(
                "{} was sealed with another content than it has now",
                self.location()
            ))),
        }
    }

    /// Compares the listing with the markers; `verify` reads the files.
    fn check_files(&self, markers: &[Marker]) -> Result<(), SetError> {
        let listed = self.files()?.into_iter();
        let lengths: BTreeMap<String, u64> = listed.map(|entry| (entry.name, entry.bytes)).collect();
        for marker in markers {
            for (name, sum) in [
                (marker.tar_name(), &marker.tar),
                (marker.rows_name(), &marker.rows),
            ] {
                if let Some(damage) = sum.contradiction(&name, lengths.get(&name).copied()) {
                    return Err(SetError::Damaged(damage));
                }
            }
        }
        Ok(())
    }
}

/// Root of the Merkle tree over the markers in the order of their shards.
fn root(markers: &[Marker]) -> Result<String, SetError> {
    let mut tree = MerkleTree::default();
    for marker in markers {
        let text = serde_json::to_vec(marker);
        tree.push(text.map_err(|error| SetError::Machine(format!("a marker cannot be written: {error}")))?);
    }
    Ok(tree.root())
}
