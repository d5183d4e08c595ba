//! Lists of identifiers and their entries.

use serde::Serialize;
use style::Library;
use utoipa::ToSchema;

/// A list of identifiers.
#[derive(Debug, Clone, Copy)]
pub struct List {
    /// Name of the list in `fathom list`.
    pub name: &'static str,
    /// Meaning of the entries.
    pub about: &'static str,
    /// Uses of an entry, in Markdown.
    pub places: &'static [&'static str],
    /// The endpoint with a service's entries; `None` if they are the same in every service of a version.
    pub stored_at: Option<&'static str>,
    /// The built-in entries; `None` if only a service knows them.
    pub shipped: Option<fn(&Library) -> Vec<Entry>>,
}

/// An identifier.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = ListEntry)]
pub struct Entry {
    /// The identifier itself.
    #[schema(example = "semantics")]
    pub name: String,
    /// Number in masks: the code of a category, the bit of a finding.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub number: Option<u8>,
    /// Unit of its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub unit: Option<String>,
    /// Meaning.
    pub about: String,
}
