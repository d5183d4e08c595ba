//! Reads the images of a completed shard for a catalogue. The content of the store is not trusted: marker, rows and tar must agree
//! with each other and with the job.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::data_type::ByteArray;
use parquet::file::reader::{FileReader, SerializedFileReader};
use spec::{ArtifactEntry, RecordText, sha256};

use crate::error::SetError;
use crate::rows::group::{Group, Named};
use crate::set::marker::Marker;
use crate::set::opened::Set;
use crate::storage::layout;

/// Longest artifact: the limit of the service for a frame.
const MOST_ARTIFACT_BYTES: u64 = 512 << 20;
/// Images that stay in memory between the check and the use; those of longer shards are read twice.
const KEPT_IMAGES: u64 = 5000;
/// Bytes of records that stay in memory between the check and the use.
const KEPT_BYTES: usize = 64 << 20;
/// 9999-12-31: later times have no usual form.
const LAST_MS: i64 = 253_402_300_799_999;

/// A shard that is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DoneShard {
    /// Its number.
    pub shard: u64,
    /// When its marker was written, by the store's clock.
    pub changed_ms: i64,
}

/// An image of a shard.
#[derive(Debug, Clone)]
pub struct ShardImage {
    /// Everything known about it.
    pub record: RecordText,
    /// When it was rendered, by the clock of its machine.
    pub created_ms: u64,
    /// Where its artifacts begin in the tar, by kind.
    pub offsets: BTreeMap<String, u64>,
}

/// A shard whose rows agree with its marker.
pub struct ShardRows {
    /// The marker.
    pub marker: Marker,
    /// The first frame of the shard.
    pub first_frame: u64,
    rows: Option<Bytes>,
    kept: Vec<Vec<ShardImage>>,
}

