//! The documents that describe a whole export.

use cli::classes::Named;
use cli::exit::Failure;

use crate::commands::dataset::export::arguments::Arguments;
use crate::commands::dataset::export::files::lists::{SUMS, digest_of};
use crate::commands::dataset::export::files::target::{Target, write};
use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::formats::card::Card;
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::formats::croissant::{RowFile, croissant};
use crate::commands::dataset::export::formats::yolo::data_yaml;
use crate::commands::dataset::export::input::fields::fields;
use crate::commands::dataset::export::input::origins::Origin;
use crate::commands::dataset::export::input::selection::Selection;
use crate::commands::dataset::export::output::part::Part;

/// The input of the documents.
pub(crate) struct Documents<'a> {
    pub(crate) arguments: &'a Arguments,
    pub(crate) selection: &'a Selection,
    pub(crate) target: &'a Target,
    pub(crate) classes: &'a ClassNumbers,
    pub(crate) origins: &'a [Origin],
    /// The lists of rows of the parts.
    pub(crate) rows: &'a [RowFile],
}

impl Documents<'_> {
    /// Writes them, and completes the parts. The sums of an undivided export include its documents; divided ones have separate sums.
    pub(crate) fn write(&self, mut parts: Vec<Part>) -> Result<(), Failure> {
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
        let rows: Vec<&str> = self.rows.iter().map(|rows| rows.sha256.as_str()).collect();
        let rows = spec::sha256(rows.join("\n"));
        let card = Card {
            dataset,
            filter,
            license,
            format: *format,
            kinds: &self.selection.kinds,
            parts: &counts,
            origins: self.origins,
            classes: self.classes,
            rows: &rows,
        };
        let mut files = vec![
            ("fields.json", fields(*format, self.selection, &classes)),
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
