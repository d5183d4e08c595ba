//! `metadata.jsonl`, `SHA256SUMS` and `categories.json` of a folder with frames.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::classes::Named;
use cli::exit::Failure;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::commands::dataset::export::files::target::{create, draft_of, write};

pub(crate) const METADATA: &str = "metadata.jsonl";
pub(crate) const SUMS: &str = "SHA256SUMS";
const CATEGORIES: &str = "categories.json";

/// Both lists of a folder, renamed into place once they are complete.
pub(crate) struct Lists {
    metadata: List,
    sums: List,
    /// Frames so far.
    pub(crate) frames: u64,
    /// Classes of the objects in them.
    pub(crate) classes: Named,
    /// Columns that any of them has a value in.
    pub(crate) columns: BTreeSet<String>,
}

struct List {
    path: PathBuf,
    file: BufWriter<File>,
}

/// The rows of a folder, complete but not yet in their place.
pub(crate) struct Rows {
    pub(crate) draft: PathBuf,
    path: PathBuf,
}

impl Lists {
    pub(crate) fn create(folder: &Path) -> Result<Self, Failure> {
        Ok(Self {
            metadata: List::create(folder.join(METADATA))?,
            sums: List::create(folder.join(SUMS))?,
            frames: 0,
            classes: Named::new(),
            columns: BTreeSet::new(),
        })
    }

    /// Adds the line of a frame.
    pub(crate) fn add(&mut self, metadata: &Value) -> Result<(), Failure> {
        self.frames += 1;
        let columns = metadata.as_object().into_iter().flat_map(|row| row.keys());
        for column in columns
            .filter(|column| !self.columns.contains(*column))
            .collect::<Vec<_>>()
        {
            self.columns.insert(column.clone());
        }
        self.metadata.line(&metadata.to_string())
    }

    /// Adds a file by its path below the folder.
    pub(crate) fn add_sum(&mut self, digest: &str, name: &str) -> Result<(), Failure> {
        self.sums.line(&format!("{digest}  {name}"))
    }

    /// Adds files of the folder as they are now.
    pub(crate) fn add_files(&mut self, names: &[String]) -> Result<(), Failure> {
        for name in names {
            let digest = digest_of(&self.sums.path.with_file_name(name))?;
            self.add_sum(&digest, name)?;
        }
        Ok(())
    }

    /// Completes the rows; the format decides whether to keep them.
    pub(crate) fn finish_rows(&mut self) -> Result<Rows, Failure> {
        self.metadata.finish()?;
        let path = self.metadata.path.clone();
        Ok(Rows {
            draft: draft_of(&path),
            path,
        })
    }

    /// Writes the list of classes if there are any, and adds it to the sums.
    pub(crate) fn finish_classes(&mut self) -> Result<(), Failure> {
        let path = self.sums.path.with_file_name(CATEGORIES);
        match write_classes(&path, &self.classes)? {
            true => self.add_files(&[CATEGORIES.to_owned()]),
            false => Ok(()),
        }
    }

    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.sums.finish()?;
        let path = &self.sums.path;
        Ok(fs::rename(draft_of(path), path).with_context(|| format!("cannot write {}", path.display()))?)
    }
}

impl Rows {
    /// Leaves them as `metadata.jsonl`.
    pub(crate) fn keep(self) -> Result<(), Failure> {
        let Self { draft, path } = self;
        Ok(fs::rename(&draft, &path).with_context(|| format!("cannot write {}", path.display()))?)
    }

    /// Removes them after they were written in another form.
    pub(crate) fn remove(self) -> Result<(), Failure> {
        let draft = &self.draft;
        Ok(fs::remove_file(draft).with_context(|| format!("cannot remove {}", draft.display()))?)
    }
}

impl List {
    fn create(path: PathBuf) -> Result<Self, Failure> {
        let file = create(&draft_of(&path)).map(BufWriter::new);
        let file = file.with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Self { path, file })
    }

    fn line(&mut self, line: &str) -> Result<(), Failure> {
        Ok(writeln!(self.file, "{line}").with_context(|| format!("cannot write {}", self.path.display()))?)
    }

    fn finish(&mut self) -> Result<(), Failure> {
        let done = self.file.flush().and_then(|()| self.file.get_ref().sync_all());
        Ok(done.with_context(|| format!("cannot write {}", self.path.display()))?)
    }
}

/// SHA-256 of a file, lower-case hex.
pub(crate) fn digest_of(path: &Path) -> Result<String, Failure> {
    let digest = || -> io::Result<String> {
        let mut file = File::open(path)?;
        let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 20]);
        loop {
            match file.read(&mut block)? {
                0 => return Ok(spec::hex(&hash.finalize())),
                length => hash.update(&block[..length]),
            }
        }
    };
    Ok(digest().with_context(|| format!("cannot read {}", path.display()))?)
}

/// Writes the classes of all frames, and warns of a code with different meanings in different scenes; returns whether there are any.
fn write_classes(path: &Path, classes: &Named) -> Result<bool, Failure> {
    if classes.is_empty() {
        return Ok(false);
    }
    let pairs = classes.iter().zip(classes.iter().skip(1));
    for ((id, name), (_, other)) in pairs.filter(|((id, _), (next, _))| id == next) {
        eprintln!(
            "warning: code {id} is `{name}` in some scenes and `{other}` in others; give their classes distinct ids"
        );
    }
    let list = classes.iter().map(|(id, name)| json!({"id": id, "name": name}));
    let list: Vec<Value> = list.collect();
    write(path, format!("{:#}\n", json!(list)).as_bytes())?;
    Ok(true)
}
