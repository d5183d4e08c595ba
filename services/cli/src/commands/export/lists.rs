//! `metadata.jsonl`, `SHA256SUMS` and `categories.json` of a folder with frames.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::classes::Named;
use cli::exit::Failure;
use serde_json::{Value, json};

use super::frame::Frame;
use super::target::{create, draft_of, write};

pub(super) const METADATA: &str = "metadata.jsonl";
pub(super) const SUMS: &str = "SHA256SUMS";
const CATEGORIES: &str = "categories.json";

/// Both lists of a folder, renamed into place once they are complete.
pub(super) struct Lists {
    metadata: List,
    sums: List,
    /// Frames so far.
    pub(super) frames: u64,
    /// Classes of the objects in them.
    pub(super) classes: Named,
}

struct List {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Lists {
    pub(super) fn create(folder: &Path) -> Result<Self, Failure> {
        let open = |name: &str| {
            let path = folder.join(name);
            let file = create(&draft_of(&path)).map(BufWriter::new);
            let file = file.with_context(|| format!("cannot write {}", path.display()))?;
            Ok::<_, anyhow::Error>(List { path, file })
        };
        Ok(Self {
            metadata: open(METADATA)?,
            sums: open(SUMS)?,
            frames: 0,
            classes: Named::new(),
        })
    }

    pub(super) fn add(&mut self, frame: &Frame) -> Result<(), Failure> {
        let mut write = || {
            writeln!(self.metadata.file, "{}", frame.metadata)?;
            let mut files = frame.files.iter();
            files.try_for_each(|file| writeln!(self.sums.file, "{}  {}", file.digest, file.name))
        };
        write().context("cannot write the lists of the export")?;
        self.frames += 1;
        Ok(())
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        write_classes(&self.metadata.path.with_file_name(CATEGORIES), &self.classes)?;
        for List { path, file } in [self.metadata, self.sums] {
            let file = file.into_inner().map_err(|error| error.into_error());
            file.and_then(|file| file.sync_all())
                .and_then(|()| fs::rename(draft_of(&path), &path))
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
        Ok(())
    }
}

/// Writes the classes of all frames, and warns of a code that means different things in different scenes.
fn write_classes(path: &Path, classes: &Named) -> Result<(), Failure> {
    if classes.is_empty() {
        return Ok(());
    }
    let pairs = classes.iter().zip(classes.iter().skip(1));
    for ((id, name), (_, other)) in pairs.filter(|((id, _), (next, _))| id == next) {
        eprintln!(
            "warning: code {id} is `{name}` in some scenes and `{other}` in others; give their classes ids of your own"
        );
    }
    let list = classes.iter().map(|(id, name)| json!({"id": id, "name": name}));
    let list: Vec<Value> = list.collect();
    write(path, format!("{:#}\n", json!(list)).as_bytes())
}
