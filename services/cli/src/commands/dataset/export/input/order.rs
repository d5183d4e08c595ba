//! Fetches the files of a frame with at most one request.

use std::path::Path;

use cli::exit::Failure;
use client::{Client, ImageRow, encode, with_query};
use renderer::EXTENSIONS;
use serde_json::{Map, Value};
use spec::sha256;

use crate::commands::dataset::export::files::target::{Target, read, write};
use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::input::archive::{Unpacked, unpacked};
use crate::commands::dataset::export::input::fields::typed_column;
use crate::commands::dataset::export::input::frame::{Frame, Home, ListedFile, Place, Wanted, untrusted};

/// The files to fetch of each frame, and where they are written.
pub(crate) struct Order<'a> {
    pub(crate) client: &'a Client,
    pub(crate) target: &'a Target,
    pub(crate) kinds: &'a [String],
    /// Columns of the metadata.
    pub(crate) columns: &'a [String],
    /// Labels of several types, which have a column for each type.
    pub(crate) mixed: &'a [String],
}

/// A file that is in the folder.
struct Kept {
    name: String,
    digest: String,
}

impl Order<'_> {
    /// Fetches a frame into memory: one file for each kind, in their order.
    pub(crate) fn fetch(&self, row: &ImageRow, place: &Place) -> Result<Vec<Unpacked>, Failure> {
        let wanted = self.wanted(row, place)?;
        let mut files = self.request(place, &wanted)?;
        files.sort_by_key(|file| file.index);
        let is_whole =
            files.len() == wanted.len() && files.iter().enumerate().all(|(at, file)| at == file.index);
        match is_whole {
            true => Ok(files),
            false => Err(untrusted(format!(
                "not every file of {}/{}",
                place.job, place.frame
            ))),
        }
    }

    /// Completes a frame's files in a folder of `part`, or of the root. Files with the right digest are kept.
    pub(crate) fn complete(
        &self,
        row: &ImageRow,
        place: &Place,
        part: Option<&str>,
        home: &Home,
    ) -> Result<Frame, Failure> {
        let wanted = self.wanted(row, place)?;
        let names: Vec<&str> = part
            .into_iter()
            .chain(home.folders.iter().map(String::as_str))
            .collect();
        let folder = self.target.folder(&names)?;
        let found = wanted.iter().map(|wanted| kept(&folder, home, wanted));
        let mut found = found.collect::<Result<Vec<Option<Kept>>, Failure>>()?;
        let missing: Vec<usize> = (0..wanted.len())
            .filter(|&index| found[index].is_none())
            .collect();
        if !missing.is_empty() {
            let missing: Vec<Wanted<'_>> = missing.iter().map(|&index| Wanted { ..wanted[index] }).collect();
            for file in self.request(place, &missing)? {
                let kept = Kept {
                    name: format!("{}{}", home.prefix, file.name),
                    digest: sha256(&file.bytes),
                };
                write(&folder.join(&kept.name), &file.bytes)?;
                let index = wanted
                    .iter()
                    .position(|wanted| wanted.kind == missing[file.index].kind);
                found[index.unwrap_or_default()] = Some(kept);
            }
        }
        self.listed(row, place, home, found, missing.len())
    }

    fn wanted<'a>(&'a self, row: &'a ImageRow, place: &Place) -> Result<Vec<Wanted<'a>>, Failure> {
        self.kinds
            .iter()
            .map(|kind| Wanted::read(row, place, kind))
            .collect()
    }

    fn request(&self, place: &Place, wanted: &[Wanted<'_>]) -> Result<Vec<Unpacked>, Failure> {
        let image = format!("/v1/images/{}/{}", encode(&place.job), place.frame);
        let kinds: Vec<&str> = wanted
            .iter()
            .map(|wanted| wanted.kind)
            .filter(|kind| *kind != RECORD)
            .collect();
        if let ([only], []) = (wanted, kinds.as_slice()) {
            let bytes = self.client.get_bytes(&image)?;
            return match only.is(&bytes) {
                true => Ok(vec![Unpacked {
                    index: 0,
                    name: format!("{RECORD}.json"),
                    bytes,
                }]),
                false => Err(untrusted(format!(
                    "another record than that of {}/{}",
                    place.job, place.frame
                ))),
            };
        }
        let record = (kinds.len() < wanted.len()).then_some("true");
        let parameters = [
            ("kinds", Some(kinds.join(","))),
            ("record", record.map(str::to_owned)),
        ];
        let parameters = parameters
            .each_ref()
            .map(|(name, value)| (*name, value.as_deref()));
        let archive = self
            .client
            .get_bytes(&with_query(&format!("{image}/artifacts"), &parameters))?;
        unpacked(&archive, wanted)
    }

    /// The exported columns of a row.
    pub(crate) fn values(&self, row: &ImageRow) -> Map<String, Value> {
        let columns = self.columns.iter();
        let values = columns.filter_map(|name| {
            let value = row.0.get(name)?.clone();
            let name = match self.mixed.contains(name) {
                true => typed_column(name, &value),
                false => name.clone(),
            };
            Some((name, value))
        });
        values.collect()
    }

    fn listed(
        &self,
        row: &ImageRow,
        place: &Place,
        home: &Home,
        found: Vec<Option<Kept>>,
        fetched: usize,
    ) -> Result<Frame, Failure> {
        let mut metadata = self.values(row);
        let mut files = Vec::with_capacity(found.len());
        for (index, (kind, kept)) in self.kinds.iter().zip(found).enumerate() {
            let Some(kept) = kept else {
                return Err(untrusted(format!(
                    "no artifact `{kind}` of {}/{}",
                    place.job, place.frame
                )));
            };
            let name = format!("{}/{}", home.folders.join("/"), kept.name);
            let column = if index == 0 { "file_name" } else { kind };
            // Inserted last: a column of the service must not replace the path of a file.
            metadata.insert(column.to_owned(), name.clone().into());
            files.push(ListedFile {
                kind: kind.clone(),
                digest: kept.digest,
                name,
            });
        }
        Ok(Frame {
            metadata: Value::Object(metadata),
            files,
            fetched,
        })
    }
}

/// A digest over the columns of frames and the kinds of their files.
pub(crate) fn digest_rows(values: &[Map<String, Value>], kinds: &[String]) -> String {
    let rows = values.iter().map(|row| Value::Object(row.clone()).to_string());
    let text: Vec<String> = std::iter::once(kinds.join(",")).chain(rows).collect();
    spec::sha256(text.join("\n").as_bytes())
}

/// The intact file of an earlier export.
fn kept(folder: &Path, home: &Home, wanted: &Wanted<'_>) -> Result<Option<Kept>, Failure> {
    for (_, extension) in EXTENSIONS {
        let name = format!("{}{}.{extension}", home.prefix, wanted.kind);
        if let Some(bytes) = read(&folder.join(&name))?.filter(|bytes| wanted.is(bytes)) {
            let digest = sha256(&bytes);
            return Ok(Some(Kept { name, digest }));
        }
    }
    Ok(None)
}