impl Set {
    /// The shards that are done, by number, from the listing alone.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn done_shards(&self) -> Result<Vec<DoneShard>, SetError> {
        let mut done = Vec::new();
        for entry in self.store.list(layout::DONE)? {
            if let Some(shard) = layout::shard_of(&entry.name) {
                if shard >= self.card().shards() || entry.name != layout::done(shard) {
                    return Err(SetError::Damaged(format!(
                        "{} belongs to no shard of the job, which has {}",
                        entry.name,
                        self.card().shards()
                    )));
                }
                done.push(DoneShard {
                    shard,
                    changed_ms: entry.modified_ms,
                });
            }
        }
        done.sort_unstable_by_key(|done| done.shard);
        Ok(done)
    }

    /// Reads a shard that is done and compares its parts.
    ///
    /// # Errors
    /// [`SetError::Damaged`] if they contradict each other or the job; otherwise [`SetError`] of the store.
    pub fn shard_rows(&self, shard: u64) -> Result<ShardRows, SetError> {
        let marker = self.marker(shard)?;
        let marker = marker.ok_or_else(|| SetError::Damaged(format!("shard {shard} has no marker")))?;
        self.check_marker(shard, &marker)?;
        self.check_length(&marker.tar_name(), marker.tar.bytes)?;
        let rows = self.rows_file(&marker)?;
        let name = marker.rows_name();
        // The decoder of Parquet panics on some malformed files.
        let checked = catch_unwind(AssertUnwindSafe(|| self.check_rows(&marker, &rows)));
        let kept = checked.unwrap_or_else(|_| Err(SetError::unreadable(&name, "it is no Parquet file")))?;
        Ok(ShardRows {
            first_frame: self.card().frames_of(shard).start,
            rows: kept.is_empty().then_some(rows),
            marker,
            kept,
        })
    }

    fn check_marker(&self, shard: u64, marker: &Marker) -> Result<(), SetError> {
        let name = layout::done(shard);
        let attempt = &marker.attempt;
        if marker.shard != shard {
            return Err(SetError::damaged(
                &name,
                format!("it is of shard {}", marker.shard),
            ));
        }
        // It becomes part of names, so only letters and digits are accepted.
        if !(1..=64).contains(&attempt.len()) || !attempt.bytes().all(|byte| byte.is_ascii_alphanumeric()) {
            return Err(SetError::damaged(&name, format!("`{attempt}` is no attempt")));
        }
        let frames = self.card().frames_of(shard);
        let all = frames.end - frames.start;
        if marker.images.checked_add(marker.failed.len() as u64) != Some(all) {
            return Err(SetError::damaged(
                &name,
                format!(
                    "{} images and {} failed frames are not the {all} frames of the shard",
                    marker.images,
                    marker.failed.len()
                ),
            ));
        }
        let in_order = marker.failed.windows(2).all(|pair| pair[0].frame < pair[1].frame);
        let outside = marker
            .failed
            .iter()
            .find(|failed| !frames.contains(&failed.frame));
        match outside {
            Some(failed) => Err(SetError::damaged(
                &name,
                format!("failed frame {} is not within {frames:?}", failed.frame),
            )),
            None if !in_order => Err(SetError::damaged(&name, "failed frames are out of order")),
            None => Ok(()),
        }
    }

    fn check_length(&self, name: &str, bytes: u64) -> Result<(), SetError> {
        match self.store.entry(name)? {
            None => Err(SetError::Damaged(format!("{name} is gone"))),
            Some(entry) if entry.bytes != bytes => Err(SetError::Damaged(format!(
                "{name} has {} bytes, its marker says {bytes}",
                entry.bytes
            ))),
            Some(_) => Ok(()),
        }
    }

    fn rows_file(&self, marker: &Marker) -> Result<Bytes, SetError> {
        let (name, sum) = (marker.rows_name(), &marker.rows);
        self.check_length(&name, sum.bytes)?;
        let rows = self.store.get(&name)?;
        let rows = rows.ok_or_else(|| SetError::Damaged(format!("{name} is gone")))?;
        let found = sha256(&rows);
        if found != sum.sha256 {
            return Err(SetError::Damaged(format!(
                "{name} has SHA-256 {found}, its marker says {}",
                sum.sha256
            )));
        }
        Ok(rows.into())
    }

    /// Reads all rows; returns them group by group unless they are too many to be kept.
    fn check_rows(&self, marker: &Marker, rows: &Bytes) -> Result<Vec<Vec<ShardImage>>, SetError> {
        let name = marker.rows_name();
        let frames = self.card().frames_of(marker.shard);
        let reader = open(&name, rows)?;
        let count: i64 = reader.metadata().row_groups().iter().map(|g| g.num_rows()).sum();
        if u64::try_from(count) != Ok(marker.images) {
            return Err(SetError::damaged(
                &name,
                format!("{count} rows, its marker says {}", marker.images),
            ));
        }
        let (mut kept, mut digests, mut next) = (Vec::new(), Vec::new(), frames.start);
        let mut bytes = 0;
        for number in 0..reader.num_row_groups() {
            let images = images(&name, &reader, number, &marker.tar_name())?;
            for image in &images {
                let frame = image.record.record().frame;
                if frame < next || frame >= frames.end {
                    return Err(SetError::damaged(
                        &name,
                        format!("frame {frame} is not within {next}..{}", frames.end),
                    ));
                }
                next = frame + 1;
                if marker
                    .failed
                    .binary_search_by_key(&frame, |failed| failed.frame)
                    .is_ok()
                {
                    return Err(SetError::damaged(
                        &name,
                        format!("frame {frame} has an image and is listed as failed"),
                    ));
                }
                image
                    .check(marker.tar.bytes)
                    .map_err(|reason| SetError::damaged(&name, format!("frame {frame}: {reason}")))?;
                digests.push(image.record.digest().to_owned());
            }
            bytes += images
                .iter()
                .map(|image| image.record.as_str().len())
                .sum::<usize>();
            if marker.images <= KEPT_IMAGES && bytes <= KEPT_BYTES {
                kept.push(images);
            } else {
                kept.clear();
            }
        }
        let digest = spec::job_digest(digests.iter().map(String::as_str));
        if digest != marker.digest {
            return Err(SetError::damaged(
                &name,
                format!(
                    "its images have the digest {digest}, its marker says {}",
                    marker.digest
                ),
            ));
        }
        Ok(kept)
    }
}

