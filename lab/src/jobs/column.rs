//! Columns of a table: values of frames, and their summary.

use serde_json::{Map, Value, json};

use crate::statistics::{largest, mean, quantile, sorted};

/// How the values of a group of frames become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Summary {
    Median,
    /// The median, the 10th and the 90th percentile.
    Spread,
    Mean,
    Max,
    /// The sum of counts.
    Count,
    /// The share of values above 0, in percent, and the number of values.
    Share,
}

/// A value of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) value: f64,
    pub(super) summary: Summary,
}

impl Column {
    pub(super) fn new(name: impl Into<String>, value: f64, summary: Summary) -> Self {
        let name = name.into();
        Self { name, value, summary }
    }
}

/// One cell for each column, in the order of the values.
pub(super) fn summarize(columns: &[Column]) -> Map<String, Value> {
    let mut cells: Vec<(&str, Summary, Vec<f64>)> = Vec::new();
    for column in columns {
        match cells.iter_mut().find(|(name, ..)| *name == column.name) {
            Some((.., values)) => values.push(column.value),
            None => cells.push((&column.name, column.summary, vec![column.value])),
        }
    }
    let cells = cells.into_iter();
    cells
        .map(|(name, summary, values)| (name.to_owned(), summary.apply(&values)))
        .collect()
}

impl Summary {
    fn apply(self, values: &[f64]) -> Value {
        let finite = sorted(values.iter().copied().filter(|value| value.is_finite()));
        if finite.is_empty() {
            return Value::Null;
        }
        match self {
            Self::Median => json!(quantile(&finite, 0.5)),
            Self::Mean => json!(mean(&finite)),
            Self::Max => json!(largest(finite)),
            Self::Count => json!(finite.iter().sum::<f64>() as u64),
            Self::Share => {
                let share = finite.iter().filter(|&&value| value > 0.0).count() as f64 / finite.len() as f64;
                json!(format!("{:.0} % of {}", 100.0 * share, finite.len()))
            }
            Self::Spread => {
                let [low, middle, high] = [0.1, 0.5, 0.9].map(|share| round(quantile(&finite, share)));
                json!(format!("{middle} ({low} to {high})"))
            }
        }
    }
}

/// Whole numbers from 10 on, one digit below, two below 1.
fn round(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 9.95 || v < 0.005 => 0,
        v if v >= 0.995 => 1,
        _ => 2,
    };
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_summarized_by_column() {
        let value = |value, summary| Column::new(format!("{summary:?}"), value, summary);
        let all = [
            Summary::Median,
            Summary::Spread,
            Summary::Mean,
            Summary::Max,
            Summary::Share,
        ];
        let columns: Vec<Column> = [1.0, 3.0, 20.0]
            .iter()
            .flat_map(|&v| all.map(|summary| value(v - 2.0, summary)))
            .collect();
        let cells = summarize(&columns);
        assert_eq!(cells["Median"], 1.0);
        assert_eq!(cells["Spread"], "1.0 (-1.0 to 18)");
        assert_eq!((&cells["Mean"], &cells["Max"]), (&json!(6.0), &json!(18.0)));
        assert_eq!(cells["Share"], "67 % of 3");
    }
}
