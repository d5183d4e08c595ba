//! One frame of an export: its files, fetched with one request at most, and its line of metadata.

use std::io::Read;
use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::known::is_job_id;
use cli::remote::{Remote, encode, with_query};
use renderer::EXTENSIONS;
use serde_json::{Map, Value};
use spec::sha256;

use super::target::{Target, read, write};

/// A frame whose files are in the folder.
pub(super) struct Frame {
    pub(super) metadata: Value,
    pub(super) files: Vec<ListedFile>,
    /// Files that came from the service.
    pub(super) fetched: usize,
}

/// A file by its path below the folder that holds the lists.
pub(super) struct ListedFile {
    pub(super) digest: String,
    pub(super) name: String,
}

/// What to fetch of each frame, and where it goes.
pub(super) struct Order<'a> {
    pub(super) remote: &'a Remote,
    pub(super) target: &'a Target,
    pub(super) kinds: &'a [String],
    /// Columns of the metadata.
    pub(super) columns: &'a [String],
}

/// Job and frame of a row, in the form in which they may be names of folders.
pub(super) struct Place {
    job: String,
    frame: u64,
}

impl Place {
    fn of(row: &Value) -> Result<Self, Failure> {
        let job = row["job"].as_str().filter(|id| is_job_id(id));
        match (job, row["frame"].as_u64()) {
            (Some(job), Some(frame)) => Ok(Self {
                job: job.to_owned(),
                frame,
            }),
            _ => Err(untrusted(format!(
                "an image of job {} and frame {}",
                row["job"], row["frame"]
            ))),
        }
    }
}

/// An artifact to fetch or to keep.
struct Wanted<'a> {
    kind: &'a str,
    digest: &'a str,
}

impl Order<'_> {
    /// Brings a frame's files into the folder `part`, or into the root. Files that are there with the right digest are kept.
    pub(super) fn carry_out(&self, row: &Value, part: Option<&str>) -> Result<Frame, Failure> {
        let place = Place::of(row)?;
        let wanted = self.kinds.iter().map(|kind| wanted(row, &place, kind));
        let wanted = wanted.collect::<Result<Vec<_>, _>>()?;
        let number = place.frame.to_string();
        let names: Vec<&str> = part.into_iter().chain([place.job.as_str(), &number]).collect();
        let folder = self.target.folder(&names)?;
        let mut paths: Vec<Option<PathBuf>> = wanted.iter().map(|wanted| kept(&folder, wanted)).collect();
        let missing: Vec<usize> = (0..wanted.len())
            .filter(|&index| paths[index].is_none())
            .collect();
        if !missing.is_empty() {
            let kinds: Vec<&str> = missing.iter().map(|&index| wanted[index].kind).collect();
            let path = format!("/v1/images/{}/{}/artifacts", encode(&place.job), place.frame);
            let archive = self
                .remote
                .get_bytes(&with_query(&path, &[("kinds", Some(&kinds.join(",")))]))?;
            for file in unpacked(&archive, &wanted)? {
                let path = folder.join(&file.name);
                write(&path, &file.bytes)?;
                paths[file.index] = Some(path);
            }
        }
        self.listed(row, &place, &wanted, &paths, missing.len())
    }

    fn listed(
        &self,
        row: &Value,
        place: &Place,
        wanted: &[Wanted<'_>],
        paths: &[Option<PathBuf>],
        fetched: usize,
    ) -> Result<Frame, Failure> {
        let columns = self
            .columns
            .iter()
            .filter_map(|name| Some((name.clone(), row.get(name)?.clone())));
        let mut metadata: Map<String, Value> = columns.collect();
        let mut files = Vec::with_capacity(wanted.len());
        for (index, (wanted, path)) in wanted.iter().zip(paths).enumerate() {
            let Some(name) = path.as_ref().and_then(|path| path.file_name()) else {
                return Err(untrusted(format!(
                    "no artifact `{}` of {}/{}",
                    wanted.kind, place.job, place.frame
                )));
            };
            let name = format!("{}/{}/{}", place.job, place.frame, name.to_string_lossy());
            let column = if index == 0 { "file_name" } else { wanted.kind };
            // Ours come last: no column of the service may say where a file is.
            metadata.insert(column.to_owned(), name.clone().into());
            files.push(ListedFile {
                digest: wanted.digest.to_owned(),
                name,
            });
        }
        let metadata = Value::Object(metadata);
        Ok(Frame {
            metadata,
            files,
            fetched,
        })
    }
}

fn wanted<'a>(row: &'a Value, place: &Place, kind: &'a str) -> Result<Wanted<'a>, Failure> {
    let Place { job, frame } = place;
    let is_digest = |digest: &&str| digest.len() == 64 && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
    match &row[format!("artifacts.{kind}")] {
        Value::Null => Err(Failure::BadInput(format!(
            "image {job}/{frame} has no artifact `{kind}`; leave it out of --kinds, or such images out with --filter"
        ))),
        digest => match digest.as_str().filter(is_digest) {
            Some(digest) => Ok(Wanted { kind, digest }),
            None => Err(untrusted(format!(
                "{digest} as the digest of {kind} of {job}/{frame}"
            ))),
        },
    }
}

/// The file of an artifact that an earlier export left, if it is whole.
fn kept(folder: &Path, wanted: &Wanted<'_>) -> Option<PathBuf> {
    let mut paths = EXTENSIONS
        .iter()
        .map(|(_, extension)| folder.join(format!("{}.{extension}", wanted.kind)));
    paths.find(|path| read(path).is_some_and(|bytes| sha256(&bytes) == wanted.digest))
}

/// A file of an archive.
struct Unpacked {
    /// Which of those wanted.
    index: usize,
    name: String,
    bytes: Vec<u8>,
}

/// The files of an archive, each with a name that was asked for and bytes of its digest.
fn unpacked(archive: &[u8], wanted: &[Wanted<'_>]) -> Result<Vec<Unpacked>, Failure> {
    let damaged = |error: std::io::Error| untrusted(format!("a damaged archive: {error}"));
    let mut archive = tar::Archive::new(archive);
    let mut files = Vec::new();
    for entry in archive.entries().map_err(damaged)? {
        let mut entry = entry.map_err(damaged)?;
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        let is_name_of = |wanted: &Wanted<'_>| {
            let mut extensions = EXTENSIONS.iter();
            extensions.any(|(_, extension)| name == format!("{}.{extension}", wanted.kind))
        };
        let index = wanted.iter().position(is_name_of);
        let Some(index) = index.filter(|_| entry.header().entry_type().is_file()) else {
            return Err(untrusted(format!("a file {name:?} that was not asked for")));
        };
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(damaged)?;
        if sha256(&bytes) != wanted[index].digest {
            return Err(untrusted(format!(
                "{name} with another digest than {}",
                wanted[index].digest
            )));
        }
        files.push(Unpacked { index, name, bytes });
    }
    Ok(files)
}

/// What a service sends that cannot be true.
fn untrusted(what: String) -> Failure {
    anyhow::anyhow!("the service sent {what}; nothing of it was written").into()
}
