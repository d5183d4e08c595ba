//! Every list of identifiers that a user can send, each read from the place that declares them: for the API, the command
//! line and the documentation.

mod declared;
pub(crate) mod routes;

use serde::Serialize;
use style::Library;
use utoipa::ToSchema;

use declared::LISTS;

/// A list of identifiers.
#[derive(Debug, Clone, Copy)]
pub struct List {
    /// Its own name, as `fathom list` takes it.
    pub name: &'static str,
    /// What its entries are.
    pub about: &'static str,
    /// Where a user sends or meets an entry, in Markdown.
    pub places: &'static [&'static str],
    /// The endpoint that lists what a service has; absent for what is the same in every service of a version.
    pub stored_at: Option<&'static str>,
    /// What comes with the program; absent where only a service knows.
    pub shipped: Option<fn(&Library) -> Vec<Entry>>,
}

/// An identifier.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = ListEntry)]
pub struct Entry {
    /// What to send.
    #[schema(example = "semantics")]
    pub name: String,
    /// Its number in masks: of a category the code, of a finding the bit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub number: Option<u8>,
    /// Unit of its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unit: Option<&'static str>,
    /// What it means.
    pub about: String,
}

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

    /// The path that lists it.
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

    use super::*;

    /// The table of all lists in Markdown.
    fn markdown() -> String {
        let mut text =
            "| identifiers | meaning | where | endpoint | command |\n|---|---|---|---|---|\n".to_owned();
        for list in LISTS {
            let (name, about, places) = (list.name, list.about, list.places.join("; "));
            let (path, command) = (list.path(), list.command());
            text += &format!("| {name} | {about} | {places} | `GET {path}` | `{command}` |\n");
        }
        text
    }

    /// The documented table is this one. After a change of the lists, copy what the failure prints.
    #[test]
    fn the_table_of_the_documentation_is_up_to_date() {
        let written = include_str!("../../../../docs/reference/identifiers.md");
        assert!(
            written.contains(&markdown()),
            "docs/reference/identifiers.md should hold:\n{}",
            markdown()
        );
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
