//! The pictures to enhance and where their results go.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;

/// One picture and its result.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Work {
    pub(super) input: PathBuf,
    pub(super) output: PathBuf,
}

/// Every picture named by the user or in a named folder. One picture may name its result; otherwise `out` is a folder.
///
/// A folder without pictures, two results of one name, and a result in place of a picture are errors.
pub(super) fn find_work(inputs: &[PathBuf], out: &Path) -> Result<Vec<Work>, Failure> {
    let mut pictures = Vec::new();
    for input in inputs {
        if !input.is_dir() {
            pictures.push(input.clone());
            continue;
        }
        let found = files::pictures(input)?;
        if found.is_empty() {
            return Err(Failure::BadInput(format!(
                "{} has no pictures (.png, .jpg or .webp); folders in it are not searched",
                input.display()
            )));
        }
        pictures.extend(found);
    }
    let is_file = !out.is_dir() && out.extension().is_some();
    if is_file && pictures.len() > 1 {
        return Err(Failure::BadInput(format!(
            "--out {} names one file for {} pictures; name a folder",
            out.display(),
            pictures.len()
        )));
    }
    let work: Vec<Work> = pictures
        .into_iter()
        .map(|input| {
            let output = if is_file {
                out.to_owned()
            } else {
                out.join(input.file_name().unwrap_or_default())
                    .with_extension("png")
            };
            Work { input, output }
        })
        .collect();
    refuse_collisions(&work)?;
    Ok(work)
}

fn refuse_collisions(work: &[Work]) -> Result<(), Failure> {
    let mut origins: BTreeMap<&Path, &Path> = BTreeMap::new();
    for Work { input, output } in work {
        if let Some(other) = origins.insert(output, input) {
            return Err(Failure::BadInput(format!(
                "{} and {} would both become {}; enhance them into different folders",
                other.display(),
                input.display(),
                output.display()
            )));
        }
    }
    let sources = work.iter().filter_map(|work| fs::canonicalize(&work.input).ok());
    let sources: Vec<PathBuf> = sources.collect();
    for Work { output, .. } in work {
        if fs::canonicalize(output).is_ok_and(|output| sources.contains(&output)) {
            return Err(Failure::BadInput(format!(
                "{} would replace a picture; name another --out",
                output.display()
            )));
        }
    }
    Ok(())
}
