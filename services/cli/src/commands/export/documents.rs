//! The documents that describe a whole export.

use cli::classes::Named;
use cli::exit::Failure;

use super::Arguments;
use super::card::Card;
use super::class_numbers::ClassNumbers;
use super::croissant::{RowFile, croissant};
use super::fields::fields;
use super::format::Format;
use super::lists::{SUMS, digest_of};
use super::origins::Origin;
use super::part::Part;
use super::selection::Selection;
use super::target::{Target, write};
use super::yolo::data_yaml;

/// The input of the documents.
pub(super) struct Documents<'a> {
    pub(super) arguments: &'a Arguments,
    pub(super) selection: &'a Selection,
    pub(super) target: &'a Target,
    pub(super) classes: &'a ClassNumbers,
    pub(super) origins: &'a [Origin],
    /// The lists of rows of the parts.
    pub(super) rows: &'a [RowFile],
}

impl Documents<'_> {
    /// Writes them, and completes the parts. The sums of an undivided export include its documents; divided ones have separate sums.
    pub(super) fn write(&self, mut parts: Vec<Part>) -> Result<(), Failure> {
        let names = self.write_files(&parts)?;
        match parts.as_mut_slice() {
            [whole] if whole.name.is_none() => whole.lists.add_files(&names)?,
            _ => self.write_sums(&names)?,
        }
        parts.into_iter().try_for_each(Part::close)
    }

    fn write_files(&self, parts: &[Part]) -> Result<Vec<String>, Failure> {
        let counts: Vec<(Option<String>, u64)> = parts
            .iter()
            .map(|part| (part.name.clone(), part.lists.frames))
            .collect();
        let classes: Named = parts.iter().flat_map(|part| part.lists.classes.clone()).collect();
        let Arguments {
            dataset,
            filter,
            license,
            format,
            ..
        } = self.arguments;
        let card = Card {
            dataset,
            filter,
            license,
            format: *format,
            kinds: &self.selection.kinds,
            parts: &counts,
            origins: self.origins,
            classes: self.classes,
        };
        let mut files = vec![
            ("fields.json", fields(self.selection, &classes)),
            ("README.md", card.markdown()),
            (
                "croissant.json",
                croissant(&card, &self.selection.columns, self.rows),
            ),
        ];
        if *format == Format::Yolo {
            let names: Vec<Option<String>> = counts.into_iter().map(|(name, _)| name).collect();
            files.push(("data.yaml", data_yaml(&names, self.classes)));
        }
        for (name, text) in &files {
            write(&self.target.root().join(name), text.as_bytes())?;
        }
        Ok(files.into_iter().map(|(name, _)| name.to_owned()).collect())
    }

    fn write_sums(&self, names: &[String]) -> Result<(), Failure> {
        let root = self.target.root();
        let lines = names
            .iter()
            .map(|name: &String| Ok(format!("{}  {name}\n", digest_of(&root.join(name))?)))
            .collect::<Result<Vec<_>, Failure>>()?;
        write(&root.join(SUMS), lines.concat().as_bytes())
    }
}