impl ShardRows {
    /// The images in the order of their frames, group by group.
    pub fn groups(self) -> impl Iterator<Item = Result<Vec<ShardImage>, SetError>> {
        let Self {
            marker, rows, kept, ..
        } = self;
        let again = rows.map(move |rows| {
            let (name, tar) = (marker.rows_name(), marker.tar_name());
            let reader = open(&name, &rows);
            let groups = reader.as_ref().map_or(1, FileReader::num_row_groups);
            (0..groups).map(move |number| match &reader {
                Ok(reader) => images(&name, reader, number, &tar),
                Err(error) => Err(SetError::Damaged(error.to_string())),
            })
        });
        kept.into_iter().map(Ok).chain(again.into_iter().flatten())
    }
}

impl ShardImage {
    /// Rejects malformed artifacts and positions outside of the tar.
    fn check(&self, tar_bytes: u64) -> Result<(), String> {
        let artifacts = &self.record.record().artifacts;
        for artifact in artifacts {
            artifact.check()?;
            let ArtifactEntry { kind, bytes, .. } = artifact;
            if *bytes > MOST_ARTIFACT_BYTES {
                return Err(format!(
                    "artifact `{kind}` has {bytes} bytes; must be at most {MOST_ARTIFACT_BYTES}"
                ));
            }
            let Some(offset) = self.offsets.get(kind) else {
                return Err(format!("artifact `{kind}` has no place in the tar"));
            };
            if offset.checked_add(*bytes).is_none_or(|end| end > tar_bytes) {
                return Err(format!(
                    "artifact `{kind}` with {bytes} bytes at {offset} is not within its tar of {tar_bytes} bytes"
                ));
            }
        }
        let mut kinds: Vec<&str> = artifacts.iter().map(|a| a.kind.as_str()).collect();
        kinds.sort_unstable();
        match kinds.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("artifact `{}` is there twice", pair[0])),
            None => Ok(()),
        }
    }
}

fn open(name: &str, rows: &Bytes) -> Result<SerializedFileReader<Bytes>, SetError> {
    SerializedFileReader::new(rows.clone()).map_err(|error| SetError::unreadable(name, error))
}

/// The images of one group of rows.
fn images(
    name: &str,
    reader: &SerializedFileReader<Bytes>,
    number: usize,
    tar: &str,
) -> Result<Vec<ShardImage>, SetError> {
    let unreadable = |error: String| SetError::unreadable(name, error);
    let group = Group::open(reader, number).map_err(unreadable)?;
    read_images(&group, tar).map_err(unreadable)
}

fn read_images(group: &Group, tar: &str) -> Result<Vec<ShardImage>, String> {
    let (frames, times) = (group.numbers("frame")?, group.numbers("created_ms")?);
    let (tars, records) = (group.texts("tar")?, group.texts("record")?);
    let places = group.numbers_within("artifacts.", ".offset")?;
    let mut images = Vec::with_capacity(group.rows);
    for row in 0..group.rows {
        let text = records[row]
            .as_ref()
            .ok_or_else(|| format!("row {row} has no record"))?;
        let record =
            read_record(text).map_err(|error| format!("the record of row {row} cannot be read: {error}"))?;
        let frame = frames[row].ok_or_else(|| format!("row {row} has no frame"))?;
        let of_record = record.record().frame;
        if u64::try_from(frame) != Ok(of_record) {
            return Err(format!(
                "row {row} is of frame {frame}, its record of frame {of_record}"
            ));
        }
        if tars[row]
            .as_ref()
            .is_none_or(|found| found.data() != tar.as_bytes())
        {
            return Err(format!("row {row} names another tar than {tar}"));
        }
        let created_ms = times[row].filter(|time| (0..=LAST_MS).contains(time));
        let created_ms =
            created_ms.ok_or_else(|| format!("row {row} has no created_ms that is a time"))? as u64;
        let offsets = places.iter().filter_map(|(kind, offsets): &Named| {
            let offset = u64::try_from(offsets[row]?).ok()?;
            Some((kind.clone(), offset))
        });
        images.push(ShardImage {
            record,
            created_ms,
            offsets: offsets.collect(),
        });
    }
    Ok(images)
}

fn read_record(text: &ByteArray) -> Result<RecordText, String> {
    let text = text.as_utf8().map_err(|error| error.to_string())?;
    RecordText::read(text.to_owned()).map_err(|error| error.to_string())
}
