//! Columns of a table: values of frames, and their summary.

use serde_json::{Value, json};

use crate::statistics::{largest, mean, quantile, sorted};

/// How the values of a group of frames become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Summary {
    Median,
    /// The median, the 10th and the 90th percentile.
    Spread,
    Mean,
    /// The smallest upper bound of 95 % of the values.
    High,
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
pub(super) fn summarize(columns: &[Column]) -> Vec<(String, Value)> {
    let mut cells: Vec<(&str, Summary, Vec<f64>)> = Vec::new();
    for column in columns {
        match cells.iter_mut().find(|(name, ..)| *name == column.name) {
            Some((.., values)) => values.push(column.value),
            None => cells.push((&column.name, column.summary, vec![column.value])),
        }
    }
    let cells = cells.into_iter();
    cells
        .map(|(name, summary, values)| (name.to_owned(), summary.apply(values)))
        .collect()
}

impl Summary {
    fn apply(self, values: Vec<f64>) -> Value {
        let values = sorted(values.into_iter().filter(|value| value.is_finite()));
        let above = values.iter().filter(|&&value| value > 0.0).count();
        match self {
            _ if values.is_empty() => Value::Null,
            Self::Median => json!(quantile(&values, 0.5)),
            Self::High => json!(values[(0.95 * values.len() as f64).ceil() as usize - 1]),
            Self::Mean => json!(mean(&values)),
            Self::Max => json!(largest(values)),
            Self::Count => json!(values.iter().sum::<f64>() as u64),
            Self::Share => {
                let share = 100.0 * above as f64 / values.len() as f64;
                json!(format!("{share:.0} % of {}", values.len()))
            }
            Self::Spread => {
                let [low, middle, high] = [0.1, 0.5, 0.9].map(|share| round(quantile(&values, share)));
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
    format!("{value:.digits$}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_summarized_by_column() {
        let all = [
            Summary::Median,
            Summary::Spread,
            Summary::Mean,
            Summary::Max,
            Summary::Share,
        ];
        let columns: Vec<Column> = [-1.0, 1.0, 18.0]
            .iter()
            .flat_map(|&v| all.map(|summary| Column::new(format!("{summary:?}"), v, summary)))
            .collect();
        let cells: Vec<Value> = summarize(&columns).into_iter().map(|(_, cell)| cell).collect();
        let expected = [
            json!(1.0),
            json!("1.0 (−1.0 to 18)"),
            json!(6.0),
            json!(18.0),
            json!("67 % of 3"),
        ];
        assert_eq!(cells, expected);
    }
}
