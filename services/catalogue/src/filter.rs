//! The filter language: a condition over the columns of an image, compiled to SQL with bound values.
//!
//! ```text
//! uiqm > 0.8 and water.style in ("muddy") and alpha between 0.2 and 0.6 and not failed
//! ```
//!
//! `or`, `and`, `not`, parentheses; `= == != < <= > >=`, `in (…)`, `not in (…)`, `between … and …`, `is null`,
//! `is not null`; a yes-or-no column alone. A comparison with a missing value is false, and `not` of it is true. Names are
//! looked up before anything is compiled; values are bound, never pasted.

mod compile;
mod lexer;

pub(crate) use compile::compile;

use std::collections::BTreeSet;

use crate::error::CatalogueError;
use crate::joins::Join;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Number,
    Text,
    Bool,
}

/// A value that is bound to a place in a statement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Bind {
    Number(f64),
    Text(String),
}

/// A column as SQL of our own, with the binds of its places.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) sql: String,
    pub(crate) binds: Vec<Bind>,
    pub(crate) kind: Kind,
    /// Whether every row has a value.
    pub(crate) always: bool,
    /// The row beside that of the image in which it stands.
    pub(crate) join: Option<Join>,
}

/// A condition as SQL.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compiled {
    pub(crate) sql: String,
    pub(crate) binds: Vec<Bind>,
    pub(crate) joins: BTreeSet<Join>,
}

/// A filter that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message} (at position {position}){}", did_you_mean.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default())]
pub struct FilterError {
    /// Byte offset in the filter.
    pub position: usize,
    /// What is wrong.
    pub message: String,
    /// The nearest name.
    pub did_you_mean: Option<String>,
}

/// A question that is refused for another reason than its filter.
pub(crate) fn refused(message: String) -> CatalogueError {
    FilterError {
        position: 0,
        message,
        did_you_mean: None,
    }
    .into()
}

/// The nearest of some names, if one is near.
pub(crate) fn nearest(name: &str, names: &[String]) -> Option<String> {
    let limit = (name.chars().count() / 3).max(2);
    let ranked = names.iter().map(|known| (distance(name, known), known));
    ranked
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, known)| known.clone())
}

/// Edits that turn one text into the other (Levenshtein 1966).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, left) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, right) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(left != *right);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
