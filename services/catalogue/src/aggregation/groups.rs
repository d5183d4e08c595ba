//! Groups of images: by columns and by bins of columns.

use std::cmp::Ordering;

use client::GroupColumn;
use columnar::{Bins, Cell};
use serde_json::{Value, json};

use crate::error::CatalogueError;
use crate::query::column_value::column;
use crate::query::columns::Columns;
use crate::query::filter::{Column, Kind, raised};
use crate::query::record_value;

/// The parameter of the API.
const BY: &str = "by";
/// Most columns of `by`; with more, groups have hardly more than one image each.
const MOST_COLUMNS: usize = 8;
/// Most groups of `by`; longer tables are better served by pages of images.
pub(crate) const MOST_GROUPS: usize = 1000;

/// A column of groups, as it is read from rows.
pub(crate) struct Key {
    pub(crate) shown: GroupColumn,
    pub(crate) column: Column,
    pub(crate) bins: Option<Bins>,
    /// Whether the groups are JSON, as those of labels.
    pub(crate) is_json: bool,
}

/// Reads `water.optics,alpha:0.1`.
pub(crate) fn keys(columns: &Columns, by: &str) -> Result<Vec<Key>, CatalogueError> {
    let keys = by.split(',').map(|part| Key::parse(columns, part.trim()));
    let keys = keys.collect::<Result<Vec<_>, _>>()?;
    if keys.len() > MOST_COLUMNS {
        let message = format!("has {} columns; must be at most {MOST_COLUMNS}", keys.len());
        return Err(CatalogueError::refused_parameter(BY, &message));
    }
    for (position, key) in keys.iter().enumerate() {
        let name = &key.shown.column;
        if keys[..position].iter().any(|other| other.shown.column == *name) {
            let message = format!("names `{name}` twice");
            return Err(CatalogueError::refused_parameter(BY, &message));
        }
    }
    Ok(keys)
}

impl Key {
    /// A column whose values are the groups.
    pub(crate) fn plain(
        columns: &Columns,
        name: &str,
        parameter: &'static str,
    ) -> Result<Self, CatalogueError> {
        let column = column(columns, name, parameter)?;
        Ok(Self {
            shown: GroupColumn {
                column: name.to_owned(),
                unit: column.unit.map(str::to_owned),
                width: None,
            },
            is_json: column.kind == Kind::Label,
            column: column.into_json(),
            bins: None,
        })
    }

    fn parse(columns: &Columns, text: &str) -> Result<Self, CatalogueError> {
        let Some((name, width)) = text.rsplit_once(':') else {
            return Self::plain(columns, text, BY);
        };
        let mut key = Self::plain(columns, name, BY)?;
        key.column = column(columns, name, BY)?.typed(Kind::Number);
        key.is_json = false;
        if !key.column.kind.is_number() {
            let message = format!(
                "names `{name}`, which is not a column of numbers and has no bins; without `:{width}` each value is a group"
            );
            return Err(CatalogueError::refused_parameter(BY, &message));
        }
        let parsed = width
            .parse()
            .ok()
            .filter(|width: &f64| width.is_normal() && *width > 0.0);
        let Some(parsed) = parsed else {
            let message = format!(
                "has the width `{width}` for the bins of `{name}`; must be a number above 0, as in {name}:0.1"
            );
            return Err(CatalogueError::refused_parameter(BY, &message));
        };
        key.shown.width = Some(parsed);
        key.bins = Some(Bins::new(parsed));
        Ok(key)
    }
}

/// The value that the rows of a group have in common in a column; of a column in bins, the lower edge of the bin.
pub(crate) fn group_value(cell: &Cell, is_json: bool) -> Value {
    match cell {
        Cell::Text(text) if is_json => serde_json::from_str(text).unwrap_or_else(|_| json!(**text)),
        Cell::Missing => Value::Null,
        Cell::Number(bits) => record_value::number(f64::from_bits(*bits)),
        Cell::Edge(bits) => json!(f64::from_bits(*bits)),
        Cell::Whole(number) => json!(number),
        Cell::Large(held) => json!(raised(*held)),
        Cell::Flag(flag) => json!(flag),
        Cell::Text(text) => json!(**text),
    }
}

/// The order of groups, column by column: false before true, numbers by size, texts by their characters, missing values last;
/// truth values, numbers and texts of one label in this order.
#[must_use]
pub fn compare_groups(one: &[Value], other: &[Value]) -> Ordering {
    let pairs = one.iter().zip(other);
    pairs
        .map(|(one, other)| compare(one, other))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

fn compare(one: &Value, other: &Value) -> Ordering {
    match (one, other) {
        (Value::Bool(one), Value::Bool(other)) => one.cmp(other),
        (Value::Number(a), Value::Number(b)) => match (a.as_i128(), b.as_i128()) {
            (Some(a), Some(b)) => a.cmp(&b),
            _ => f64::total_cmp(&a.as_f64().unwrap_or(f64::NAN), &b.as_f64().unwrap_or(f64::NAN)),
        },
        (Value::String(one), Value::String(other)) => one.cmp(other),
        _ => type_rank(one).cmp(&type_rank(other)),
    }
}

fn type_rank(value: &Value) -> u8 {
    match value {
        Value::Bool(_) => 0,
        Value::Number(_) => 1,
        Value::String(_) => 2,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_in_the_order_of_their_values() {
        let mut groups = vec![
            json!(["b", 10]),
            json!(["a", null]),
            json!(["a", 10]),
            json!([null, 1]),
            json!(["a", 9.5]),
            json!(["a", -2]),
        ];
        groups.sort_by(|one, other| compare_groups(one.as_array().unwrap(), other.as_array().unwrap()));
        let sorted = json!([
            ["a", -2],
            ["a", 9.5],
            ["a", 10],
            ["a", null],
            ["b", 10],
            [null, 1]
        ]);
        assert_eq!(json!(groups), sorted);
        assert_eq!(compare(&json!(u64::MAX), &json!(u64::MAX - 1)), Ordering::Greater);
        assert_eq!(compare(&json!(false), &json!(true)), Ordering::Less);
    }
}
