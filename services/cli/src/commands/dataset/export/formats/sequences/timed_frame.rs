//! The files of a frame in the layout of a benchmark: written, or kept from an earlier export if they are intact.
//!
//! A note next to them (`.STEM.done`) has the digest of the row and that of each file, so that an existing frame needs no request.

use anyhow::Context;
use cli::exit::Failure;
use client::ImageRow;
use imaging::codec::{decode_picture, encode_png};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use spec::sha256;

use crate::commands::dataset::export::files::target::{read, write};
use crate::commands::dataset::export::format::{Format, RECORD};
use crate::commands::dataset::export::formats::sequences::depth::{DepthPicture, read_z_depth};
use crate::commands::dataset::export::formats::sequences::layout::{
    SequencePlace, depth_codes_per_m, kind_folder, needs_png, sequence_folder, stem,
};
use crate::commands::dataset::export::formats::view::View;
use crate::commands::dataset::export::input::archive::Unpacked;
use crate::commands::dataset::export::input::frame::{Frame, ListedFile, Place, untrusted};
use crate::commands::dataset::export::input::order::Order;
use crate::commands::dataset::export::input::order::digest_rows;
use crate::commands::dataset::export::role::Role;

/// A frame of a sequence.
pub(crate) struct TimedFrame {
    pub(crate) stamp_ns: u64,
    pub(crate) view: View,
    /// Kind and path below the sequence of each file.
    pub(crate) files: Vec<(String, String)>,
    /// Pixels whose depth exceeds the largest code.
    pub(crate) far_pixels: u64,
}

/// The note of a completed frame.
#[derive(Serialize, Deserialize)]
struct Note {
    /// Digest of the row, the kinds and the names.
    rows: String,
    view: View,
    far_pixels: u64,
    files: Vec<NotedFile>,
}

#[derive(Serialize, Deserialize)]
struct NotedFile {
    kind: String,
    /// Path below the sequence.
    path: String,
    sha256: String,
}

/// A frame to write.
pub(crate) struct FrameOrder<'a> {
    pub(crate) order: &'a Order<'a>,
    pub(crate) format: Format,
    pub(crate) part: Option<&'a str>,
    pub(crate) row: &'a ImageRow,
    pub(crate) place: &'a Place,
    pub(crate) spot: &'a SequencePlace,
}

