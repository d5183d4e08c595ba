//! Compares stored frames of a set with the same frames rendered again.

use std::collections::BTreeMap;

use spec::{Agreement, FrameRecord, compare_records, describe_differences, sha256};

use crate::error::SetError;
use crate::processes::crew::Crew;
use crate::processes::open::Finished;
use crate::rows::reading::ShardImage;
use crate::set::opened::Set;

/// The tar of a shard, and some of its images by frame.
struct StoredImages {
    tar: String,
    by_frame: BTreeMap<u64, ShardImage>,
}

impl Set {
    /// Renders frames of a completed shard again and compares their whole records, and the stored bytes of their artifacts.
    /// Returns the differences, at most one for each frame.
    ///
    /// # Errors
    /// [`SetError`] of the store and of this machine.
    pub fn verify_by_rendering(
        &self,
        shard: u64,
        frames: &[u64],
        crew: &mut Crew,
    ) -> Result<Vec<String>, SetError> {
        let stored = match self.read_images(shard, frames) {
            Ok(stored) => stored,
            Err(SetError::Damaged(reason)) => return Ok(vec![reason]),
            Err(error) => return Err(error),
        };
        let mut differences = Vec::new();
        for &frame in frames {
            let rendered = render(frame, crew)?;
            let difference = match (stored.by_frame.get(&frame), rendered) {
                (Some(image), Ok(again)) => match compare(image, &again) {
                    None => self.find_wrong_artifact(&stored.tar, image)?,
                    different => different,
                },
                (Some(_), Err(reason)) => Some(format!("it has an image, but fails now: {reason}")),
                (None, Ok(_)) => Some("it is listed as failed, but renders now".to_owned()),
                (None, Err(_)) => None,
            };
            differences.extend(difference.map(|difference| format!("frame {frame}: {difference}")));
        }
        Ok(differences)
    }

    fn read_images(&self, shard: u64, frames: &[u64]) -> Result<StoredImages, SetError> {
        let rows = self.shard_rows(shard)?;
        let tar = rows.marker.tar_name();
        let mut by_frame = BTreeMap::new();
        for group in rows.groups() {
            for image in group? {
                let frame = image.record.record().frame;
                if frames.contains(&frame) {
                    by_frame.insert(frame, image);
                }
            }
        }
        Ok(StoredImages { tar, by_frame })
    }

    /// The first artifact whose bytes in the tar are not those of its record.
    fn find_wrong_artifact(&self, tar: &str, image: &ShardImage) -> Result<Option<String>, SetError> {
        for entry in &image.record.record().artifacts {
            let offset = image.offsets.get(&entry.kind).copied().unwrap_or_default();
            let found = sha256(&self.store.range(tar, offset..offset + entry.bytes)?);
            if found != entry.digest {
                let (kind, digest) = (&entry.kind, &entry.digest);
                return Ok(Some(format!(
                    "`{kind}` in {tar} has SHA-256 {found}, its record says {digest}"
                )));
            }
        }
        Ok(None)
    }
}

/// The record of a frame rendered again, or why it has none.
fn render(frame: u64, crew: &mut Crew) -> Result<Result<FrameRecord, String>, SetError> {
    let mut rendered = Err("it was not rendered".to_owned());
    crew.render(frame..frame + 1, &|| Ok(()), |_, finished| {
        rendered = match finished {
            Finished::Failed(reason) => Err(reason),
            Finished::Image { record, .. } => Ok(serde_json::from_slice(&record)
                .map_err(|error| SetError::Machine(format!("a record cannot be read: {error}")))?),
        };
        Ok(())
    })?;
    Ok(rendered)
}

/// The first difference between a stored record and that of the frame rendered again, with changes of the program or
/// machine that can explain it.
fn compare(image: &ShardImage, again: &FrameRecord) -> Option<String> {
    let stored: FrameRecord = match serde_json::from_str(image.record.as_str()) {
        Ok(stored) => stored,
        Err(error) => return Some(format!("its record cannot be read: {error}")),
    };
    let difference = describe_differences(&compare_records(again, &stored, Agreement::Exact))?;
    let changes = stored.provenance.describe_changes(&again.provenance);
    Some([vec![difference], changes].concat().join("; "))
}
