//! Statistics of metrics over a dataset, group by group.

use std::collections::BTreeMap;

use futures::TryStreamExt;
use serde_json::Value;
use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Row};

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::filter::{FilterError, Kind};
use crate::images::bound;
use crate::page::{column, condition, value};
use crate::types::GroupStats;

/// What is asked for.
pub(crate) struct Question<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) metrics: &'a [String],
    pub(crate) group_by: Option<&'a str>,
    pub(crate) filter: Option<&'a str>,
}

pub(crate) async fn stats(
    connection: &mut SqliteConnection,
    columns: &Columns,
    question: &Question<'_>,
) -> Result<Vec<GroupStats>, CatalogueError> {
    check_dataset(connection, question.dataset).await?;
    let filter = condition(columns, question.filter)?;
    let mut all = Vec::new();
    for metric in question.metrics {
        let measured = column(columns, metric)?;
        if measured.kind != Kind::Number {
            let message = format!("`{metric}` is no number");
            return Err(FilterError {
                position: 0,
                message,
                did_you_mean: None,
            }
            .into());
        }
        let group = question.group_by.map(|name| column(columns, name)).transpose()?;
        let (group_sql, group_binds) = group.map_or(("NULL".to_owned(), Vec::new()), |g| (g.sql, g.binds));
        let sql = format!(
            "SELECT {group_sql}, {} FROM images
             WHERE images.dataset = ? AND images.job_id NOT IN (SELECT job_id FROM deletions) AND ({})",
            measured.sql, filter.sql
        );
        let mut statement = sqlx::query(AssertSqlSafe(sql));
        for bind in group_binds.iter().chain(&measured.binds) {
            statement = bound(statement, Some(bind));
        }
        statement = statement.bind(question.dataset);
        for bind in &filter.binds {
            statement = bound(statement, Some(bind));
        }
        let mut groups: BTreeMap<String, (Value, Vec<f64>)> = BTreeMap::new();
        let mut rows = statement.fetch(&mut *connection);
        while let Some(row) = rows.try_next().await? {
            let group = value(&row, 0)?;
            let values = &mut groups.entry(group.to_string()).or_insert((group, Vec::new())).1;
            values.extend(row.try_get_unchecked::<Option<f64>, _>(1)?);
        }
        drop(rows);
        all.extend(
            groups
                .into_values()
                .map(|(group, values)| summary(group, metric, values)),
        );
    }
    Ok(all)
}

pub(crate) async fn check_dataset(
    connection: &mut SqliteConnection,
    name: &str,
) -> Result<(), CatalogueError> {
    let there: Option<i64> = sqlx::query_scalar("SELECT 1 FROM datasets WHERE name = ?")
        .bind(name)
        .fetch_optional(connection)
        .await?;
    there.map(drop).ok_or_else(|| CatalogueError::NotFound {
        what: "dataset",
        name: name.to_owned(),
    })
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
