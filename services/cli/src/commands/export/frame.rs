//! One frame of an export: its files, fetched with one request at most, and its line of metadata.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::known::is_job_id;
use cli::remote::{Remote, encode, with_query};
use renderer::EXTENSIONS;
use serde_json::{Map, Value};
use spec::{FrameRecord, sha256};

use super::archive::{Unpacked, unpacked};
use super::target::{Target, read, write};

/// The name of a frame's record among its kinds. No artifact is called so.
pub(super) const RECORD: &str = "record";

/// A frame whose files are in the folder.
pub(super) struct Frame {
    pub(super) metadata: Value,
    pub(super) files: Vec<ListedFile>,
    /// Files that came from the service.
    pub(super) fetched: usize,
}

/// A file by its path below the folder that holds the lists.
pub(super) struct ListedFile {
    pub(super) kind: String,
    pub(super) digest: String,
    pub(super) name: String,
}

impl Frame {
    /// The file of a kind that was wanted.
    pub(super) fn file(&self, kind: &str) -> &str {
        let file = self.files.iter().find(|file| file.kind == kind);
        file.map_or("", |file| file.name.as_str())
    }
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
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) job: String,
    pub(super) frame: u64,
}

impl Place {
    pub(super) fn of(row: &Value) -> Result<Self, Failure> {
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

/// Where the files of a frame go: names of folders below the one with the lists, and what their own names begin with.
pub(super) struct Home {
    pub(super) folders: Vec<String>,
    pub(super) prefix: String,
}

impl Home {
    /// As `fathom render` writes a job, below these folders.
    pub(super) fn nested(above: &[&str], place: &Place) -> Self {
        let above = above.iter().map(|name| (*name).to_owned());
        let below = [place.job.clone(), place.frame.to_string()];
        Self {
            folders: above.chain(below).collect(),
            prefix: String::new(),
        }
    }
}

/// A file to fetch or to keep.
pub(super) struct Wanted<'a> {
    pub(super) kind: &'a str,
    /// That of its bytes, or of the frame that a record describes.
    pub(super) digest: &'a str,
}

impl Wanted<'_> {
    pub(super) fn is(&self, bytes: &[u8]) -> bool {
        if self.kind != RECORD {
            return sha256(bytes) == self.digest;
        }
        let record: Result<FrameRecord, _> = serde_json::from_slice(bytes);
        record.is_ok_and(|record| record.digest() == self.digest)
    }
}

/// A file that is in the folder.
struct Kept {
    name: String,
    digest: String,
}

impl Order<'_> {
    /// Fetches a frame into memory: one file for each kind, in their order.
    pub(super) fn fetch(&self, row: &Value, place: &Place) -> Result<Vec<Unpacked>, Failure> {
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

    /// Brings a frame's files into a folder of `part`, or of the root. Files that are there with the right digest are kept.
    pub(super) fn carry_out(
        &self,
        row: &Value,
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
        let mut found: Vec<Option<Kept>> = wanted.iter().map(|wanted| kept(&folder, home, wanted)).collect();
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

    /// What a row says of the files wanted.
    fn wanted<'a>(&'a self, row: &'a Value, place: &Place) -> Result<Vec<Wanted<'a>>, Failure> {
        self.kinds.iter().map(|kind| wanted(row, place, kind)).collect()
    }

    /// Asks for files of a frame, with one request.
    fn request(&self, place: &Place, wanted: &[Wanted<'_>]) -> Result<Vec<Unpacked>, Failure> {
        let image = format!("/v1/images/{}/{}", encode(&place.job), place.frame);
        let kinds: Vec<&str> = wanted
            .iter()
            .map(|wanted| wanted.kind)
            .filter(|kind| *kind != RECORD)
            .collect();
        if let ([only], []) = (wanted, kinds.as_slice()) {
            let bytes = self.remote.get_bytes(&image)?;
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
            .remote
            .get_bytes(&with_query(&format!("{image}/artifacts"), &parameters))?;
        unpacked(&archive, wanted)
    }

    /// The columns of a row that are exported.
    pub(super) fn values(&self, row: &Value) -> Map<String, Value> {
        let columns = self.columns.iter();
        columns
            .filter_map(|name| Some((name.clone(), row.get(name)?.clone())))
            .collect()
    }

    fn listed(
        &self,
        row: &Value,
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
            // Ours come last: no column of the service may say where a file is.
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

fn wanted<'a>(row: &'a Value, place: &Place, kind: &'a str) -> Result<Wanted<'a>, Failure> {
    let Place { job, frame } = place;
    let is_digest = |digest: &&str| digest.len() == 64 && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
    let column = match kind {
        RECORD => "digest".to_owned(),
        kind => format!("artifacts.{kind}"),
    };
    match &row[column] {
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
fn kept(folder: &Path, home: &Home, wanted: &Wanted<'_>) -> Option<Kept> {
    let mut names = EXTENSIONS
        .iter()
        .map(|(_, extension)| format!("{}{}.{extension}", home.prefix, wanted.kind));
    names.find_map(|name| {
        let path: PathBuf = folder.join(&name);
        let bytes = read(&path).filter(|bytes| wanted.is(bytes))?;
        let digest = sha256(&bytes);
        Some(Kept { name, digest })
    })
}

/// What a service sends that cannot be true.
pub(super) fn untrusted(what: String) -> Failure {
    anyhow::anyhow!("the service sent {what}; nothing of it was written").into()
}