impl FrameOrder<'_> {
    /// Completes the files of the frame.
    pub(crate) fn complete(&self) -> Result<(Frame, TimedFrame), Failure> {
        let values = self.order.values(self.row);
        let stem = stem(self.format, self.spot);
        let made_of = digest_rows(std::slice::from_ref(&values), self.order.kinds);
        let made_of = sha256(format!("{made_of} {} {stem}", self.format.name()));
        let above = sequence_folder(self.format, &self.spot.sequence, self.spot.number);
        let note_path = self.folder(&above, &[])?.join(format!(".{stem}.done"));
        let found: Option<Note> = read(&note_path)?.and_then(|note| serde_json::from_slice(&note).ok());
        let kept = match found {
            Some(note) if note.rows == made_of && self.is_intact(&above, &note)? => Some(note),
            _ => None,
        };
        let fetched = match kept {
            Some(_) => 0,
            None => self.order.kinds.len(),
        };
        let note = match kept {
            Some(note) => note,
            None => {
                let note = self.write(&above, &stem, made_of)?;
                let text = serde_json::to_string(&note).context("a note is JSON")?;
                write(&note_path, text.as_bytes())?;
                note
            }
        };
        Ok(self.describe(values, &above.join("/"), note, fetched))
    }

    fn folder(&self, above: &[String], below: &[String]) -> Result<std::path::PathBuf, Failure> {
        let names = self
            .part
            .into_iter()
            .chain(above.iter().chain(below).map(String::as_str));
        self.order.target.folder(&names.collect::<Vec<_>>())
    }

    fn is_intact(&self, above: &[String], note: &Note) -> Result<bool, Failure> {
        for file in &note.files {
            let mut folders: Vec<String> = file.path.split('/').map(str::to_owned).collect();
            let name = folders.pop().unwrap_or_default();
            let bytes = read(&self.folder(above, &folders)?.join(name))?;
            if bytes.is_none_or(|bytes| sha256(bytes) != file.sha256) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Fetches the frame and writes its files.
    fn write(&self, above: &[String], stem: &str, rows: String) -> Result<Note, Failure> {
        let Place { job, frame } = self.place;
        let fetched = self.order.fetch(self.row, self.place)?;
        let kinds = self.order.kinds.iter().zip(&fetched);
        let record = kinds.clone().find(|(kind, _)| *kind == RECORD);
        let record = record.map_or(&[][..], |(_, file)| &file.bytes);
        let mut note = Note {
            rows,
            view: View::parse(&format!("the record of {job}/{frame}"), record)?,
            far_pixels: 0,
            files: Vec::new(),
        };
        for (index, (kind, file)) in kinds.enumerate().filter(|(_, (kind, _))| *kind != RECORD) {
            let converted = self.convert(kind, file, &mut note);
            let (extension, bytes) =
                converted.map_err(|why| untrusted(format!("`{kind}` of {job}/{frame}: {why}")))?;
            let folders = kind_folder(self.format, kind, index == 0);
            let name = format!("{stem}.{extension}");
            write(&self.folder(above, &folders)?.join(&name), &bytes)?;
            note.files.push(NotedFile {
                kind: kind.clone(),
                path: format!("{}/{name}", folders.join("/")),
                sha256: sha256(&bytes),
            });
        }
        Ok(note)
    }

    /// Extension and bytes of a file in the format.
    fn convert(&self, kind: &str, file: &Unpacked, note: &mut Note) -> Result<(String, Vec<u8>), String> {
        let extension = file.name.rsplit('.').next().unwrap_or_default();
        match Role::of_checked(kind) {
            Role::Depth => {
                let depth = read_z_depth(&file.bytes, &note.view)?;
                let picture = DepthPicture::encode(&depth, depth_codes_per_m(self.format))?;
                note.far_pixels += picture.far_pixels;
                Ok(("png".to_owned(), picture.png))
            }
            Role::Picture | Role::RightPicture if needs_png(self.format) && extension != "png" => {
                let picture = decode_picture(&file.bytes).map_err(|error| error.to_string())?;
                let png = encode_png(&picture).map_err(|error| error.to_string())?;
                Ok(("png".to_owned(), png))
            }
            _ => Ok((extension.to_owned(), file.bytes.clone())),
        }
    }

    fn describe(
        &self,
        mut metadata: Map<String, Value>,
        above: &str,
        note: Note,
        fetched: usize,
    ) -> (Frame, TimedFrame) {
        let files = note.files.iter().map(|file| ListedFile {
            kind: file.kind.clone(),
            digest: file.sha256.clone(),
            name: format!("{above}/{}", file.path),
        });
        let files: Vec<ListedFile> = files.collect();
        // Inserted last: a column of the service must not replace the path of a file.
        if let Some(first) = files.first() {
            metadata.insert("file_name".to_owned(), first.name.clone().into());
        }
        let stored = files
            .iter()
            .filter(|file| Role::of_checked(&file.kind) != Role::Depth);
        let paths: Map<String, Value> = stored
            .map(|file| (file.kind.clone(), Value::from(file.name.clone())))
            .collect();
        metadata.insert("files".to_owned(), paths.into());
        let frame = Frame {
            metadata: Value::Object(metadata),
            files,
            fetched,
        };
        let timed = TimedFrame {
            stamp_ns: self.spot.stamp_ns,
            view: note.view,
            files: note
                .files
                .into_iter()
                .map(|file| (file.kind, file.path))
                .collect(),
            far_pixels: note.far_pixels,
        };
        (frame, timed)
    }
}
