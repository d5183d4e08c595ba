//! The files of a folder by their relative paths, and the reasons why some are not used.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::plural::count;
use cli::table;

/// Deepest level of subfolders.
const MAX_DEPTH: usize = 8;

/// A file of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) path: PathBuf,
    /// Path below the folder with `/` as separator.
    pub(super) name: String,
}

impl Entry {
    /// File name without its folder.
    pub(super) fn file_name(&self) -> &str {
        self.name.rsplit('/').next().unwrap_or_default()
    }

    /// Folder below the root, without a final separator; empty for the root.
    pub(super) fn folder(&self) -> &str {
        self.name.rsplit_once('/').map_or("", |(folder, _)| folder)
    }

    /// Extension in lower case.
    pub(super) fn extension(&self) -> String {
        let name = self.file_name();
        name.rsplit_once('.')
            .map_or(String::new(), |(_, extension)| extension.to_ascii_lowercase())
    }

    /// File name without its extension.
    pub(super) fn stem(&self) -> &str {
        let name = self.file_name();
        name.rsplit_once('.').map_or(name, |(stem, _)| stem)
    }

    /// Path below the folder without the extension.
    pub(super) fn path_stem(&self) -> &str {
        self.name
            .strip_suffix(self.file_name())
            .map_or(self.stem(), |folder| {
                &self.name[..folder.len() + self.stem().len()]
            })
    }

    /// Whether the file belongs to a system and not to its user, such as `._0001.png`.
    fn is_hidden(&self) -> bool {
        let is_hidden = |part: &str| part.starts_with('.') || part == "__MACOSX";
        self.name.split('/').any(is_hidden) || matches!(self.file_name(), "Thumbs.db" | "desktop.ini")
    }
}

/// The files of a folder.
pub(super) struct Entries {
    pub(super) files: Vec<Entry>,
    pub(super) unused: Unused,
}

/// Lists a folder with its subfolders, sorted by name. Hidden files and those of `ignored` become unused.
pub(super) fn list_entries(folder: &Path, ignored: &[String]) -> Result<Entries, Failure> {
    let mut all = Vec::new();
    collect(folder, "", MAX_DEPTH, &mut all)?;
    all.sort_by(|one, other| one.name.cmp(&other.name));
    let mut entries = Entries {
        files: Vec::new(),
        unused: Unused::default(),
    };
    for entry in all {
        let pattern = ignored.iter().find(|pattern| {
            matches_pattern(pattern, &entry.name) || matches_pattern(pattern, entry.file_name())
        });
        match pattern {
            Some(pattern) => entries.unused.add(&entry.name, &format!("--ignore {pattern}")),
            None if entry.is_hidden() => entries.unused.add(&entry.name, "hidden file"),
            None => entries.files.push(entry),
        }
    }
    Ok(entries)
}

fn collect(folder: &Path, prefix: &str, depth: usize, all: &mut Vec<Entry>) -> Result<(), Failure> {
    let unreadable = |error| Failure::BadInput(format!("{}: {error}", folder.display()));
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let own = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let name = if prefix.is_empty() {
            own
        } else {
            format!("{prefix}/{own}")
        };
        if !path.is_dir() {
            all.push(Entry { path, name });
        } else if depth > 0 {
            collect(&path, &name, depth - 1, all)?;
        } else {
            let message = format!("{} is nested more than {MAX_DEPTH} deep", path.display());
            return Err(Failure::BadInput(message));
        }
    }
    Ok(())
}

/// Whether a text fits a pattern: `*` stands for any characters and `?` for one.
pub(super) fn matches_pattern(pattern: &str, text: &str) -> bool {
    let (pattern, text): (Vec<char>, Vec<char>) = (pattern.chars().collect(), text.chars().collect());
    // Row by row of the table of prefixes: `fits[i]` is whether the pattern so far fits the first i characters.
    let mut fits = vec![false; text.len() + 1];
    fits[0] = true;
    for letter in pattern {
        let mut next = vec![false; text.len() + 1];
        next[0] = letter == '*' && fits[0];
        for (index, &character) in text.iter().enumerate() {
            next[index + 1] = match letter {
                '*' => fits[index + 1] || next[index],
                '?' => fits[index],
                _ => fits[index] && letter == character,
            };
        }
        fits = next;
    }
    fits[text.len()]
}

/// Files without an effect, by reason.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Unused(Vec<(String, String)>);

impl Unused {
    pub(super) fn add(&mut self, name: &str, reason: &str) {
        self.0.push((name.to_owned(), reason.to_owned()));
    }

    /// Takes a file out that has an effect after all.
    pub(super) fn remove(&mut self, name: &str) {
        self.0.retain(|(other, _)| other != name);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A table of all files; numbered files of one reason share a row.
    pub(super) fn to_table(&self) -> String {
        /// Names shown one by one for a pattern.
        const SINGLE: usize = 3;
        let mut groups: BTreeMap<(&str, String), Vec<&str>> = BTreeMap::new();
        for (name, reason) in &self.0 {
            groups
                .entry((reason, replace_digits(name)))
                .or_default()
                .push(name);
        }
        let mut rows = Vec::new();
        for ((reason, pattern), names) in groups {
            if names.len() <= SINGLE {
                rows.extend(
                    names
                        .into_iter()
                        .map(|name| vec![name.to_owned(), reason.to_owned()]),
                );
            } else {
                rows.push(vec![
                    format!("{pattern} ({})", count(names.len(), "file")),
                    reason.to_owned(),
                ]);
            }
        }
        rows.sort();
        table::text_table(&["unused file", "reason"], &rows)
    }
}

/// A name with `*` for each run of digits.
fn replace_digits(name: &str) -> String {
    let mut pattern = String::new();
    for letter in name.chars() {
        match (letter.is_ascii_digit(), pattern.ends_with('*')) {
            (true, true) => {}
            (true, false) => pattern.push('*'),
            (false, _) => pattern.push(letter),
        }
    }
    pattern
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_fits_as_in_a_shell() {
        for (pattern, text, fits) in [
            ("*.txt", "a/notes.txt", true),
            ("*_mask.png", "0001_mask.png", true),
            ("000?.png", "0001.png", true),
            ("000?.png", "00010.png", false),
            ("", "", true),
            ("*", "", true),
            ("a*b*c", "aXbYbc", true),
            ("a*b*c", "aXbYb", false),
        ] {
            assert_eq!(matches_pattern(pattern, text), fits, "{pattern} {text}");
        }
    }

    #[test]
    fn numbered_files_of_a_reason_share_a_row() {
        let mut unused = Unused::default();
        for number in 0..24 {
            unused.add(&format!("normals_{number:04}.png"), "not used");
        }
        unused.add("README.txt", "no data");
        let table = unused.to_table();
        assert!(table.contains("normals_*.png (24 files)"), "{table}");
        assert!(table.contains("README.txt"), "{table}");
    }

    #[test]
    fn the_parts_of_a_name_are_found() {
        let entry = Entry {
            path: PathBuf::new(),
            name: "cam0/0001.range.NPY".to_owned(),
        };
        assert_eq!(
            (entry.folder(), entry.stem(), entry.path_stem()),
            ("cam0", "0001.range", "cam0/0001.range")
        );
        assert_eq!(
            (entry.extension().as_str(), entry.file_name()),
            ("npy", "0001.range.NPY")
        );
    }
}
