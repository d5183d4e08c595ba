//! Lists of identifiers that a user can send, each read from its declaration, for the API, the command line and the
//! documentation.

mod declared;
mod entries;
mod entry;
pub(crate) mod routes;

use declared::LISTS;
pub use entry::{Entry, List};

impl List {
    /// Every list.
    #[must_use]
    pub fn all() -> &'static [Self] {
        LISTS
    }

    /// Returns the list of this name, if there is one.
    #[must_use]
    pub fn parse(name: &str) -> Option<&'static Self> {
        LISTS.iter().find(|list| list.name == name)
    }

    /// The path of the list.
    #[must_use]
    pub fn path(&self) -> String {
        self.stored_at
            .map_or_else(|| format!("/v1/lists/{}", self.name), str::to_owned)
    }

    /// The command that prints it.
    #[must_use]
    pub fn command(&self) -> String {
        format!("fathom list {}", self.name)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use style::Library;

    use super::*;

    /// The table of all lists in Markdown.
    fn markdown() -> String {
        let mut text =
            "| identifiers | meaning | use | endpoint | command |\n|---|---|---|---|---|\n".to_owned();
        for list in LISTS {
            let (name, about, places) = (list.name, list.about, list.places.join("; "));
            let (path, command) = (list.path(), list.command());
            text += &format!("| {name} | {about} | {places} | `GET {path}` | `{command}` |\n");
        }
        text
    }

    /// `FATHOM_WRITE=1 cargo test -p api --lib lists` updates the table.
    #[test]
    fn the_table_of_the_documentation_is_up_to_date() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference/identifiers.md");
        let text = std::fs::read_to_string(path).unwrap();
        let table = text.find("| identifiers |").unwrap();
        let end = text[table..]
            .find("\n\n")
            .map_or(text.len(), |end| table + end + 1);
        let updated = format!("{}{}{}", &text[..table], markdown(), &text[end..]);
        if std::env::var_os("FATHOM_WRITE").is_some() {
            std::fs::write(path, updated).unwrap();
        } else {
            assert!(
                text == updated,
                "docs/reference/identifiers.md is out of date: run FATHOM_WRITE=1 cargo test -p api --lib lists"
            );
        }
    }

    #[test]
    fn every_list_has_a_source_and_every_entry_its_own_name_and_a_meaning() {
        let library = Library::embedded().unwrap();
        let names: BTreeSet<_> = LISTS.iter().map(|list| list.name).collect();
        assert_eq!(names.len(), LISTS.len());
        for list in LISTS {
            assert!(
                list.stored_at.is_some() || list.shipped.is_some(),
                "{}",
                list.name
            );
            assert!(!list.places.is_empty() && List::parse(list.name).is_some());
            let Some(shipped) = list.shipped else { continue };
            let entries = shipped(&library);
            let names: BTreeSet<_> = entries.iter().map(|entry| &entry.name).collect();
            assert!(
                !entries.is_empty() && names.len() == entries.len(),
                "{}",
                list.name
            );
            let silent = entries.iter().find(|entry| entry.about.is_empty());
            assert_eq!(silent, None, "{}", list.name);
        }
    }
}
