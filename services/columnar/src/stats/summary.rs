//! Statistics of a column.

use crate::error::ColumnarError;
use crate::groups::{Grouped, NO_GROUP};
use crate::parts::Rows;

/// Statistics of the values of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Summary {
    pub count: u64,
    pub mean: Option<f64>,
    pub sd: Option<f64>,
    pub min: Option<f64>,
    pub q25: Option<f64>,
    pub median: Option<f64>,
    pub q75: Option<f64>,
    pub max: Option<f64>,
}

/// The shares below the quartiles.
pub(super) const SHARES: [f64; 3] = [0.25, 0.5, 0.75];

/// The summaries of one column, group by group, or of a group, column by column.
pub(super) type Summaries = Vec<Summary>;

/// The position of a quartile among sorted values.
pub(super) struct Quantile {
    pub(super) low: u64,
    pub(super) high: u64,
    pub(super) share: f64,
}

impl Quantile {
    pub(super) fn new(share: f64, count: u64) -> Option<Self> {
        let place = share * count.checked_sub(1)? as f64;
        Some(Self {
            low: place.floor() as u64,
            high: place.ceil() as u64,
            share: place.fract(),
        })
    }

    /// Interpolates. The result zero has no sign, so that the order of equal values does not matter.
    pub(super) fn between(&self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share + 0.0
    }
}

/// Calls `each` with the group and the value of every row of the query that has one.
#[inline]
pub(super) fn each_value(
    rows: &Rows<'_>,
    grouped: &Grouped,
    metric: usize,
    mut each: impl FnMut(usize, f64),
) -> Result<(), ColumnarError> {
    let column = rows.column(metric)?;
    let values = column.numbers();
    let groups = &grouped.groups[rows.at];
    if groups.is_empty() {
        rows.visit(values.len(), |at| {
            if !values[at].is_nan() {
                each(0, values[at]);
            }
        });
        return Ok(());
    }
    for (group, value) in groups.iter().zip(values.iter()) {
        if *group != NO_GROUP && !value.is_nan() {
            each(*group as usize, *value);
        }
    }
    Ok(())
}
