//! Files with many frames: collected, fetched and written, or kept from an earlier export if they are intact.
//!
//! A note next to each shard (`.000000.tar.done`) has the digest of its rows, the digest of its bytes, and the places of its frames, so
//! that an existing shard needs no request.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use client::{ColumnInfo, ImageRow};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::commands::dataset::export::files::lists::{Lists, digest_of};
use crate::commands::dataset::export::files::target::{create, draft_of, read, write};
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::recordings::mcap;
use crate::commands::dataset::export::formats::{parquet, webdataset};
use crate::commands::dataset::export::input::frame::Place;
use crate::commands::dataset::export::input::member::Member;
use crate::commands::dataset::export::input::order::{Order, digest_rows};

/// Frames that are fetched concurrently and kept in memory.
const FETCHED_FRAMES: usize = 32;

/// How shards are written.
pub(crate) struct Writer<'a> {
    pub(crate) order: &'a Order<'a>,
    pub(crate) threads: &'a rayon::ThreadPool,
    pub(crate) format: Format,
    pub(crate) columns: &'a [ColumnInfo],
}

/// The shards of a part.
pub(crate) struct Shards {
    folder: PathBuf,
    /// Frames of a shard.
    size: usize,
    rows: Vec<ImageRow>,
    written: u64,
}

/// The note of a completed shard.
#[derive(Serialize, Deserialize)]
struct Note {
    /// Digest of the rows and kinds that it was made from.
    rows: String,
    /// SHA-256 of its bytes.
    sha256: String,
    /// The places of its frames for their lines of metadata.
    places: Vec<Map<String, Value>>,
}

impl Shards {
    pub(crate) fn new(folder: PathBuf, size: usize) -> Self {
        Self {
            folder,
            size,
            rows: Vec::new(),
            written: 0,
        }
    }

    /// Adds the row of a frame; returns how many files were fetched for a shard that is full by it.
    pub(crate) fn add(
        &mut self,
        writer: &Writer<'_>,
        lists: &mut Lists,
        row: ImageRow,
    ) -> Result<usize, Failure> {
        self.rows.push(row);
        match self.rows.len() < self.size {
            true => Ok(0),
            false => self.write(writer, lists),
        }
    }

    /// Writes the last shard, which may have fewer frames.
    pub(crate) fn finish(&mut self, writer: &Writer<'_>, lists: &mut Lists) -> Result<usize, Failure> {
        match self.rows.is_empty() {
            true => Ok(0),
            false => self.write(writer, lists),
        }
    }

    fn write(&mut self, writer: &Writer<'_>, lists: &mut Lists) -> Result<usize, Failure> {
        let rows = std::mem::take(&mut self.rows);
        let extension = if writer.format == Format::Parquet {
            "parquet"
        } else {
            "tar"
        };
        let name = format!("{:06}.{extension}", self.written);
        self.written += 1;
        write_shard(writer, lists, &self.folder, &name, &rows)
    }
}

/// Writes a file of these rows, or keeps it; adds the rows and its digest to the lists. Returns how many files were fetched.
pub(crate) fn write_shard(
    writer: &Writer<'_>,
    lists: &mut Lists,
    folder: &Path,
    name: &str,
    rows: &[ImageRow],
) -> Result<usize, Failure> {
    let values = rows.iter().map(|row| writer.order.values(row));
    let values: Vec<Map<String, Value>> = values.collect();
    let path = folder.join(name);
    let note_path = path.with_file_name(format!(".{name}.done"));
    let made_of = digest_rows(&values, writer.order.kinds);
    // A note of another version is as good as none: the shard is written again.
    let found: Option<Note> = read(&note_path)?.and_then(|note| serde_json::from_slice(&note).ok());
    let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
    let found = found.filter(|note| is_file && note.rows == made_of && note.places.len() == rows.len());
    let kept = match found {
        Some(note) if digest_of(&path)? == note.sha256 => Some(note),
        _ => None,
    };
    let fetched = if kept.is_some() {
        0
    } else {
        rows.len() * writer.order.kinds.len()
    };
    let note = match kept {
        Some(note) => note,
        None => {
            let draft = draft_of(&path);
            let file = create(&draft).with_context(|| format!("cannot write {}", path.display()))?;
            let places = writer.write(name, file, rows)?;
            let sha256 = digest_of(&draft)?;
            fs::rename(&draft, &path).with_context(|| format!("cannot write {}", path.display()))?;
            let note = Note {
                rows: made_of,
                sha256,
                places,
            };
            write(
                &note_path,
                serde_json::to_string(&note).context("a note is JSON")?.as_bytes(),
            )?;
            note
        }
    };
    for (mut line, place) in values.into_iter().zip(note.places) {
        // Inserted last: a column of the service must not replace the place of a file.
        line.extend(place);
        lists.add(&Value::Object(line))?;
    }
    let below = folder.file_name().filter(|name| *name == parquet::FOLDER);
    let above = below.map_or_else(String::new, |below| format!("{}/", below.display()));
    lists.add_sum(&note.sha256, &format!("{above}{name}"))?;
    Ok(fetched)
}

impl Writer<'_> {
    /// Fetches frames and writes them into a file.
    fn write(&self, name: &str, file: File, rows: &[ImageRow]) -> Result<Vec<Map<String, Value>>, Failure> {
        let mut chunks = rows.chunks(FETCHED_FRAMES);
        let mut pull = || {
            let chunk = chunks.next().unwrap_or_default();
            self.threads.install(|| {
                let members = chunk.par_iter().map(|row| {
                    let place = Place::read(row)?;
                    Ok(Member {
                        values: self.order.values(row),
                        files: self.order.fetch(row, &place)?,
                        place,
                    })
                });
                members.collect()
            })
        };
        match self.format {
            Format::Parquet => {
                parquet::write(file, self.columns, self.order.kinds, &mut pull)?;
                Ok(vec![parquet::place(name); rows.len()])
            }
            Format::Mcap => mcap::write(name, file, self.order.kinds, &mut pull),
            _ => webdataset::write(name, file, self.order.kinds, &mut pull),
        }
    }
}
