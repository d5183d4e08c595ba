//! Statistics of metrics over a dataset, group by group.

use std::collections::BTreeMap;

use futures::TryStreamExt;
use serde_json::Value;
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::page::{column, double, value};
use crate::select::Select;
use crate::types::GroupStats;

/// What is asked for.
struct Question<'a> {
    dataset: &'a str,
    metrics: &'a [String],
    group_by: Option<&'a str>,
    filter: Option<&'a str>,
}

impl Catalogue {
    /// Statistics of metrics over a dataset, for each value of a column.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset, [`CatalogueError::Filter`] for names and filter.
    pub async fn stats(
        &self,
        dataset: &str,
        metrics: &[String],
        group_by: Option<&str>,
        filter: Option<&str>,
    ) -> Result<Vec<GroupStats>, CatalogueError> {
        let question = Question {
            dataset,
            metrics,
            group_by,
            filter,
        };
        within(stats(&mut *self.reader().await?, &self.columns, &question)).await
    }
}

/// Upper limit: more than there are metrics.
const MOST_METRICS: usize = 64;

/// One pass over the images for all metrics. The quartiles need every value, and SQLite takes longer to sort them than
/// to hand them over: with three groups 3.3 us a value for aggregates and ranks, against 0.6 us.
async fn stats(
    connection: &mut SqliteConnection,
    columns: &Columns,
    question: &Question<'_>,
) -> Result<Vec<GroupStats>, CatalogueError> {
    check_dataset(connection, question.dataset).await?;
    if question.metrics.len() > MOST_METRICS {
        let message = format!("{} metrics; there may be {MOST_METRICS}", question.metrics.len());
        return Err(CatalogueError::refused(message));
    }
    let mut selected = Vec::with_capacity(question.metrics.len() + 1);
    for metric in question.metrics {
        let measured = column(columns, metric)?;
        if !measured.kind.is_number() {
            return Err(CatalogueError::refused(format!("`{metric}` is no number")));
        }
        selected.push(measured);
    }
    let group_by = question.group_by.map(|name| column(columns, name)).transpose()?;
    selected.extend(group_by.clone());
    let sql = Select::new(columns, &selected, question.filter, Some(question.dataset))?;
    let mut groups = Groups::default();
    let metrics = question.metrics.len();
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        let group = match &group_by {
            Some(column) => value(&row, metrics, column.kind)?,
            None => Value::Null,
        };
        let measured = groups.values_of(group, metrics).iter_mut();
        for (at, (values, column)) in measured.zip(&selected).enumerate() {
            values.extend(double(&row, at, column.kind)?);
        }
    }
    drop(rows);
    Ok(groups.summaries(question.metrics))
}

/// The values of each metric, group by group.
#[derive(Default)]
struct Groups {
    all: BTreeMap<String, usize>,
    values: Vec<(Value, Vec<Vec<f64>>)>,
    /// Neighbors are often of one group.
    last: usize,
}

impl Groups {
    fn values_of(&mut self, group: Value, metrics: usize) -> &mut Vec<Vec<f64>> {
        if self.values.get(self.last).is_none_or(|(last, _)| *last != group) {
            self.last = *self.all.entry(group.to_string()).or_insert_with(|| {
                self.values.push((group, vec![Vec::new(); metrics]));
                self.values.len() - 1
            });
        }
        &mut self.values[self.last].1
    }

    /// Metric by metric, in the order of the groups' texts.
    fn summaries(mut self, metrics: &[String]) -> Vec<GroupStats> {
        let mut all = Vec::new();
        for (at, metric) in metrics.iter().enumerate() {
            for &index in self.all.values() {
                let (group, values) = &mut self.values[index];
                all.push(summary(group.clone(), metric, std::mem::take(&mut values[at])));
            }
        }
        all
    }
}

pub(crate) async fn check_dataset(
    connection: &mut SqliteConnection,
    name: &str,
) -> Result<(), CatalogueError> {
    let there: Option<i64> = sqlx::query_scalar("SELECT 1 FROM datasets WHERE name = ?")
        .bind(name)
        .fetch_optional(connection)
        .await?;
    there
        .map(drop)
        .ok_or_else(|| CatalogueError::not_found("dataset", name))
}

fn summary(group: Value, metric: &str, mut values: Vec<f64>) -> GroupStats {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    let mean = (count > 0).then(|| values.iter().sum::<f64>() / count as f64);
    let sd = mean.filter(|_| count > 1).map(|mean| {
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        (squares / (count - 1) as f64).sqrt()
    });
    let quantile = |share: f64| {
        let place = share * count.checked_sub(1)? as f64;
        let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
        Some(low + (high - low) * place.fract())
    };
    GroupStats {
        group,
        metric: metric.to_owned(),
        count: count as u64,
        mean,
        sd,
        min: values.first().copied(),
        q25: quantile(0.25),
        median: quantile(0.5),
        q75: quantile(0.75),
        max: values.last().copied(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_those_of_the_textbook() {
        let stats = summary(Value::Null, "uiqm", vec![4.0, 1.0, 2.0, 3.0]);
        assert_eq!(
            (stats.count, stats.mean, stats.min, stats.max),
            (4, Some(2.5), Some(1.0), Some(4.0))
        );
        assert_eq!(
            (stats.q25, stats.median, stats.q75),
            (Some(1.75), Some(2.5), Some(3.25))
        );
        assert!((stats.sd.unwrap() - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
        let none = summary(Value::Null, "uiqm", Vec::new());
        assert_eq!(
            (none.count, none.mean, none.sd, none.median),
            (0, None, None, None)
        );
    }
}
