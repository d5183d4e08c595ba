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
mod texts;

pub(crate) use compile::compile;
pub use texts::{ComparedText, find_texts};

use std::collections::BTreeSet;

pub(crate) use crate::error::FilterError;
use crate::query::record_value::RecordValue;

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Number,
    /// A whole number of at most 2^53.
    Whole,
    /// A whole number of at most 2^64 − 1, stored less 2^63.
    Large,
    Text,
    Bool,
    /// A label, which may be a number, a text or a truth value from image to image. Comparisons, bins and statistics apply to
    /// the values of one type: [`Column::typed`].
    Label,
}

/// The offset of stored large numbers.
pub(crate) const OFFSET: i128 = 1 << 63;

/// A number up to 2^64 − 1 less 2^63: in the same order, and within 64 bits with a sign.
pub(crate) fn lowered(number: u64) -> i64 {
    (i128::from(number) - OFFSET) as i64
}

/// The inverse of [`lowered`].
pub(crate) fn raised(lowered: i64) -> u64 {
    (i128::from(lowered) + OFFSET) as u64
}

impl Kind {
    /// Whether it has an order and a mean.
    pub(crate) fn is_number(self) -> bool {
        matches!(self, Self::Number | Self::Whole | Self::Large)
    }
}

/// A value that is bound to a place in a statement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Bind {
    Number(f64),
    Whole(i64),
    Text(String),
}

/// A column as SQL with its binds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) sql: String,
    pub(crate) binds: Vec<Bind>,
    pub(crate) kind: Kind,
    pub(crate) unit: Option<&'static str>,
    /// Whether every row has a value.
    pub(crate) always: bool,
    /// The joined row with the value, if it is not in the image's row.
    pub(crate) join: Option<Join>,
    /// Where the record has its value, unless the column is an extract of the record.
    pub(crate) found: Option<RecordValue>,
    /// Its name in the replica, if that has it.
    pub(crate) replica_name: Option<String>,
    /// Place of a compared value in the statement.
    pub(crate) place: &'static str,
}

/// A value as SQLite reads it from JSON. Numbers of labels are compared in this form, so that equal texts are equal numbers.
const JSON_PLACE: &str = "(SELECT atom FROM json_each(?))";

impl Column {
    /// An optional column of the image's row, without a unit.
    pub(crate) fn new(sql: String, kind: Kind) -> Self {
        Self {
            sql,
            binds: Vec::new(),
            kind,
            unit: None,
            always: false,
            join: None,
            found: None,
            replica_name: None,
            place: "?",
        }
    }

    /// The values of one type of a label; other columns are unchanged.
    pub(crate) fn typed(self, kind: Kind) -> Self {
        if self.kind != Kind::Label {
            return self;
        }
        let record = Join::record_json();
        let (types, place) = match kind {
            Kind::Text => ("'text'", "?"),
            Kind::Bool => ("'true', 'false'", "?"),
            _ => ("'integer', 'real'", JSON_PLACE),
        };
        Self {
            sql: format!("(SELECT atom FROM json_each({record}, ?) WHERE type IN ({types}))"),
            kind,
            place,
            ..self
        }
    }

    /// The JSON of a label's values, which has their types; other columns are unchanged.
    pub(crate) fn into_json(self) -> Self {
        if self.kind != Kind::Label {
            return self;
        }
        Self {
            sql: format!("({} -> ?)", Join::record_json()),
            kind: Kind::Text,
            ..self
        }
    }

    /// Whether compared numbers are bound as JSON.
    pub(crate) fn compares_json(&self) -> bool {
        self.place == JSON_PLACE
    }
}

/// A row joined to that of an image, at most one for each.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Join {
    /// Everything known about the image.
    Record,
    /// The measurements of the picture of this name.
    Measured(String),
}

impl Join {
    /// The record as an operand of JSON functions, which would fail the whole statement for a damaged one.
    pub(crate) fn record_json() -> String {
        let record = Self::Record.alias();
        format!("iif(json_valid({record}.record), {record}.record, NULL)")
    }

    /// The alias of the row in a statement. Names of pictures contain no quotes, which is checked when columns are looked up.
    pub(crate) fn alias(&self) -> String {
        match self {
            Self::Record => "\"record of\"".to_owned(),
            Self::Measured(subject) => format!("\"measured of {subject}\""),
        }
    }
}

/// A condition as SQL.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compiled {
    pub(crate) sql: String,
    pub(crate) binds: Vec<Bind>,
    pub(crate) joins: BTreeSet<Join>,
    /// The columns of the filter that are part of the record.
    pub(crate) recorded: Vec<Column>,
    /// The same for the replica, unless it lacks a column.
    pub(crate) condition: Option<columnar::Condition>,
}
